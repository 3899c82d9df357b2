#pragma once
// A brute-force renderer in double, without caustics: what pictures of the camera pass are compared with.

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "reference/media.hpp"
#include "scene/scene.hpp"

namespace vitrum::reference {

/// Fingerprints of what was decided on the whole tree of rays of one film position. Two positions with the same ones
/// see the same things, so radiance is smooth between them.
struct Decisions {
  uint64_t surfaces = 0;                    ///< pieces met, from which side, branches that were cut or do not exist
  uint64_t shadows = 0;                     ///< which light reached which hit
  uint64_t texels = 0;                      ///< which texels were read
  bool operator==(const Decisions&) const = default;
};

struct Sample {
  Spectrum radiance{0.0};                   ///< [W/(m2 sr)], in the medium that the eye is in
  double energy_cut = 0.0;                  ///< sum of the weights of the branches that were cut
  Decisions decisions;
};

/// What changes when a film position is moved a little.
struct Edges {
  bool silhouette = false, shadow = false, texel = false;
  bool any() const { return silhouette || shadow || texel; }
};

/// Renders single film positions of a scene. Follows Scene::render but for sampling and caustics; knows point and
/// directional lights only.
///
/// Light is emission, background, and direct light (Lambertian and Phong) of lights whose shadow ray meets nothing;
/// glass is opaque to it. Both sides of a surface are lit from the side that the ray came from. At glass a ray splits
/// into both branches; a branch's weight is the product of its R, T and transmittances, as the largest of the channels.
/// It is cut where that is below min_weight or where the path has met max_depth surfaces. Radiance scales with n^2.
class Renderer {
 public:
  /// `scene` must outlive the renderer. Throws std::invalid_argument for a light with an area while lights are on.
  explicit Renderer(const Scene& scene);

  /// At a film position in pixels, x right and y down from the top left corner of the picture.
  Sample at(const glm::dvec2& position) const;

  /// What of the decisions changes when the position is moved by `distance` pixels left, right, up or down.
  Edges edges_within(const glm::dvec2& position, double distance) const;

 private:
  const Scene& scene_;
  Media media_at_eye_;
};

/// Renders each of `positions`.
std::vector<Sample> render(const Scene& scene, const std::vector<glm::dvec2>& positions);

}  // namespace vitrum::reference
