// The pool's quadrature: against closed forms, where there are some.
#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <limits>
#include <numbers>

#include "reference/pool.hpp"

using namespace vitrum::reference;

TEST_CASE("without an interface the flux of a pool is the solid angle") {
  for (const double r : {1e-3, 0.1, 1.0, 50.0})
    CHECK(encircled_flux({1.0, 0.0, 0.7, 1.3}, r) == doctest::Approx(0.5 * (1 - 2 / std::hypot(2.0, r))).epsilon(1e-8));
  CHECK(encircled_flux({1.0, 0.0, 0.7, 1.3}, std::numeric_limits<double>::infinity()) == doctest::Approx(0.5).epsilon(1e-12));
}

TEST_CASE("the flux close to the axis is the irradiance there") {
  for (const double sigma_a : {0.0, 0.5})
    for (const double index : {1.0, 1.333, 2.4}) {
      const Pool pool{index, sigma_a, 0.6, 0.9};
      const double r = 1e-3, flux = encircled_flux(pool, r);
      // The next term is of the order of (r / distance)^2.
      CHECK(flux / (r * r / 4) == doctest::Approx(irradiance_on_axis(pool)).epsilon(1e-5));
    }
}

TEST_CASE("water lets in what a hemisphere of light loses to reflection") {
  // A lamp's flux per solid angle is even: 1 - int R sin, whatever the depth.
  const double all = encircled_flux({1.333, 0.0, 1.0, 1.0}, std::numeric_limits<double>::infinity());
  CHECK(all == doctest::Approx(encircled_flux({1.333, 0.0, 0.1, 5.0}, std::numeric_limits<double>::infinity())).epsilon(1e-10));
  CHECK(all < 0.5 * (1 - std::pow(0.333 / 2.333, 2)));
}
