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

/// Lambert's formula: irradiance [W/m2] of the plane y = `place`.y by a parallelogram of radiance 1 above it.
inline double panel_irradiance(const glm::dvec3& corner, const glm::dvec3& u, const glm::dvec3& v,
                               const glm::dvec3& place) {
  const glm::dvec3 corners[] = {corner, corner + u, corner + u + v, corner + v};
  double sum = 0.0;
  for (size_t k = 0; k < 4; ++k) {
    const glm::dvec3 a = glm::normalize(corners[k] - place), b = glm::normalize(corners[(k + 1) % 4] - place);
    sum += std::acos(glm::clamp(glm::dot(a, b), -1.0, 1.0)) * glm::normalize(glm::cross(a, b)).y;
  }
  return std::abs(0.5 * sum);
}

inline void add(Scene& scene, std::variant<Sphere, Plane, Triangle, Mesh> geometry, uint32_t material = none) {
  scene.shapes.push_back({"shape", {}, material, std::move(geometry)});
}

/// Adds a parallelogram as a mesh of 2 n^2 triangles, ever larger along both edges, that shines to the side of
/// cross(u, v) [W/(m2 sr)].
inline void add_panel(Scene& scene, const glm::dvec3& corner, const glm::dvec3& u, const glm::dvec3& v, uint32_t n,
                      double radiance) {
  Material material = surface(Surface::opaque, 0.0, radiance);
  material.emission_is_light = true;
  scene.materials.push_back(material);
  Mesh mesh;
  for (uint32_t row = 0; row <= n; ++row)
    for (uint32_t column = 0; column <= n; ++column) {
      const double s = 1.0 * column / n, t = 1.0 * row / n;
      mesh.positions.emplace_back(corner + s * s * u + t * t * v);
    }
  for (uint32_t row = 0; row < n; ++row)
    for (uint32_t column = 0; column < n; ++column) {
      const uint32_t a = row * (n + 1) + column, b = a + 1, c = b + n + 1, d = a + n + 1;
      mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
    }
  mesh.materials.assign(mesh.triangles.size(), static_cast<uint32_t>(scene.materials.size() - 1));
  add(scene, mesh);
  scene.lights.push_back({"panel", {}, MeshLight{static_cast<uint32_t>(scene.shapes.size() - 1)}});
}

/// A ball of glass of radius 1 around the origin above a plane at y = -2, in the light of a lamp of 1 W at
/// `light_distance` above the centre or, if that is infinite, in a beam of 1 W. The other of the two lights is dark, so
/// that the same kernels serve both.
inline Scene ball_over_plane(double index, const Spectrum& sigma_a, double light_distance) {
  constexpr double pi = std::numbers::pi;
  const bool beam = std::isinf(light_distance);
  Scene scene;
  scene.film.width = scene.film.height = 4;
  scene.camera = {CameraType::pinhole, {0, 3, 8}, {0, 0, 0}, {0, 1, 0}, 45.0};
  scene.materials.push_back(glass(index));
  scene.materials[0].absorption = sigma_a;
  scene.materials.push_back(surface(Surface::opaque, 0.5));
  add(scene, Sphere{{0, 0, 0}, 1.0}, 0);
  add(scene, Plane{{0, -2, 0}, {0, 1, 0}, {}, {}}, 1);
  scene.lights.push_back({"beam", {}, DirectionalLight{{0, -1, 0}, Spectrum(beam ? 1 / pi : 0.0)}});
  scene.lights.push_back({"lamp", {}, PointLight{{0, beam ? 3.0 : light_distance, 0}, Spectrum(beam ? 0.0 : 1 / (4 * pi))}});
  scene.photons.estimate = PhotonEstimate::fixed_radius;
  scene.photons.radius = 0.05;
  scene.photons.max_depth = 31;
  return scene;
}

}  // namespace vitrum
