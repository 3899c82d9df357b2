#pragma once
// What a run of `vitrum verify` found.

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

  size_t failed() const;
  /// vitrum with its commit, and the devices, in a line.
  std::string made_by() const;
};

/// The bytes of a PNG of `picture`, by the sRGB curve.
std::string png_of(const CheckPicture& picture);

}  // namespace vitrum
