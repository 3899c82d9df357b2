#pragma once
// Runs the kernels of kernels/checks/fresnel.cl on many inputs.

#include <algorithm>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "device/kernel_headers.hpp"
#include "verify/check.hpp"
#include "verify/fresnel_inputs.hpp"

namespace vitrum {

/// Fields of `count` floats that follow each other, as the kernels take and give them.
class Fields {
 public:
  Fields(uint32_t count, size_t fields) : count_(count), values_(size_t{count} * fields) {}
  Fields(uint32_t count, std::vector<float> values) : count_(count), values_(std::move(values)) {}

  float& operator()(size_t field, uint32_t i) { return values_[field * count_ + i]; }
  float operator()(size_t field, uint32_t i) const { return values_[field * count_ + i]; }
  uint32_t count() const { return count_; }
  const std::vector<float>& values() const { return values_; }

 private:
  uint32_t count_;
  std::vector<float> values_;
};

/// Inputs of kernel "medium": sigma_a, distance and rho_d.
inline Fields medium_inputs(FresnelInputs& inputs, uint32_t count) {
  Fields in(count, 3);
  for (uint32_t i = 0; i < count; ++i) {
    const auto [sigma_a, distance] = inputs.absorbing_path();
    in(0, i) = sigma_a;
    in(1, i) = distance;
    in(2, i) = inputs.reflectance();
  }
  return in;
}

class FresnelKernel {
 public:
  /// `kernel`: "border", "medium" or "cosines", which gives `outputs` fields.
  FresnelKernel(const CheckContext& context, const char* kernel, size_t outputs)
      : device_(context.device),
        outputs_(outputs),
        kernel_(context.device.build("checks/fresnel.cl", kernel_source(context.kernels, {"checks/fresnel.cl"}),
                                     "-cl-std=CL1.2"),
                kernel) {}

  /// The outputs of kernel "cosines" for `count` cosines, a multiple of 16.
  Fields run(const kernel::InterfaceData& border, uint32_t first, uint32_t count) {
    const auto outputs = device_.allocate<float>(count * outputs_, "outputs of checks");
    set_arguments(kernel_, 0, border.eta, border.eta_inverse, border.k_hi, border.k_lo, first, outputs, count);
    device_.launch("checks", kernel_, count / device_.width());
    return {count, device_.read(outputs, 0, outputs.size())};
  }

  /// The outputs of `in`, whose count is a multiple of 16.
  Fields run(const Fields& in) {
    const auto inputs = device_.upload(in.values(), "inputs of checks");
    const auto outputs = device_.allocate<float>(in.count() * outputs_, "outputs of checks");
    set_arguments(kernel_, 0, inputs, outputs, in.count());
    device_.launch("checks", kernel_, in.count() / device_.width());
    return {in.count(), device_.read(outputs, 0, outputs.size())};
  }

 private:
  Device& device_;
  size_t outputs_;
  cl::Kernel kernel_;
};

/// Calls `part(tally, first, last)` for ranges that together are [0, count), each in a thread of its own with a Tally of
/// its own, and merges the tallies in the order of the ranges: the same result for any number of threads.
template <typename Tally>
Tally tallied(uint32_t count, const std::function<void(Tally&, uint32_t, uint32_t)>& part) {
  const uint32_t threads = std::clamp(std::thread::hardware_concurrency(), 1u, 64u);
  std::vector<Tally> tallies(threads);
  std::vector<std::thread> running;
  for (uint32_t k = 0; k < threads; ++k)
    running.emplace_back([&, k] {
      part(tallies[k], static_cast<uint32_t>(uint64_t{count} * k / threads),
           static_cast<uint32_t>(uint64_t{count} * (k + 1) / threads));
    });
  for (std::thread& thread : running) thread.join();
  for (uint32_t k = 1; k < threads; ++k) tallies[0].merge(tallies[k]);
  return tallies[0];
}

/// Whether the device is said to round division and square root correctly, as the host does: PoCL's CPUs. OpenCL 1.2,
/// 7.4, allows others 2.5 and 3 ulp.
inline bool rounds_as_host(const Device& device) {
  return device.info().is_cpu && device.info().platform == "Portable Computing Language";
}

}  // namespace vitrum
