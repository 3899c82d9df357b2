// The reference's Fresnel terms against textbook values and relations that do not use its formulas.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "reference/fresnel.hpp"
#include "reference/quadrature.hpp"

using namespace vitrum::reference;

namespace {
bool close(double a, double b, double relative) { return std::abs(a - b) <= relative * std::abs(b); }
}  // namespace

TEST_CASE("reference Fresnel: normal incidence, Brewster, 45 degrees") {
  for (const double n : {1.00028, 1.333, 1.5, 2.4, 4.0}) {
    CAPTURE(n);
    const double normal = (n - 1) / (n + 1);
    CHECK(close(fresnel(1, n, 1).R, normal * normal, 1e-14));
    CHECK(close(fresnel(n, 1, 1).R, normal * normal, 1e-14));

    const Fresnel brewster = fresnel(1, n, 1 / std::sqrt(1 + n * n));
    const double ratio = (n - 1) * (n + 1) / (n * n + 1);
    CHECK(close(brewster.R, ratio * ratio / 2, 1e-13));
    CHECK(std::abs(brewster.r_par) < 1e-15);

    const Fresnel half_right = fresnel(1, n, std::sqrt(0.5));
    CHECK(std::abs(half_right.r_par) == doctest::Approx(half_right.r_perp * half_right.r_perp).epsilon(1e-14));
  }
}

TEST_CASE("reference Fresnel: Stokes' relations, reciprocity and energy") {
  for (const double n : {1 + 0x1p-23, 1.00028, 1.5, 4.0}) {
    for (const double cos_i : {1e-30, 1e-6, 0.01, 0.3, 0.7, 0.999, 1.0}) {
      CAPTURE(n);
      CAPTURE(cos_i);
      const Fresnel in = fresnel(1, n, cos_i), out = fresnel(n, 1, in.cos_theta_t);
      CHECK(std::abs(in.R + in.T - 1) < 1e-15);
      // The conjugate cosine is rounded to double, which shifts what lies behind a grazing ray.
      if (cos_i < 0.01) continue;
      CHECK(out.r_perp == doctest::Approx(-in.r_perp).epsilon(1e-8));
      CHECK(out.T == doctest::Approx(in.T).epsilon(1e-8));
      CHECK(out.cos_theta_t == doctest::Approx(cos_i).epsilon(1e-8));
    }
  }
}

TEST_CASE("reference Fresnel: small differences of index and grazing angles keep their digits") {
  // Head-on R = (n - 1)^2 / (n + 1)^2; and T -> 2 cos_i (n^2 + 1) / sqrt(n^2 - 1) as cos_i -> 0.
  const double delta = 0x1p-23;
  CHECK(close(fresnel(1, 1 + delta, 1).R, delta * delta / 4 / (1 + delta), 1e-13));
  // Away from it by the form that does not cancel: r_perp = -(n^2 - 1) / (c + sqrt(c^2 + n^2 - 1))^2.
  const long double k = static_cast<long double>(delta) * (2 + delta);
  for (const long double c : {0.9L, 0.5L, 0.1L, 1e-3L})
    CHECK(close(fresnel(1, 1 + delta, static_cast<double>(c)).r_perp,
                static_cast<double>(-k / std::pow(static_cast<double>(c) + std::sqrt(c * c + k), 2.0L)), 1e-14));
  for (const double cos_i : {1e-10, 1e-30, 1e-38})
    CHECK(close(fresnel(1, 1.5, cos_i).T, 2 * cos_i * (1.5 * 1.5 + 1) / std::sqrt(1.5 * 1.5 - 1), 1e-9));
}

TEST_CASE("reference Fresnel: next to the critical angle") {
  // Above it total reflection; below, R = 1 - 2 (1 + n^2) cos_t / (n cos_i) to first order in cos_t.
  const float n = 1.5f;
  const float critical = std::sqrt(1 - 1 / (n * n));
  int total = 0, refracted = 0;
  for (float c = critical - 4e-7f; c < critical + 4e-7f; c = std::nextafter(c, 1.0f)) {
    const Fresnel f = fresnel(n, 1, c);
    const long double exact = 1 - 2.25L * (1 - static_cast<long double>(c) * c);
    CHECK(f.total_reflection == (exact < 0));
    (f.total_reflection ? total : refracted)++;
    if (f.total_reflection) {
      CHECK(f.R == 1);
      CHECK(f.T == 0);
    } else {
      const double cos_t = std::sqrt(static_cast<double>(exact));
      CHECK(f.T == doctest::Approx(2 * (1 + 2.25) * cos_t / (1.5 * c)).epsilon(8 * cos_t));
    }
  }
  CHECK(total > 3);
  CHECK(refracted > 3);
}

