#include "reference/ball_caustic.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "reference/fresnel.hpp"
#include "reference/quadrature.hpp"

namespace vitrum::reference {
namespace {

using std::numbers::pi;

// A ray that meets the ball at incidence i in (0, pi/2). Order 0 is reflected outside, order p >= 1 crosses p chords.
struct Incidence {
  double sin_i, cos_i, i;
  double t;                                 // refracted angle
  double theta;                             // of the ray from the axis, before the ball
  double flux_density;                      // fraction of the light's flux per unit of i
  double R, T, tau;                         // at the surface; along one chord
};

Incidence at_incidence(const BallOnAxis& ball, double i) {
  Incidence at{};
  at.i = i;
  at.sin_i = std::sin(i);
  at.cos_i = std::cos(i);
  at.t = std::asin(at.sin_i / ball.index);
  // The ray passes the centre at distance radius sin_i = light_distance sin_theta. A point light sends
  // sin_theta dtheta / 2 of its flux into dtheta, a beam 2 sin_i cos_i di of what falls on the ball into di.
  if (std::isinf(ball.light_distance)) {
    at.theta = 0;
    at.flux_density = 2 * at.sin_i * at.cos_i;
  } else {
    const double ratio = ball.radius / ball.light_distance, sin_theta = ratio * at.sin_i;
    at.theta = std::asin(sin_theta);
    at.flux_density = ratio * ratio * at.sin_i * at.cos_i / std::cos(at.theta) / 2;
  }
  return at;
}

Incidence with_fresnel(const BallOnAxis& ball, double i) {
  Incidence at = at_incidence(ball, i);
  const Fresnel surface = fresnel(1.0, ball.index, at.cos_i);
  at.R = surface.R;
  at.T = surface.T;
  at.tau = transmittance(ball.sigma_a, 2 * ball.radius * std::cos(at.t));
  return at;
}

// Share of the flux at this incidence that leaves with the order.
double share(const Incidence& at, int order) {
  return order == 0 ? at.R : at.T * at.T * at.tau * std::pow(at.R * at.tau, order - 1);
}

// Angle of the leaving ray from the axis, away from the light. Every event turns the ray in the same sense, about the
// centre, whose distance from the ray stays radius sin_i.
double leaving_angle(const Incidence& at, int order) {
  if (order == 0) return at.theta + pi - 2 * at.i;
  return at.theta - 2 * (at.i - at.t) - (order - 1) * (pi - 2 * at.t);
}

// The leaving ray meets the plane at x = (plane_distance sin + radius sin_i) / cos of its angle, if cos > 0.
double landing_numerator(const BallOnAxis& ball, const Incidence& at, double angle) {
  return ball.plane_distance * std::sin(angle) + ball.radius * at.sin_i;
}

// Below this incidence the inner reflections leave nothing to speak of: high orders live close to pi/2.
double first_incidence(const BallOnAxis& ball, int order) {
  const auto is_dark = [&](double i) { return order > 1 && std::pow(with_fresnel(ball, i).R, order - 1) < 1e-20; };
  double dark = 0, lit = pi / 2;
  if (!is_dark(dark)) return 0;
  for (int k = 0; k < 50; ++k) {
    const double middle = (dark + lit) / 2;
    (is_dark(middle) ? dark : lit) = middle;
  }
  return dark;
}

double encircled_by_order(const BallOnAxis& ball, double r, int order, double tolerance) {
  // Lands within r where both are negative, which holds for no ray that leaves upwards.
  const auto beyond = [&](double i, double side) {
    const Incidence at = at_incidence(ball, i);
    const double angle = leaving_angle(at, order);
    if (std::isinf(r)) return -std::cos(angle);
    return side * landing_numerator(ball, at, angle) - r * std::cos(angle);
  };
  // Over the incidences that count the leaving ray turns about the ball only a few times, whatever the order.
  const double first = first_incidence(ball, order);
  std::vector<double> breaks{first, pi / 2};
  for (const double side : {-1.0, 1.0})
    for (const double root : roots([&](double i) { return beyond(i, side); }, first, pi / 2, 512))
      breaks.push_back(root);
  std::sort(breaks.begin(), breaks.end());

  double sum = 0;
  for (size_t k = 1; k < breaks.size(); ++k) {
    const double middle = (breaks[k - 1] + breaks[k]) / 2;
    if (beyond(middle, 1) >= 0 || beyond(middle, -1) >= 0) continue;
    const auto density = [&](double i) {
      const Incidence at = with_fresnel(ball, i);
      return at.flux_density * share(at, order);
    };
    sum += integral(density, breaks[k - 1], breaks[k], tolerance);
  }
  return sum;
}

// The last order that matters: those above it carry less than `tail` of the light's flux in all.
int last_order(const BallOnAxis& ball, double tail) {
  for (int order = 1;; order += 1 + order / 8) {
    const auto above = [&](double i) {
      const Incidence at = with_fresnel(ball, i);
      const double lost = at.T + at.R * (1 - at.tau);   // 1 - R tau
      return lost > 0 ? at.flux_density * share(at, order + 1) / lost : 0.0;
    };
    if (integral(above, 0, pi / 2, tail / 100) < tail) return order;
  }
}

// Spreads `flux` over the circle of radius r about the square's centre.
void spread_over_circle(std::vector<double>& picture, double half_width, int width, int height, double r, double flux) {
  std::vector<double> angles{0, 2 * pi};
  for (int k = 0; k <= width; ++k) {
    const double cosine = half_width * (2.0 * k / width - 1) / r;
    if (std::abs(cosine) < 1) angles.insert(angles.end(), {std::acos(cosine), 2 * pi - std::acos(cosine)});
  }
  for (int k = 0; k <= height; ++k) {
    const double sine = half_width * (2.0 * k / height - 1) / r;
    if (std::abs(sine) < 1) {
      const double angle = std::asin(sine);
      angles.insert(angles.end(), {angle < 0 ? angle + 2 * pi : angle, pi - angle});
    }
  }
  std::sort(angles.begin(), angles.end());
  for (size_t k = 1; k < angles.size(); ++k) {
    const double middle = (angles[k - 1] + angles[k]) / 2;
    const double column = (r * std::cos(middle) / half_width + 1) / 2 * width;
    const double row = (1 - r * std::sin(middle) / half_width) / 2 * height;
    if (column < 0 || column >= width || row < 0 || row >= height) continue;
    picture[static_cast<size_t>(row) * width + static_cast<size_t>(column)] +=
        flux * (angles[k] - angles[k - 1]) / (2 * pi);
  }
}

}  // namespace

double encircled_flux(const BallOnAxis& ball, double r, Orders orders) {
  assert(ball.index >= 1 && ball.plane_distance >= ball.radius && ball.light_distance > ball.radius && r >= 0);
  if (orders == Orders::two_refractions) return encircled_by_order(ball, r, 1, 1e-13);
  double sum = 0;
  for (int order = last_order(ball, 5e-11); order >= 0; --order) sum += encircled_by_order(ball, r, order, 1e-14);
  return sum;
}

double absorbed_flux(const BallOnAxis& ball) {
  // Each crossing of a chord takes 1 - tau of what is left; sum over all crossings.
  const auto density = [&](double i) {
    const Incidence at = with_fresnel(ball, i);
    const double lost = at.T + at.R * (1 - at.tau);
    return lost > 0 ? at.flux_density * at.T * (1 - at.tau) / lost : 0.0;
  };
  return integral(density, 0, pi / 2, 1e-13);
}

std::vector<double> irradiance_picture(const BallOnAxis& ball, double power, double half_width, int width, int height) {
  const double pixel = 2 * half_width / std::max(width, height);
  const double ring = pixel / 64;           // flux is gathered in rings first: far fewer circles than rays
  const size_t rings = static_cast<size_t>(std::ceil(half_width * std::numbers::sqrt2 / ring));
  std::vector<double> flux(rings), flux_radius(rings);

  const int cells = 1 << 16, orders = last_order(ball, 1e-8);
  const double step = pi / 2 / cells;
  for (int cell = 0; cell < cells; ++cell) {
    const Incidence at = with_fresnel(ball, (cell + 0.5) * step);
    for (int order = 0; order <= orders; ++order) {
      const double angle = leaving_angle(at, order);
      if (std::cos(angle) <= 0) continue;
      const double r = std::abs(landing_numerator(ball, at, angle)) / std::cos(angle);
      if (!(r < rings * ring)) continue;
      const double part = power * at.flux_density * share(at, order) * step;
      flux[static_cast<size_t>(r / ring)] += part;
      flux_radius[static_cast<size_t>(r / ring)] += part * r;
    }
  }

  std::vector<double> picture(static_cast<size_t>(width) * height);
  for (size_t k = 0; k < rings; ++k)
    if (flux[k] > 0) spread_over_circle(picture, half_width, width, height, flux_radius[k] / flux[k], flux[k]);
  const double area = 4 * half_width * half_width / (static_cast<double>(width) * height);
  for (double& value : picture) value /= area;
  return picture;
}

std::vector<bool> disc_mask(double half_width, int width, int height, double radius) {
  std::vector<bool> mask;
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column)
      mask.push_back(std::hypot(half_width * ((2 * column + 1.0) / width - 1),
                                half_width * ((2 * row + 1.0) / height - 1)) < radius);
  return mask;
}

double relative_rmse(const std::vector<double>& picture, const std::vector<double>& truth,
                     const std::vector<bool>& mask) {
  assert(picture.size() == truth.size() && mask.size() == truth.size());
  double squares = 0, sum = 0;
  size_t count = 0;
  for (size_t k = 0; k < truth.size(); ++k) {
    if (!mask[k]) continue;
    squares += (picture[k] - truth[k]) * (picture[k] - truth[k]);
    sum += truth[k];
    ++count;
  }
  assert(count > 0 && sum > 0);
  return std::sqrt(squares / count) / (sum / count);
}

}  // namespace vitrum::reference
