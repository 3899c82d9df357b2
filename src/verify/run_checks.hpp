#pragma once
// Runs groups of checks, three at a time: while one waits for its kernels to be compiled, or for a launch too small for
// all threads, another works.

#include <functional>
#include <string>
#include <vector>

#include "verify/check.hpp"

namespace vitrum {

struct CheckSettings {
  std::string device, against;  ///< as after --device and --against; "" for the latter: no other device
  KernelFiles kernels;
  bool full = false;
};

/// The rows of all groups, in their order. `progress` is told what share of all is done, by one thread at a time. Throws
/// the first Error of a group, when the groups that have begun have ended.
std::vector<CheckResult> run_checks(const std::vector<CheckGroup>& groups, const CheckSettings& settings,
                                    const std::function<void(double)>& progress);

}  // namespace vitrum
