#include "reference/pool.hpp"

#include <cassert>
#include <cmath>
#include <numbers>

#include "reference/fresnel.hpp"
#include "reference/quadrature.hpp"

namespace vitrum::reference {
namespace {

double cos_in_water(const Pool& pool, double theta) {
  const double sin_t = std::sin(theta) / pool.index;
  return std::sqrt((1 - sin_t) * (1 + sin_t));
}

double landing(const Pool& pool, double theta) {
  return std::sin(theta) * (pool.height / std::cos(theta) + pool.depth / (pool.index * cos_in_water(pool, theta)));
}

double through_water(const Pool& pool, double theta) {
  return fresnel(1.0, pool.index, std::cos(theta)).T * transmittance(pool.sigma_a, pool.depth / cos_in_water(pool, theta));
}

}  // namespace

double irradiance_on_axis(const Pool& pool) {
  const double distance = pool.height + pool.depth / pool.index;
  return through_water(pool, 0.0) / (distance * distance);
}

double encircled_flux(const Pool& pool, double r) {
  assert(pool.index >= 1 && pool.height > 0 && pool.depth > 0 && r >= 0);
  double low = 0.0, high = std::numbers::pi / 2;
  for (int k = 0; k < 60 && !std::isinf(r); ++k) {
    const double middle = (low + high) / 2;
    (landing(pool, middle) < r ? low : high) = middle;
  }
  return integral([&](double theta) { return 0.5 * through_water(pool, theta) * std::sin(theta); }, 0.0, high, 1e-13);
}

}  // namespace vitrum::reference
