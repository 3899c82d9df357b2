#include "device/interface.hpp"

#include <cassert>

namespace vitrum {

kernel::InterfaceData make_interface(double n_i, double n_t) {
  assert(n_i > 0 && n_t > 0);
  const double k = (n_t - n_i) * (n_t + n_i) / (n_i * n_i);
  const float k_hi = static_cast<float>(k);
  return {static_cast<float>(n_t / n_i), static_cast<float>(n_i / n_t), k_hi, static_cast<float>(k - k_hi)};
}

}  // namespace vitrum
