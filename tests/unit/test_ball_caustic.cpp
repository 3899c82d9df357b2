// The quadrature of the ball's caustic against values of other origin, to nine digits.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "reference/ball_caustic.hpp"
#include "reference/fresnel.hpp"
#include "reference/quadrature.hpp"

using namespace vitrum::reference;

namespace {

constexpr double everything = std::numeric_limits<double>::infinity();

struct Row {
  double sigma_a;
  double within[4];
};

void check_digits(double computed, double expected, double half_unit) {
  CAPTURE(computed);
  CAPTURE(expected);
  CHECK(std::abs(computed - expected) < half_unit);
}

// A ray of the meridian plane followed by points and vectors; where it lands, or -1.
double landing_by_vectors(const BallOnAxis& ball, double theta, int order) {
  const glm::dvec3 centre(0, ball.plane_distance, 0);
  glm::dvec3 at(0, ball.plane_distance + ball.light_distance, 0), direction(std::sin(theta), -std::cos(theta), 0);
  const double b = glm::dot(at - centre, direction);
  at += (-b - std::sqrt(b * b - glm::dot(at - centre, at - centre) + ball.radius * ball.radius)) * direction;
  glm::dvec3 normal = (at - centre) / ball.radius;
  if (order == 0) {
    direction = reflected_direction(direction, normal);
  } else {
    direction = *refracted_direction(1, ball.index, direction, normal);
    for (int chord = 1; chord <= order; ++chord) {
      at -= 2 * glm::dot(at - centre, direction) * direction;
      normal = (at - centre) / ball.radius;
      direction = chord < order ? reflected_direction(direction, -normal)
                                : *refracted_direction(ball.index, 1, direction, -normal);
    }
  }
  return direction.y < 0 ? std::abs(at.x - at.y / direction.y * direction.x) : -1;
}

// Encircled flux of orders 0 to `last` by adding up rays.
double encircled_by_vectors(const BallOnAxis& ball, double r, int last) {
  const int rays = 1000;
  const double widest = std::asin(ball.radius / ball.light_distance);
  double sum = 0;
  for (int k = 0; k < rays; ++k) {
    const double s = (k + 0.5) / rays, theta = widest * (1 - s * s);  // dense towards the ball's edge
    const double cos_i = std::sqrt(1 - std::pow(std::sin(theta) * ball.light_distance / ball.radius, 2));
    const Fresnel surface = fresnel(1, ball.index, cos_i);
    const double tau = transmittance(ball.sigma_a, 2 * ball.radius * surface.cos_theta_t);
    for (int order = 0; order <= last; ++order) {
      const double landing = landing_by_vectors(ball, theta, order);
      if (landing < 0 || landing >= r) continue;
      const double share = order == 0 ? surface.R : surface.T * surface.T * tau * std::pow(surface.R * tau, order - 1);
      sum += share * std::sin(theta) / 2 * 2 * s * widest / rays;
    }
  }
  return sum;
}

}  // namespace

TEST_CASE("quadrature: Gauss-Kronrod is exact for polynomials and finds pairs of close roots") {
  CHECK(integral([](double x) { return std::pow(x, 22); }, -1, 1, 1) == doctest::Approx(2.0 / 23).epsilon(1e-14));
  CHECK(integral([](double x) { return std::sqrt(x); }, 0, 1, 1e-13) == doctest::Approx(2.0 / 3).epsilon(1e-12));
  const auto found = roots([](double x) { return (x - 0.5001) * (x - 0.5002) * (x - 0.9); }, 0, 1, 10);
  REQUIRE(found.size() == 3);
  CHECK(found[0] == doctest::Approx(0.5001).epsilon(1e-14));
  CHECK(found[1] == doctest::Approx(0.5002).epsilon(1e-14));
  CHECK(found[2] == doctest::Approx(0.9).epsilon(1e-14));
}

TEST_CASE("default scene: flux by exactly two refractions") {
  // r < .05, .10, .15 by mpmath in 30 digits, roots by bracketing to 25; then all of it.
  const Row table[]{{0.0, {0.00812729290923, 0.0277477230939, 0.0827684632157, 0.082803247}},
                    {2.0 / 3, {0.00578581408165, 0.0195311436862, 0.0581228810598, 0.058148687}},
                    {1.0, {0.00488523293043, 0.0163961113912, 0.0487206052653, 0.048742833}}};
  for (const Row& row : table) {
    const BallOnAxis ball = default_scene_ball(row.sigma_a);
    check_digits(encircled_flux(ball, 0.05, Orders::two_refractions), row.within[0], 5e-13);
    check_digits(encircled_flux(ball, 0.10, Orders::two_refractions), row.within[1], 5e-13);
    check_digits(encircled_flux(ball, 0.15, Orders::two_refractions), row.within[2], 5e-13);
    check_digits(encircled_flux(ball, everything, Orders::two_refractions), row.within[3], 5.1e-10);
  }
}

