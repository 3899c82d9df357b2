#pragma once
// Caustics that are drawn by area, in pictures whose irradiance is known.

#include <vector>

#include "verify/check.hpp"

namespace vitrum {

/// Rows on smooth light, pixel by pixel, and on the default scene's caustic: its flux, and how fast its error falls.
std::vector<CheckResult> check_patches(const CheckContext& context);

}  // namespace vitrum
