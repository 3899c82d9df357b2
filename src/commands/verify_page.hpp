#pragma once
// What a run of `vitrum verify` found, and the page that shows it.

#include <optional>
#include <string>
#include <vector>

#include "verify/check.hpp"

namespace vitrum {

struct VerifyRun {
  DeviceInfo device;
  std::optional<DeviceInfo> other;  ///< of --against
  std::vector<CheckResult> results;
  bool full = false;
  double seconds = 0.0;
};

/// One HTML page: the table, and a plot of each check that has a curve.
std::string verify_page(const VerifyRun& run);

}  // namespace vitrum
