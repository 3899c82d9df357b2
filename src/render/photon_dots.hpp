#pragma once
// The photon map as white dots.

#include <span>
#include <vector>

#include "render/kernel_context.hpp"

namespace vitrum {

/// 1 for each pixel of the camera's picture that a photon falls into, with nothing in the way, else 0.
std::vector<float> photon_dots(std::span<const cl_float8> photons, const kernel::CameraData& camera);

}  // namespace vitrum
