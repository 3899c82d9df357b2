#pragma once
// The default scene's caustic as a picture, by number of photons.

#include "verify/check.hpp"

namespace vitrum {

/// Whether more photons make the picture's irradiance better; with plots of its error and the picture. Takes about a
/// minute.
CheckResult check_caustic_picture(const CheckContext& context);

}  // namespace vitrum
