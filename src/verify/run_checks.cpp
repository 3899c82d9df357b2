#include "verify/run_checks.hpp"

#include <algorithm>
#include <exception>
#include <iterator>
#include <mutex>
#include <optional>
#include <thread>

namespace vitrum {
namespace {

// More than there are processors: PoCL compiles for one of them at a time, and much of the truth is computed by one thread.
constexpr size_t workers = 3;

class CheckRun {
 public:
  CheckRun(const std::vector<CheckGroup>& groups, const CheckSettings& settings, const std::function<void(double)>& progress)
      : groups_(groups), settings_(settings), progress_(progress), done_(groups.size(), 0.0), results_(groups.size()) {}

  std::vector<CheckResult> run() {
    std::vector<std::thread> threads;
    for (size_t k = 0; k < std::min(workers, groups_.size()); ++k) threads.emplace_back([this] { work(); });
    for (std::thread& thread : threads) thread.join();
    if (failure_) std::rethrow_exception(failure_);
    std::vector<CheckResult> all;
    for (std::vector<CheckResult>& rows : results_)
      all.insert(all.end(), std::make_move_iterator(rows.begin()), std::make_move_iterator(rows.end()));
    return all;
  }

 private:
  /// Takes one group after the other, with a device of its own: a device has one queue.
  void work() {
    try {
      Device device(settings_.device);
      std::optional<Device> other;
      if (!settings_.against.empty()) other.emplace(settings_.against);
      while (const std::optional<size_t> k = next()) {
        const CheckGroup& group = groups_[*k];
        const auto told = [&](double part) { tell(*k, part); };
        results_[*k] = group.run({device, settings_.device, settings_.kernels, settings_.full, other ? &*other : nullptr, told});
        for (CheckResult& result : results_[*k])
          if (result.kernel.empty()) result.kernel = group.kernels;
        tell(*k, 1.0);
      }
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
    }
  }

  std::optional<size_t> next() {
    const std::lock_guard lock(mutex_);
    if (failure_ || next_ == groups_.size()) return std::nullopt;
    return next_++;
  }

  void tell(size_t group, double part) {
    const std::lock_guard lock(mutex_);
    done_[group] = part;
    double all = 0.0, total = 0.0;
    for (size_t k = 0; k < groups_.size(); ++k) {
      all += done_[k] * groups_[k].full_share;
      total += groups_[k].full_share;
    }
    progress_(all / total);
  }

  const std::vector<CheckGroup>& groups_;
  const CheckSettings& settings_;
  const std::function<void(double)>& progress_;
  std::mutex mutex_;
  std::vector<double> done_;    ///< of each group, 0 to 1
  std::vector<std::vector<CheckResult>> results_;
  size_t next_ = 0;
  std::exception_ptr failure_;
};

}  // namespace

std::vector<CheckResult> run_checks(const std::vector<CheckGroup>& groups, const CheckSettings& settings,
                                    const std::function<void(double)>& progress) {
  return CheckRun(groups, settings, progress).run();
}

}  // namespace vitrum
