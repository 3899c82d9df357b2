#pragma once
// Small scenes by hand, for checks and tests.

#include <cmath>
#include <numbers>
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

/// A ball as a mesh: `rings` bands from pole to pole of `sectors` quads each, triangles at the poles, all corners at
/// `radius`. `smooth`: with the ball's own normals.
inline Mesh mesh_ball(const glm::dvec3& centre, double radius, int rings, int sectors, bool smooth, uint32_t material) {
  Mesh mesh;
  const auto corner = [&](int ring, int sector) {
    const double theta = std::numbers::pi * ring / rings, phi = 2 * std::numbers::pi * sector / sectors;
    const glm::dvec3 out(std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi));
    mesh.positions.emplace_back(centre + radius * out);
    mesh.normals.emplace_back(out);
  };
  corner(0, 0);
  for (int ring = 1; ring < rings; ++ring)
    for (int sector = 0; sector < sectors; ++sector) corner(ring, sector);
  corner(rings, 0);
  const auto at = [&](int ring, int sector) {
    return static_cast<uint32_t>(ring == 0 ? 0 : ring == rings ? 1 + (rings - 1) * sectors : 1 + (ring - 1) * sectors + sector % sectors);
  };
  for (int ring = 0; ring < rings; ++ring)
    for (int sector = 0; sector < sectors; ++sector) {
      if (ring > 0) mesh.triangles.emplace_back(at(ring, sector), at(ring + 1, sector), at(ring, sector + 1));
      if (ring < rings - 1) mesh.triangles.emplace_back(at(ring, sector + 1), at(ring + 1, sector), at(ring + 1, sector + 1));
    }
  mesh.materials.assign(mesh.triangles.size(), material);
  if (smooth) mesh.normal_indices = mesh.triangles;
  return mesh;
}

inline void add(Scene& scene, std::variant<Sphere, Plane, Triangle, Mesh> geometry, uint32_t material = none) {
  scene.shapes.push_back({"shape", {}, material, std::move(geometry)});
}

}  // namespace vitrum
