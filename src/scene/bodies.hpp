#pragma once
// The bodies of a mesh: its faces by material. A file may hold a glass and what is in it as one mesh.

#include <cstdint>
#include <vector>

#include "scene/scene.hpp"

namespace vitrum {

struct Body {
  uint32_t material = none;     ///< index into Scene::materials
  glm::vec3 low{0.0f}, high{0.0f};  ///< its box [m]
  bool closed = false;          ///< as many faces go along each edge one way as the other: a ray that enters leaves again
};

/// The bodies of a mesh, in the order in which their materials first appear. Corners at the same place are one corner.
std::vector<Body> bodies_of(const Mesh& mesh);

}  // namespace vitrum
