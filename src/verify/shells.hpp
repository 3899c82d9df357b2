#pragma once
// Concentric shells that touch: as exact spheres, as meshes, and how far the meshes are off.

#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <utility>
#include <vector>

#include "verify/closed_forms.hpp"
#include "verify/scenes.hpp"

namespace vitrum {

/// A ball of glass, in its hole a liquid of index `n`, and ice in that.
inline std::vector<Shell> glass_liquid_ice(double n) {
  return {{1.0, 1.5, {0.1, 0.5, 2.0}}, {0.8, n, {0.5, 0.3, 0.1}}, {0.4, 1.31, {0.5, 1.0, 0.2}}};
}

/// Adds a medium as a material; returns its number.
inline uint32_t add_medium(Scene& scene, double index, const Spectrum& sigma_a, int priority = 0) {
  scene.materials.push_back(glass(index, 0, priority));
  scene.materials.back().absorption = sigma_a;
  return static_cast<uint32_t>(scene.materials.size() - 1);
}

/// A mesh with its normals, turned about the origin.
inline Mesh turned(Mesh mesh, const glm::quat& turn) {
  for (std::vector<glm::vec3>* vectors : {&mesh.positions, &mesh.normals})
    for (glm::vec3& v : *vectors) v = turn * v;
  return mesh;
}

/// A ball with a hole: the faces of `hole` turned inside out. Both with normals.
inline Mesh hollowed(Mesh ball, const Mesh& hole) {
  const auto positions = static_cast<uint32_t>(ball.positions.size());
  const auto normals = static_cast<uint32_t>(ball.normals.size());
  ball.positions.insert(ball.positions.end(), hole.positions.begin(), hole.positions.end());
  for (const glm::vec3& normal : hole.normals) ball.normals.push_back(-normal);
  for (size_t k = 0; k < hole.triangles.size(); ++k) {
    const glm::uvec3 corners = hole.triangles[k], n = hole.normal_indices[k];
    ball.triangles.push_back(positions + glm::uvec3(corners.x, corners.z, corners.y));
    ball.normal_indices.push_back(normals + glm::uvec3(n.x, n.z, n.y));
  }
  // All of one piece of glass.
  ball.materials.resize(ball.triangles.size(), ball.materials.front());
  return ball;
}

/// Adds shells around the origin as meshes of `rings` rings (mesh_ball), with the balls' normals: the outermost has a
/// hole which the second fills up to the very corners of the wall, each further one floats in the one before it.
/// `turn` turns all of them.
inline void add_mesh_shells(Scene& scene, const std::vector<Shell>& shells, int rings, const glm::quat& turn = {1, 0, 0, 0}) {
  std::vector<Mesh> balls;
  for (const Shell& shell : shells) {
    const uint32_t material = add_medium(scene, shell.index, shell.sigma_a);
    balls.push_back(turned(mesh_ball({0, 0, 0}, shell.radius, rings, 2 * rings, true, material), turn));
  }
  if (balls.size() > 1) balls[0] = hollowed(balls[0], balls[1]);
  for (Mesh& ball : balls) add(scene, std::move(ball));
}

/// How far off the shells what two such meshes say together may be, (4 F(n) - F(n/2)) / 3 with n rings, of an incident
/// radiance of 1, on average.
///
/// Facets lie up to h^2/4 under a ball of radius 1, h^2/6 on average, for h = pi/n. Rays that bunch up on few facets
/// behind the first border may meet their middles alone, or their corners: then the mean depth of facets is off by up to
/// h^2/6, and what is extrapolated by (4 h^2 + (2 h)^2)/18 = 4 h^2/9. With the length of a path radiance changes by at
/// most sigma exp(-2 sigma c)/c <= 1/(2 e c^2), c = cos theta_t: .25/m on average, for an index of 1.333 and more. The
/// next term, of 1/n^4, is far smaller. All of it times the radii of the borders that a ray meets after the first.
inline double facets_bound(int rings, const std::vector<Shell>& shells) {
  double borders = -shells.front().radius;
  for (const Shell& shell : shells) borders += 2 * shell.radius;
  const double h = std::numbers::pi / rings;
  return 4 * h * h / 9 * 0.25 * borders;
}

}  // namespace vitrum
