#pragma once
// The default scene's caustic as a picture whose irradiance is known.

#include <cmath>
#include <numbers>
#include <vector>

#include "reference/ball_caustic.hpp"
#include "render/render.hpp"
#include "verify/scenes.hpp"

namespace vitrum {

/// The default scene's ball and lamp above a plane, seen from right below the ball. The picture shows a square of the plane.
class CausticPlate {
 public:
  static constexpr double half_width = 0.2;   ///< of the square [m]
  static constexpr int size = 128;            ///< of the picture [pixels]
  static constexpr double power = 4 * std::numbers::pi;  ///< of the lamp's 1 W/sr [W]

  /// The exact ball.
  CausticPlate() : CausticPlate(Sphere{{0, 0.5, 0}, 0.3}) {}
  /// The ball as a mesh of rings of twice as many facets, with its own normals.
  explicit CausticPlate(int rings) : CausticPlate(mesh_ball({0, 0.5, 0}, 0.3, rings, 2 * rings, true, 0)) {}

  Scene scene;                                ///< a render of its view `caustics` is what the functions below take

  /// Irradiance [W/m2] by pixel: that of the ball, by quadrature, and that of a render.
  const std::vector<double>& truth() const { return truth_; }
  static std::vector<double> irradiance(const RenderResult& result) {
    const std::vector<double> radiance = result.film.mean("caustics");
    std::vector<double> red;
    for (size_t i = 0; i < radiance.size(); i += 3) red.push_back(radiance[i] * std::numbers::pi / reflectance);
    return red;
  }

  /// Root of the mean squared error over the pixels within `half_width` of the axis, relative to the mean of the truth.
  double error(const RenderResult& result) const {
    return reference::relative_rmse(irradiance(result), truth_, reference::disc_mask(half_width, size, size, half_width));
  }

 private:
  static constexpr double reflectance = 0.5;
  static constexpr double eye_height = 0.19;  // the ball ends at .2 m

  explicit CausticPlate(std::variant<Sphere, Plane, Triangle, Mesh> ball)
      : truth_(reference::irradiance_picture(reference::default_scene_ball(), power, half_width, size, size)) {
    const double fov = 2 * std::atan(half_width / eye_height) * 180 / std::numbers::pi;
    scene.camera = {CameraType::pinhole, {0, eye_height, 0}, {0, 0, 0}, {0, 0, 1}, fov};
    scene.film.width = scene.film.height = size;
    scene.materials = {glass(1.5), surface(Surface::opaque, reflectance)};
    const bool is_mesh = std::holds_alternative<Mesh>(ball);
    add(scene, std::move(ball), is_mesh ? none : 0);
    add(scene, Plane{{0, 0, 0}, {0, 1, 0}, {}, {}}, 1);
    scene.lights.push_back({"lamp", {}, PointLight{{0, 1, 0}, Spectrum(1.0)}});
  }

  std::vector<double> truth_;
};

}  // namespace vitrum
