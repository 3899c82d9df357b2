// The closed forms that `vitrum verify` holds pictures against, by what they must have in common.
#include <doctest/doctest.h>

#include <vector>

#include "verify/closed_forms.hpp"

using namespace vitrum;

namespace {

void check_equal(const glm::dvec3& a, const glm::dvec3& b) {
  for (int c = 0; c < 3; ++c) CHECK(a[c] == doctest::Approx(b[c]).epsilon(1e-12));
}

}  // namespace

TEST_CASE("layers: one is a slab; a clear stack loses nothing; halves are a whole; both ways let through alike") {
  const glm::dvec3 sigma_a(0.1, 0.5, 2.0), other(1.0, 0.2, 0.0), clear(0.0);
  for (const double cosine : {1.0, 0.7, 0.2}) {
    const reference::Fresnel f = reference::fresnel(1.0, 1.5, cosine);
    const glm::dvec3 tau = reference::transmittance(sigma_a, 0.3 / f.cos_theta_t), among = 1.0 - f.R * f.R * tau * tau;
    const Stack one = layers_in_air({{1.5, 0.3, sigma_a}}, cosine);
    check_equal(one.R, f.R + f.T * f.T * f.R * tau * tau / among);
    check_equal(one.T, f.T * f.T * tau / among);

    const Stack without_loss = layers_in_air({{1.5, 0.3, clear}, {1.333, 0.1, clear}, {1.31, 0.2, clear}}, cosine);
    check_equal(without_loss.R + without_loss.T, glm::dvec3(1.0));

    const Stack halves = layers_in_air({{1.5, 0.1, sigma_a}, {1.5, 0.2, sigma_a}}, cosine);
    check_equal(halves.R, one.R);
    check_equal(halves.T, one.T);

    const Stack down = layers_in_air({{1.5, 0.3, sigma_a}, {1.333, 0.4, other}}, cosine);
    const Stack up = layers_in_air({{1.333, 0.4, other}, {1.5, 0.3, sigma_a}}, cosine);
    check_equal(down.T, up.T);
    CHECK(down.R.z != doctest::Approx(up.R.z).epsilon(1e-3));
  }
}

TEST_CASE("shells: clear ones are a white furnace; one of the same medium is not seen; on the axis they are layers") {
  const glm::dvec3 sigma_a(0.1, 0.5, 2.0), other(1.0, 0.2, 0.0), clear(0.0);
  for (const double p : {0.0, 0.3, 0.55, 0.9, 0.99}) {
    check_equal(shells_radiance({{1.0, 1.5, clear}, {0.8, 1.333, clear}, {0.4, 1.31, clear}}, p), glm::dvec3(1.0));
    check_equal(shells_radiance({{1.0, 1.5, sigma_a}, {0.8, 1.333, other}, {0.5, 1.333, other}}, p),
                shells_radiance({{1.0, 1.5, sigma_a}, {0.8, 1.333, other}}, p));
  }
  const Stack stack = layers_in_air({{1.5, 0.2, sigma_a}, {1.333, 1.6, other}, {1.5, 0.2, sigma_a}}, 1.0);
  check_equal(shells_radiance({{1.0, 1.5, sigma_a}, {0.8, 1.333, other}}, 0.0), stack.R + stack.T);
}
