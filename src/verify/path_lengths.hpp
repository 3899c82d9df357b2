#pragma once
// The lengths of rays' ways through absorbing bodies.

#include "verify/check.hpp"

namespace vitrum {

/// What absorption tells of the way through thin plates that touch and through a small ball, of index 1, at three scales.
CheckResult check_path_lengths(const CheckContext& context);

}  // namespace vitrum
