#pragma once
// Small scenes that between them build the kernels with every switch of kernels/switches.h on and off: what a compiler
// does with them is seen by rendering these.

#include <string>
#include <vector>

#include "verify/scenes.hpp"

namespace vitrum {

/// Checks of two colours, with texels by hand.
inline Texture checks(TextureFilter filter, bool clamp) {
  Texture texture;
  texture.filter = filter;
  texture.clamp = clamp;
  texture.width = 3;
  texture.height = 2;
  texture.texels = {{0.8f, 0.7f, 0.6f}, {0.2f, 0.3f, 0.4f}, {0.9f, 0.5f, 0.1f},
                    {0.1f, 0.6f, 0.2f}, {0.7f, 0.7f, 0.9f}, {0.3f, 0.2f, 0.5f}};
  return texture;
}

/// A white floor that a camera looks down to at a slant.
inline Scene over_a_floor(int size, uint64_t photons) {
  Scene scene;
  scene.camera = {CameraType::pinhole, {1.4, 1.5, 1.8}, {0, 0.3, 0}, {0, 1, 0}, 45};
  scene.film.width = scene.film.height = size;
  scene.background = {0.1, 0.3, 0.6};
  scene.render.samples = 2;
  scene.photons.count = photons;
  scene.materials.push_back(surface(Surface::opaque, 0.7));
  add(scene, Plane{{0, 0, 0}, {0, 1, 0}, {0.7, 0, 0}, {0, 0, 0.7}}, 0);
  return scene;
}

inline void add_point_light(Scene& scene, const glm::dvec3& position) {
  scene.lights.push_back({"point", {}, PointLight{position, Spectrum(3.0)}});
}

/// A clear ball in a lamp's light: one body of glass and nothing else.
inline Scene clear_ball(int size, uint64_t photons) {
  Scene scene = over_a_floor(size, photons);
  scene.materials.push_back(glass(1.5));
  add(scene, Sphere{{0, 0.5, 0}, 0.3}, 1);
  add_point_light(scene, {0.3, 1.6, 0.2});
  return scene;
}

/// A floor that shows its colour, without any light.
inline Scene bare_floor(int size) {
  Scene scene = over_a_floor(size, 0);
  scene.materials[0].surface = Surface::unlit;
  return scene;
}

/// Mirrors in sunlight.
inline Scene mirrors(int size, uint64_t photons) {
  Scene scene = over_a_floor(size, photons);
  scene.materials.push_back(surface(Surface::mirror));
  add(scene, Sphere{{0, 0.5, 0}, 0.3}, 1);
  add(scene, Triangle{{-0.8, 0.1, -0.6}, {0.8, 0.1, -0.6}, {0, 1.4, -0.6}, {}, {}, {}}, 1);
  scene.lights.push_back({"sun", {}, DirectionalLight{glm::normalize(glm::dvec3(0.3, -2, 0.4)), Spectrum(2.0)}});
  return scene;
}

/// A mesh of glass that touches nothing, by a reflectance that is the same at every angle.
inline Scene constant_reflectance(int size, uint64_t photons) {
  Scene scene = over_a_floor(size, photons);
  scene.materials.push_back(glass(1.5));
  add(scene, box({-0.3f, 0.2f, -0.3f}, {0.3f, 0.8f, 0.3f}, 1));
  add_point_light(scene, {0.3, 1.6, 0.2});
  scene.render.constant_reflectance = 0.1;
  scene.render.sampling = scene.photons.sampling = Sampling::independent;
  return scene;
}

/// All at once: meshes of glass that stand on the floor and in each other, an eye in a medium, textures, highlights,
/// each kind of light. Photons are gathered by the estimate.
inline Scene everything(int size, uint64_t photons, PhotonEstimate estimate) {
  Scene scene = over_a_floor(size, photons);
  scene.textures = {checks(TextureFilter::bilinear, false), checks(TextureFilter::nearest, true)};
  scene.materials[0].diffuse_texture = 0;
  scene.materials[0].specular = Spectrum(0.2);
  scene.materials[0].shininess = 20;
  const auto material = [&scene](const Material& m) {
    scene.materials.push_back(m);
    return static_cast<uint32_t>(scene.materials.size() - 1);
  };
  const uint32_t crystal = material(glass(1.5, 0.4, 1));
  scene.materials[crystal].diffuse = Spectrum(0.1);
  scene.materials[crystal].specular = Spectrum(0.1);
  scene.materials[crystal].shininess = 50;
  add(scene, box({-0.4f, 0, -0.4f}, {0.3f, 0.5f, 0.3f}, crystal));
  add(scene, box({-0.2f, 0.5f, -0.2f}, {0.2f, 0.8f, 0.2f}, material(glass(1.33, 0.1))));
  add(scene, Sphere{{0.3, 0.3, 0.1}, 0.25}, material(glass(1.7, 0, 2)));
  // The eye is in this one.
  add(scene, Sphere{{1.4, 1.5, 1.8}, 0.2}, material(glass(1.1, 0.2)));
  const uint32_t mirror = material(surface(Surface::mirror));
  add(scene, box({-0.9f, 0.1f, -0.8f}, {0.9f, 1.2f, -0.7f}, mirror));
  const uint32_t patterned = material(surface(Surface::opaque, 0.5));
  scene.materials[patterned].diffuse_texture = 1;
  add(scene, Sphere{{-0.8, 0.2, 0.3}, 0.2}, patterned);
  // A shining roof, whose faces are lights.
  const uint32_t shining = material(surface(Surface::opaque, 0, 3.0));
  scene.materials[shining].emission_is_light = true;
  scene.lights.push_back({"mesh", {}, MeshLight{static_cast<uint32_t>(scene.shapes.size())}});
  add(scene, box({-0.6f, 2.0f, -0.5f}, {0.4f, 2.1f, 0.5f}, shining));
  add_point_light(scene, {0.9, 1.6, 0.2});
  scene.lights.push_back({"sun", {}, DirectionalLight{glm::normalize(glm::dvec3(0.3, -2, 0.4)), Spectrum(0.5)}});
  scene.lights.push_back({"quad", {}, QuadLight{{-1, 1.9, 0}, {0.3, 0, 0}, {0, 0, 0.3}, Spectrum(3.0)}});
  scene.lights.push_back({"disc", {}, DiscLight{{1, 1.8, -0.3}, {0, -1, 0}, 0.2, Spectrum(3.0)}});
  scene.lights.push_back({"ball", {}, SphereLight{{-1.2, 1.5, 1}, 0.1, Spectrum(3.0)}});
  scene.render.max_depth = 40;
  scene.photons.nearest = 8;
  scene.photons.estimate = estimate;
  return scene;
}

struct NamedScene {
  std::string name;
  Scene scene;
};

/// All of them, of size x size pixels, with about `photons` photons for each that has any.
inline std::vector<NamedScene> switch_scenes(int size, uint64_t photons) {
  return {{"a clear ball", clear_ball(size, photons)},
          {"a bare floor", bare_floor(size)},
          {"mirrors", mirrors(size, photons)},
          {"constant reflectance", constant_reflectance(size, photons)},
          {"everything, radius", everything(size, photons, PhotonEstimate::automatic_radius)},
          {"everything, footprints", everything(size, photons, PhotonEstimate::footprints)},
          {"everything, nearest", everything(size, photons, PhotonEstimate::nearest)}};
}

}  // namespace vitrum