TEST_CASE("default scene: flux by all orders") {
  // A table of other origin, good to some 1e-8; without absorption to 3e-7, as it leaves out orders above some 20.
  const Row table[]{{0.0, {0.008130123, 0.027751595, 0.082773683, 0.082808067}},
                    {2.0 / 3, {0.005786056, 0.019531660, 0.058123761, 0.058148349}},
                    {1.0, {0.004885333, 0.016396354, 0.048721039, 0.048742055}}};
  const double radii[]{0.05, 0.10, 0.15, 0.20};
  for (const Row& row : table)
    for (int k = 0; k < 4; ++k)
      check_digits(encircled_flux(default_scene_ball(row.sigma_a), radii[k], Orders::all), row.within[k],
                   row.sigma_a == 0 ? 3e-7 : 6e-9);
}

TEST_CASE("default scene: all orders against rays followed by vectors") {
  // So few rays are off by a ray or so at each edge of the disc.
  for (const double r : {0.05, 0.15, 0.4, 3.0})
    CHECK(encircled_by_vectors(default_scene_ball(1.0), r, 8) ==
          doctest::Approx(encircled_flux(default_scene_ball(1.0), r, Orders::all)).epsilon(2e-3));
}

TEST_CASE("ball in a parallel beam: flux by exactly two refractions and what is absorbed") {
  // r < .1, .2, .5, 1 and all of it, by mpmath as above.
  const double clear[]{0.068070159543, 0.189809671423, 0.467802492604, 0.675373226753, 0.835410008460};
  const double dark[]{0.0252494113762, 0.0714763141426, 0.182642737413, 0.271472395863, 0.344300855};
  const double radii[]{0.1, 0.2, 0.5, 1.0, everything};
  for (int k = 0; k < 5; ++k) {
    check_digits(encircled_flux(ball_in_beam(1.5, 0), radii[k], Orders::two_refractions), clear[k], 1e-12);
    check_digits(encircled_flux(ball_in_beam(1.5, 0.5), radii[k], Orders::two_refractions), dark[k],
                 k < 4 ? 1e-12 : 5.1e-10);
  }
  check_digits(absorbed_flux(ball_in_beam(1.5, 0.1)), 0.158404392, 5.1e-10);
  check_digits(absorbed_flux(ball_in_beam(1.5, 1)), 0.763374312, 5.1e-10);
  for (const double sigma_a : {0.1, 1.0}) {
    const double x = 2 * sigma_a;           // no reflection: chords alone
    check_digits(absorbed_flux(ball_in_beam(1, sigma_a)), 1 - 2 * (1 - (1 + x) * std::exp(-x)) / (x * x), 1e-13);
  }
}

TEST_CASE("irradiance picture holds the encircled flux, on the axis what paraxial optics say") {
  const double power = 4 * std::numbers::pi * std::numbers::pi, half_width = 0.2;
  const int size = 128;
  const BallOnAxis ball = default_scene_ball();
  const auto picture = irradiance_picture(ball, power, half_width, size, size);

  double flux = 0, mirrored = 0;
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column) {
      flux += picture[row * size + column];
      mirrored = std::max(mirrored, std::abs(picture[row * size + column] - picture[column * size + row]));
    }
  flux *= std::pow(2 * half_width / size, 2) / power;
  // The square lies between its inscribed and its circumscribed circle; little falls between them.
  CHECK(flux > encircled_flux(ball, half_width, Orders::all) - 2e-8);
  CHECK(flux < encircled_flux(ball, half_width * std::numbers::sqrt2, Orders::all) + 2e-8);
  CHECK(mirrored < 1e-9);

  // Coarser or finer pixels hold the same flux, block by block.
  const auto coarse = irradiance_picture(ball, power, half_width, size / 4, size / 4);
  double worst = 0;
  for (int row = 0; row < size / 4; ++row)
    for (int column = 0; column < size / 4; ++column) {
      double mean = 0;
      for (int k = 0; k < 16; ++k) mean += picture[(4 * row + k / 4) * size + 4 * column + k % 4] / 16;
      worst = std::max(worst, std::abs(mean / coarse[row * size / 4 + column] - 1));
    }
  CHECK(worst < 1e-2);

  const auto mask = disc_mask(half_width, size, size, half_width);
  CHECK(relative_rmse(picture, picture, mask) == 0);
  auto scaled = picture;
  for (double& value : scaled) value *= 2;
  double squares = 0, sum = 0;
  int inside = 0;
  for (size_t k = 0; k < mask.size(); ++k)
    if (mask[k]) squares += picture[k] * picture[k], sum += picture[k], ++inside;
  CHECK(inside == doctest::Approx(std::numbers::pi / 4 * size * size).epsilon(0.003));
  CHECK(relative_rmse(scaled, picture, mask) == doctest::Approx(std::sqrt(squares * inside) / sum).epsilon(1e-12));
}

TEST_CASE("irradiance picture: near the centre of a smooth pattern the irradiance is flux over area") {
  // On a plane that touches a ball of low index no ray has crossed the axis yet: x = b m paraxially with
  // m = 1 - D / f, so E = E0 T^2 / m^2, and inner reflections add some R^2.
  const double n = 1.2;
  const BallOnAxis ball = ball_in_beam(n, 0, 1.0);
  const double half_width = 0.02;
  const auto picture = irradiance_picture(ball, std::numbers::pi, half_width, 4, 4);
  const double focus = n / (2 * (n - 1)), m = 1 - ball.plane_distance / focus, R = std::pow((n - 1) / (n + 1), 2);
  CHECK(picture[5] == doctest::Approx(std::pow((1 - R) / m, 2)).epsilon(1e-3));
}
