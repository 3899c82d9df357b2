#pragma once
// The caustic that a ball of glass throws on a plane, by quadrature over the angle of incidence: encircled flux to
// nine digits, and the irradiance picture that renders are scored against.

#include <cstddef>
#include <limits>
#include <vector>

namespace vitrum::reference {

/// A ball in air between a light and a plane. The light is a point straight above the centre or a beam from there;
/// the plane lies square to that axis.
struct BallOnAxis {
  double radius = 0.3;                      ///< [m]
  double index = 1.5;                       ///< of refraction, >= 1
  double sigma_a = 0.0;                     ///< absorption inside [1/m]
  double plane_distance = 0.5;              ///< from centre to plane [m], >= radius
  double light_distance = 0.5;              ///< from centre to light [m], > radius; infinity: a parallel beam
};

/// The default scene's ball, light and lawn.
inline BallOnAxis default_scene_ball(double sigma_a = 0.0) { return {0.3, 1.5, sigma_a, 0.5, 0.5}; }

/// A ball in a parallel beam, in units of its own radius.
inline BallOnAxis ball_in_beam(double index, double sigma_a, double plane_distance = 2.0) {
  return {1.0, index, sigma_a, plane_distance, std::numeric_limits<double>::infinity()};
}

/// Which paths count: exactly two refractions, or all that meet the ball (reflected outside, or refracted in, any
/// number of bounces inside, and out).
enum class Orders { two_refractions, all };

/// Flux that reaches the plane by way of the ball within distance `r` [m] of the axis (infinity: all of it), as a
/// fraction of 4 pi I for a point light, of pi radius^2 E0 for a beam. Absolute error below 1e-10.
double encircled_flux(const BallOnAxis& ball, double r, Orders orders);

/// Flux that the ball absorbs, as a fraction of the same.
double absorbed_flux(const BallOnAxis& ball);

/// Irradiance [W/m2] on the plane by all orders, averaged over each of width x height pixels of the square
/// |x|, |z| <= half_width [m], for a light of `power` [W] (4 pi I or pi radius^2 E0). Rows from the top.
/// Flux is binned over circles, each by the length of its arcs, so that none is lost where irradiance diverges.
std::vector<double> irradiance_picture(const BallOnAxis& ball, double power, double half_width, int width, int height);

/// Which pixels of such a square have their centre within `radius` of its own.
std::vector<bool> disc_mask(double half_width, int width, int height, double radius);

/// Root of the mean squared difference over the pixels in `mask`, divided by the mean of `truth` there.
double relative_rmse(const std::vector<double>& picture, const std::vector<double>& truth,
                     const std::vector<bool>& mask);

}  // namespace vitrum::reference
