#pragma once
// Borders between two media, as the kernels take them.

#include "device/kernel_headers.hpp"

namespace vitrum {

/// The border from index `n_i` into `n_t` (both > 0, against vacuum). Fresnel and Snell depend on eta = n_t / n_i alone;
/// k = eta^2 - 1 is kept within 2^-48 of its size, so that an index like 1.00028 does not lose in float what sets it apart
/// from 1. k_hi is 0 for equal indices only.
kernel::InterfaceData make_interface(double n_i, double n_t);

}  // namespace vitrum
