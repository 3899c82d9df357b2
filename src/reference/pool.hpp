#pragma once
// The light of a lamp on the bottom of a pool of still water, by quadrature over the angle.

namespace vitrum::reference {

/// A point light straight above plane water over a plane bottom; light that the bottom throws back is left out.
struct Pool {
  double index = 1.333;                     ///< of refraction, >= 1
  double sigma_a = 0.0;                     ///< absorption in the water [1/m]
  double height = 1.0;                      ///< of the light above the water [m], > 0
  double depth = 1.0;                       ///< of the water [m], > 0
};

/// Irradiance of the bottom on the axis, per unit of intensity [1/m2]: T exp(-sigma_a depth) / (height + depth / index)^2.
double irradiance_on_axis(const Pool& pool);

/// Flux that reaches the bottom within distance `r` [m] of the axis (infinity: all of it), as a fraction of 4 pi I.
/// A ray at `theta` from the axis lands at height tan(theta) + depth tan(theta_t). Absolute error below 1e-12.
double encircled_flux(const Pool& pool, double r);

}  // namespace vitrum::reference
