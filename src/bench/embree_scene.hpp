#pragma once
// Embree as the peer of kernels/tree.h: the same triangles, the same rays, its own tree.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace vitrum {

/// As kernels/checks/rays.cl takes it.
struct RayData {
  glm::vec3 origin{0};          ///< [m]
  float t_min = 0.0f;           ///< [m]
  glm::vec3 direction{0};       ///< of unit length
  float t_max = 0.0f;           ///< [m]
};
static_assert(sizeof(RayData) == 8 * sizeof(float));

class EmbreeScene {
 public:
  /// Builds the tree over the mesh, with RTC_SCENE_FLAG_ROBUST and build quality medium. Throws Error as build_tree does.
  EmbreeScene(const Mesh& mesh, unsigned threads);
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  /// rtcIntersect1: where each ray meets the first triangle, INFINITY: nowhere.
  void closest(const std::vector<RayData>& rays, std::vector<float>& t) const;
  /// rtcOccluded1: 1 for each ray that meets a triangle.
  void occluded(const std::vector<RayData>& rays, std::vector<uint32_t>& met) const;

  /// What Embree holds for it, corners and indices included [bytes].
  double bytes() const;
  /// Embree's version, and the instruction sets and features that it was built with, as it tells of itself.
  static std::string description();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vitrum
