#pragma once
// Which media a point lies in: how the medium stacks of rays begin that leave the eye or a light.

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "scene/scene.hpp"

namespace vitrum {

/// Materials (indices into Scene::materials) of the dielectric shapes that contain `point` [m], those of the highest
/// priority first, otherwise in the order of the shapes; a material stands there once for every shape around the point.
///
/// Spheres and planes are exact. A mesh's dielectric faces of one material need not be closed: a liquid is often an
/// open sheet whose other borders are opaque walls. So rays are cast into fixed directions, and each whose first
/// dielectric face of that mesh and material is not hidden behind an opaque surface votes: inside if it meets the
/// face's back, outside if its front. The majority decides; without a vote the point is outside. Every triangle is
/// tested against every ray, which is meant for a few points a scene. A single exact triangle contains nothing.
std::vector<uint32_t> media_at(const Scene& scene, glm::dvec3 point);

}  // namespace vitrum
