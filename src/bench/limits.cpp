// What the device can do at best: arithmetic, and memory read and copied. What share of it kernels reach, docs/limits.md tells.

#include <algorithm>

#include "bench/benchmarks.hpp"
#include "bench/side_by_side.hpp"
#include "device/kernels.hpp"

namespace vitrum {
namespace {

constexpr uint32_t chains = 12;                // of kernels/checks/limits.cl

/// Runs a kernel of kernels/checks/limits.cl on a part of the device; times are as those of SideBySide.
class Limits {
 public:
  Limits(const BenchContext& context, Device& device)
      : context_(context),
        device_(device),
        program_(device.build("checks/limits.cl", kernel_source(context.kernels, {"checks/limits.cl"}), "-cl-std=CL1.2")) {}

  /// Operations a second, a multiplication with an addition being two [G/s].
  double arithmetic() {
    const uint32_t steps = context_.quick ? 1'000 : 100'000, items = 64;
    const auto results = device_.allocate<float>(items * device_.width(), "limits");
    cl::Kernel kernel(program_, "multiply_and_add");
    set_arguments(kernel, 0, items, steps, results);
    return 1e-9 * 2.0 * device_.width() * chains * steps * items / least_seconds(kernel, items);
  }
  /// Bytes a second that work-items read, each the same `bytes` over and over [GB/s].
  double reading(uint32_t bytes) {
    const uint64_t all = context_.quick ? 1u << 24 : 1u << 30;
    const uint32_t floats = bytes / sizeof(float);
    const auto items = static_cast<uint32_t>(std::clamp<uint64_t>(all / bytes / 4, 1, 64));
    const auto times = static_cast<uint32_t>(std::max<uint64_t>(all / bytes / items, 1));
    const auto values = filled(size_t{items} * floats), results = device_.allocate<float>(16 * size_t{items}, "limits");
    cl::Kernel kernel(program_, "read_memory");
    set_arguments(kernel, 0, items, floats, times, values, results);
    return 1e-9 * bytes * static_cast<double>(items) * times / least_seconds(kernel, items);
  }
  /// Bytes a second that are copied, each counted once, of arrays that no cache holds [GB/s].
  double copying() {
    const uint32_t items = 64, floats = context_.quick ? 1u << 16 : 1u << 21;
    const auto from = filled(size_t{items} * floats), to = filled(size_t{items} * floats);
    cl::Kernel kernel(program_, "copy_memory");
    set_arguments(kernel, 0, items, floats, from, to);
    return 1e-9 * sizeof(float) * items * floats / least_seconds(kernel, items);
  }

 private:
  Buffer<float> filled(size_t count) {
    const auto buffer = device_.allocate<float>(count, "limits");
    device_.fill_zero(buffer);
    return buffer;
  }
  double least_seconds(const cl::Kernel& kernel, size_t items) {
    const auto run = [&] {
      device_.launch_singly("limits", kernel, items);
      device_.finish();
    };
    const SideBySide runs(context_, context_.quick ? 1 : 7, run, [] {});
    return runs.least();
  }

  const BenchContext& context_;
  Device& device_;
  cl::Program program_;
};

}  // namespace

BenchResult bench_limits(const BenchContext& context) {
  BenchResult result;
  const std::string unit = SideBySide::unit(context);
  const unsigned threads = context.device.info().is_cpu ? context.threads : 1;
  Limits limits(context, context.device);
  const auto add = [&](const std::string& what, const char* of, double rate) {
    result.rows.push_back({what, {{"by " + unit + " of a thread", rate}, {"all threads", rate * threads}}});
    result.findings.push_back(printed("%s: %.3g %s/s a thread", what.c_str(), rate, of));
    context.progress(static_cast<double>(result.rows.size()) / 6.0);
  };
  add("multiply and add", "G operations", limits.arithmetic());
  for (const uint32_t kilobytes : {16, 256, 1024}) add(printed("read %u kB", kilobytes), "GB", limits.reading(kilobytes << 10));
  add("read 256 MB", "GB", limits.reading(context.quick ? 1u << 22 : 256u << 20));
  add("copy", "GB", limits.copying());
  return result;
}

}  // namespace vitrum
