#include "reference/fresnel.hpp"

#include <cassert>
#include <cmath>
#include <limits>

namespace vitrum::reference {
namespace {

__extension__ typedef __float128 Quad;      // 113 bits: enough next to the critical angle, where long double is not

// One step of Newton's on long double's 64 bits gives all 113.
Quad square_root(Quad x) {
  if (x == 0) return 0;
  const Quad guess = std::sqrt(static_cast<long double>(x));
  return (guess + x / guess) / 2;
}

struct QuadVector {
  Quad x, y, z;
};

Quad dot(const QuadVector& a, const QuadVector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

QuadVector combined(Quad s, const QuadVector& a, Quad t, const QuadVector& b) {
  return {s * a.x + t * b.x, s * a.y + t * b.y, s * a.z + t * b.z};
}

QuadVector normalised(const QuadVector& v) { return combined(1 / square_root(dot(v, v)), v, 0, v); }

QuadVector unit(const glm::dvec3& v) { return normalised({v.x, v.y, v.z}); }

glm::dvec3 rounded(const QuadVector& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

// Snell: sin_t = n_i/n_t sin_i; negative where no refracted ray exists.
Quad cos2_theta_t(Quad n_i, Quad n_t, Quad cos_i) {
  const Quad ratio = n_i / n_t;
  return 1 - ratio * ratio * (1 - cos_i * cos_i);
}

}  // namespace

Fresnel fresnel(double n_i, double n_t, double cos_theta_i) {
  assert(n_i > 0 && n_t > 0 && cos_theta_i >= 0);
  if (cos_theta_i > 1) cos_theta_i = 1;
  if (n_i == n_t) return {0, 0, 0, 1, cos_theta_i, false};

  const Quad i = n_i, t = n_t, cos_i = cos_theta_i;
  const Quad cos2_t = cos2_theta_t(i, t, cos_i);
  if (cos2_t < 0) return {1, 1, 1, 0, 0, true};
  const Quad cos_t = square_root(cos2_t);

  const Quad perp = i * cos_i + t * cos_t, par = t * cos_i + i * cos_t;
  const Quad r_perp = (i * cos_i - t * cos_t) / perp, r_par = (t * cos_i - i * cos_t) / par;
  const Quad t_perp = 2 * i * cos_i / perp, t_par = 2 * i * cos_i / par;
  const Quad R = (r_perp * r_perp + r_par * r_par) / 2;
  // Power goes with n cos |E|^2, so T = n_t cos_t / (n_i cos_i) |t|^2; where cos_i = 0, t and T are 0.
  const Quad T = cos_i == 0 ? Quad(0) : t * cos_t / (i * cos_i) * (t_perp * t_perp + t_par * t_par) / 2;
  return {static_cast<double>(r_perp), static_cast<double>(r_par), static_cast<double>(R),
          static_cast<double>(T),      static_cast<double>(cos_t), false};
}

std::optional<glm::dvec3> refracted_direction(double n_i, double n_t, const glm::dvec3& direction,
                                              const glm::dvec3& normal) {
  const QuadVector d = unit(direction), n = unit(normal);
  if (n_i == n_t) return rounded(d);
  const Quad cos_i = -dot(d, n), ratio = static_cast<Quad>(n_i) / n_t;
  const Quad cos2_t = cos2_theta_t(n_i, n_t, cos_i);
  if (cos2_t < 0) return std::nullopt;
  return rounded(normalised(combined(ratio, d, ratio * cos_i - square_root(cos2_t), n)));
}

glm::dvec3 reflected_direction(const glm::dvec3& direction, const glm::dvec3& normal) {
  const QuadVector d = unit(direction), n = unit(normal);
  return rounded(normalised(combined(1, d, -2 * dot(d, n), n)));
}

double transmittance(double sigma_a, double distance) {
  assert(sigma_a >= 0 && distance >= 0);
  if (sigma_a == 0 || distance == 0) return 1;
  return static_cast<double>(std::exp(-static_cast<long double>(sigma_a) * distance));
}

glm::dvec3 transmittance(const glm::dvec3& sigma_a, double distance) {
  return {transmittance(sigma_a.r, distance), transmittance(sigma_a.g, distance), transmittance(sigma_a.b, distance)};
}

double sigma_a_from_rho_d(double rho_d) {
  assert(rho_d >= 0 && rho_d <= 1);
  if (rho_d == 0) return std::numeric_limits<double>::infinity();
  return static_cast<double>(1 / static_cast<Quad>(rho_d) - 1);
}

}  // namespace vitrum::reference
