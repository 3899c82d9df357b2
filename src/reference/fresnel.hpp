#pragma once
// Fresnel, Snell and Bouguer as textbooks define them, evaluated in quadruple precision: what kernels are counted
// against, in ulps of float. Correctly rounded for that purpose for indices 1 to 4 (ratios down to 1 + 2^-23).

#include <glm/glm.hpp>
#include <optional>

namespace vitrum::reference {

/// What an interface between two clear media does to unpolarised light.
struct Fresnel {
  double r_perp = 0.0;                      ///< amplitude ratio, E across the plane of incidence; in [-1, 1]
  double r_par = 0.0;                       ///< amplitude ratio, E in the plane of incidence, +1 where light grazes out
  double R = 0.0;                           ///< share of the power that is reflected, (r_perp^2 + r_par^2) / 2
  double T = 1.0;                           ///< share of the power that is refracted, by the amplitudes t, not as 1 - R
  double cos_theta_t = 1.0;                 ///< cosine of the refracted angle; 0 for total reflection
  bool total_reflection = false;            ///< no refracted ray: R = 1, T = 0, r_perp and r_par are of modulus 1
};

/// From index `n_i` into `n_t` at the incident cosine in [0, 1] (above 1 counts as 1). Hecht, Optics, 4.34 to 4.45:
/// r_perp = (n_i cos_i - n_t cos_t) / (n_i cos_i + n_t cos_t),
/// r_par = (n_t cos_i - n_i cos_t) / (n_t cos_i + n_i cos_t).
/// Equal indices are no interface: R = 0, T = 1 at every angle.
Fresnel fresnel(double n_i, double n_t, double cos_theta_i);

/// Direction of the refracted ray, unit length, by Snell's law in vector form. `direction` points at the interface and
/// `normal` to the side it comes from; both are normalised here. None for total reflection.
std::optional<glm::dvec3> refracted_direction(double n_i, double n_t, const glm::dvec3& direction,
                                              const glm::dvec3& normal);

/// Direction of the mirrored ray, unit length; arguments as for refracted_direction.
glm::dvec3 reflected_direction(const glm::dvec3& direction, const glm::dvec3& normal);

/// exp(-sigma_a distance), Bouguer's law. `sigma_a` [1/m] and `distance` [m] are >= 0 and may be infinite:
/// nothing is absorbed over distance 0 or where sigma_a is 0, everything where either is infinite and the other > 0.
double transmittance(double sigma_a, double distance);

/// The same in each channel.
glm::dvec3 transmittance(const glm::dvec3& sigma_a, double distance);

/// The worksheet's sigma_a = 1/rho_d - 1 [1/m] for rho_d in [0, 1]; +infinity for 0.
double sigma_a_from_rho_d(double rho_d);

}  // namespace vitrum::reference
