#pragma once
// What a ray meets first, by trying everything: exact shapes and every triangle of every mesh, in double.

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "reference/media.hpp"
#include "scene/scene.hpp"

namespace vitrum::reference {

/// One piece of surface: a sphere, a plane, a triangle, or one triangle of a mesh.
struct Piece {
  uint32_t shape = none;                    ///< index into Scene::shapes
  uint32_t primitive = 0;                   ///< triangle of a mesh, else 0
  auto operator<=>(const Piece&) const = default;
};

/// A half-line. Pieces in `left` lie at the origin and belong to what the ray leaves: they are not met again (but for
/// the far side of a sphere), and neither is what touches them there, so the origin needs no offset.
struct Ray {
  glm::dvec3 origin{0.0};                   ///< [m]
  glm::dvec3 direction{0, 0, 1};            ///< unit length
  std::vector<Piece> left;                  ///< empty for a ray that starts in the open
  bool from_contact = false;                ///< opaque pieces at the origin are met: they lie behind the glass
};

struct Hit {
  double t = 0.0;                           ///< distance from the ray's origin [m]
  Piece piece;                              ///< of several at the same place the least: shape first, then primitive
  uint32_t material = none;                 ///< index into Scene::materials
  glm::dvec3 position{0.0};                 ///< [m]
  glm::dvec3 geometric_normal{0.0};         ///< unit length, to the front of the piece
  glm::dvec3 shading_normal{0.0};           ///< unit length, on the same side; interpolated where a mesh has normals
  std::optional<glm::dvec2> texcoord;       ///< (u0, v0) before the texture's scale and offset
  bool from_front = true;                   ///< the ray arrives from the side of the geometric normal
  std::vector<Piece> coincident;            ///< all pieces at this place, `piece` among them
  std::vector<Piece> glass;                 ///< those of them that are dielectric
  std::vector<Passage> passages;            ///< bodies of glass that the ray enters or leaves here, each once
};

/// The first hit of the ray, or none.
std::optional<Hit> closest_hit(const Scene& scene, const Ray& ray);

/// Whether any piece lies on the ray before `distance` [m, may be infinite].
bool is_occluded(const Scene& scene, const Ray& ray, double distance);

/// Materials of the dielectrics whose insides contain `point`, one entry for each body: inside a sphere, behind a
/// plane, and where a mesh's faces of one material have a winding number above 1/2 (Jacobson et al. 2013). The first in
/// the scene counts as entered last.
Media media_at(const Scene& scene, const glm::dvec3& point);

}  // namespace vitrum::reference
