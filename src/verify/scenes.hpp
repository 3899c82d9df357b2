#pragma once
// Small scenes by hand, for checks and tests.

#include <utility>
#include <variant>

#include "scene/scene.hpp"

namespace vitrum {

inline Material glass(double index, double sigma_a = 0, int priority = 0) {
  Material material;
  material.surface = Surface::dielectric;
  material.index.value = index;
  material.absorption = Spectrum(sigma_a);
  material.priority = priority;
  return material;
}

inline Material surface(Surface kind, double diffuse = 0, double emission = 0) {
  Material material;
  material.surface = kind;
  material.diffuse = Spectrum(diffuse);
  material.emission = Spectrum(emission);
  return material;
}

/// A box as a mesh of 12 triangles, fronts outwards.
inline Mesh box(const glm::vec3& low, const glm::vec3& high, uint32_t material) {
  Mesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.positions.emplace_back(k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z);
  for (const glm::uvec4 q : {glm::uvec4(0, 4, 6, 2), {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1},
                             {4, 5, 7, 6}}) {
    mesh.triangles.emplace_back(q.x, q.y, q.z);
    mesh.triangles.emplace_back(q.x, q.z, q.w);
  }
  mesh.materials.assign(12, material);
  return mesh;
}

inline void add(Scene& scene, std::variant<Sphere, Plane, Triangle, Mesh> geometry, uint32_t material = none) {
  scene.shapes.push_back({"shape", {}, material, std::move(geometry)});
}

}  // namespace vitrum
