#pragma once
// What `vitrum verify` checks on a device. A new check is a row that one of the groups returns, or a new group: a file
// beside this one, declared in groups.hpp and listed in check.cpp.

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/plot.hpp"
#include "core/printed.hpp"
#include "device/kernels.hpp"
#include "device/opencl.hpp"
#include "film/images.hpp"

namespace vitrum {

/// A picture for the reports, with linear values.
struct CheckPicture {
  std::string caption;
  Picture picture;
};

/// What was found: one row of the table.
struct CheckResult {
  std::string name;             ///< "interface/reflectance"; the part before the slash is the group's
  uint64_t cases = 0;           ///< inputs, pixels or estimates that were tried
  double worst = 0.0;           ///< largest error; NaN counts as larger than any
  double bound = 0.0;           ///< errors up to this are accepted
  std::string unit;             ///< of both: "ulp", "rad", "relative", "" (absolute)
  std::string truth;            ///< where the right answers come from: equation, paper
  std::string worst_input{};    ///< what gave the largest error, in digits that reproduce it
  std::vector<Plot> plots{};    ///< error against input, for the reports
  std::vector<CheckPicture> pictures{};
  std::string kernel{};         ///< what was asked; left empty, it is the group's

  bool passed() const { return worst <= bound; }
};

/// What a group works with.
struct CheckContext {
  Device& device;
  std::string device_choice;    ///< as --device says it, for a device of another group size
  KernelFiles kernels;
  bool full = false;            ///< minutes of it instead of seconds
  Device* other = nullptr;      ///< the device of --against; none: the group `devices` has no rows
  std::function<void(double)> progress;  ///< told how much of the group is done, 0 to 1
};

struct CheckGroup {
  const char* name;             ///< as after --only
  const char* what;             ///< for --help
  const char* kernels;          ///< what it asks, for the one who looks for a fault
  double full_share;            ///< of the time that a full run takes, about
  std::vector<CheckResult> (*run)(const CheckContext&);  ///< throws Error as the device and its kernels do
};

/// All groups, in the order in which they run.
const std::vector<CheckGroup>& check_groups();

/// The largest error and the number of the case that has it: the first of equal ones. NaN counts as infinite.
struct Worst {
  double error = -1.0;
  uint64_t at = 0;
  uint64_t cases = 0;

  void add(double found, uint64_t index);
  /// Takes up what another found in cases that come after all of this one's.
  void merge(const Worst& later);
};

}  // namespace vitrum