TEST_CASE("reference Fresnel: no interface, and the ends of the cosine") {
  const Fresnel nothing = fresnel(1.5, 1.5, 0);
  CHECK(nothing.R == 0);
  CHECK(nothing.T == 1);
  CHECK(fresnel(1, 1.5, 0).R == 1);
  CHECK(fresnel(1, 1.5, 0).T == 0);
  CHECK(fresnel(1.5, 1, 0).total_reflection);
  CHECK(fresnel(1, 1.5, 1.0000001).R == fresnel(1, 1.5, 1).R);
}

TEST_CASE("reference Fresnel: hemispherical reflectance") {
  // Truth by Walsh (1926): 0.066405764783 for water, 0.091777959342 for glass; from inside 1 - (1 - r) / n^2.
  const auto hemispherical = [](double n_i, double n_t) {
    const double critical = n_i > n_t ? std::asin(n_t / n_i) : 0;
    const Function f = [&](double theta) {
      return 2 * fresnel(n_i, n_t, std::cos(theta)).R * std::sin(theta) * std::cos(theta);
    };
    // theta = critical - s^2 takes the root out of the angle below the critical one.
    const Function below = [&](double s) { return 2 * s * f(critical - s * s); };
    return integral(below, 0, std::sqrt(critical), 1e-14) + integral(f, critical, std::acos(0.0), 1e-14);
  };
  CHECK(hemispherical(1, 1.333) == doctest::Approx(0.066405764783).epsilon(2e-11));
  CHECK(hemispherical(1, 1.5) == doctest::Approx(0.091777959342).epsilon(2e-11));
  CHECK(hemispherical(1.5, 1) == doctest::Approx(1 - (1 - 0.091777959342) / 2.25).epsilon(1e-10));
}

TEST_CASE("reference directions: Snell's law, the plane of incidence, and no ray in total reflection") {
  const glm::dvec3 normal = glm::normalize(glm::dvec3(0.2, 1, -0.3));
  const glm::dvec3 direction = glm::normalize(glm::dvec3(0.7, -0.6, 0.1));
  for (const double n_t : {1.333, 1.5, 2.4}) {
    const auto refracted = refracted_direction(1, n_t, direction, normal);
    REQUIRE(refracted);
    CHECK(glm::length(*refracted) == doctest::Approx(1).epsilon(1e-15));
    // n sin is the length of the tangential part, and that part keeps its direction.
    const glm::dvec3 before = glm::cross(direction, normal), behind = n_t * glm::cross(*refracted, normal);
    CHECK(glm::length(before - behind) < 1e-15);
    CHECK(-glm::dot(*refracted, normal) ==
          doctest::Approx(fresnel(1, n_t, -glm::dot(direction, normal)).cos_theta_t).epsilon(1e-14));
    // And back again.
    const auto back = refracted_direction(n_t, 1, -*refracted, -normal);
    REQUIRE(back);
    CHECK(glm::length(*back + direction) < 1e-14);
  }
  CHECK(!refracted_direction(1.5, 1, direction, normal));
  const glm::dvec3 mirrored = reflected_direction(direction, normal);
  CHECK(glm::dot(mirrored, normal) == doctest::Approx(-glm::dot(direction, normal)).epsilon(1e-15));
  CHECK(glm::length(glm::cross(mirrored - direction, normal)) < 1e-15);
}

TEST_CASE("reference transmittance and sigma_a") {
  const double infinity = std::numeric_limits<double>::infinity();
  CHECK(transmittance(2, 0.5) == doctest::Approx(0.36787944117144233).epsilon(1e-15));
  CHECK(transmittance(infinity, 0) == 1);
  CHECK(transmittance(infinity, 1e-30) == 0);
  CHECK(transmittance(0, infinity) == 1);
  CHECK(transmittance(1, infinity) == 0);
  CHECK(sigma_a_from_rho_d(1) == 0);
  CHECK(sigma_a_from_rho_d(0) == infinity);
  CHECK(sigma_a_from_rho_d(0.5) == 1);
  CHECK(sigma_a_from_rho_d(1 - 0x1p-40) == doctest::Approx(0x1p-40 / (1 - 0x1p-40)).epsilon(1e-15));
}
