#pragma once
// The same work by vitrum and by a library, in turns, so that what else runs on the machine disturbs both.

#include <algorithm>
#include <chrono>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "bench/benchmark.hpp"
#include "core/cpu_time.hpp"

namespace vitrum {

/// Calls `part(first, last)` for ranges that together are [0, count), each in a thread of its own.
inline void in_threads(unsigned threads, size_t count, const std::function<void(size_t, size_t)>& part) {
  std::vector<std::jthread> running;
  for (unsigned k = 0; k < threads; ++k) running.emplace_back(part, count * k / threads, count * (k + 1) / threads);
}

/// The one in the middle; of an even number, the greater of the two.
inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Rounds of both, in turns, after one of each that is not counted. Times are processor times where vitrum's device is a
/// CPU, and else wall times of both.
class SideBySide {
 public:
  SideBySide(const BenchContext& context, int rounds, const std::function<void()>& ours, const std::function<void()>& theirs)
      : is_cpu_(context.device.info().is_cpu) {
    ours(), theirs();
    for (int round = 0; round < rounds; ++round) {
      ours_.push_back(seconds_of(ours));
      theirs_.push_back(seconds_of(theirs));
    }
  }

  /// The median round's seconds.
  double ours() const { return median(ours_); }
  double theirs() const { return median(theirs_); }
  /// Our shortest round's.
  double least() const { return std::ranges::min(ours_); }
  /// How many times faster vitrum is: the median of the rounds' ratios.
  double speedup() const {
    std::vector<double> ratios;
    for (size_t i = 0; i < ours_.size(); ++i) ratios.push_back(theirs_[i] / ours_[i]);
    return median(ratios);
  }
  /// What the seconds are.
  static const char* unit(const BenchContext& context) { return context.device.info().is_cpu ? "CPU s" : "s"; }

 private:
  double now() const {
    if (is_cpu_) return process_cpu_seconds();
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  }
  double seconds_of(const std::function<void()>& work) const {
    const double start = now();
    work();
    return now() - start;
  }

  bool is_cpu_;
  std::vector<double> ours_, theirs_;
};

}  // namespace vitrum
