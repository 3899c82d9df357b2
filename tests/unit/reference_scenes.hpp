#pragma once
// Small scenes by hand, for the tests of the reference renderer.

#include "reference/renderer.hpp"
#include "verify/scenes.hpp"

namespace vitrum {

/// A camera of one pixel that looks from `eye` to `look_at` through the centre of its film, (0.5, 0.5).
inline Scene looking(const glm::dvec3& eye, const glm::dvec3& look_at, const glm::dvec3& up = {0, 0, 1}) {
  Scene scene;
  scene.camera = {CameraType::pinhole, eye, look_at, up, 1.0};
  scene.film.width = scene.film.height = 1;
  scene.render.min_weight = 1e-14;
  scene.render.max_depth = 200;
  return scene;
}

inline reference::Sample seen(const Scene& scene) { return reference::Renderer(scene).at({0.5, 0.5}); }

inline void add_point_light(Scene& scene, const glm::dvec3& position, double intensity) {
  scene.lights.push_back({"lamp", {}, PointLight{position, Spectrum(intensity)}});
}

}  // namespace vitrum
