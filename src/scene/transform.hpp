#pragma once
// Transforms of shapes: read from a scene file, applied in double when a shape is loaded.

#include <glm/glm.hpp>

#include "scene/scene.hpp"
#include "scene/toml_table.hpp"

namespace vitrum {

/// An affine map from a shape's own space, in the scene file's units, to world space in metres.
class Transform {
 public:
  Transform() = default;
  /// The key `transform` of `shape`, or the identity, followed by the change from units to metres.
  Transform(const TomlTable& shape, double metres_per_unit);

  /// Maps a point; every coordinate is finite and within length_limit, else throws Error naming the shape.
  glm::dvec3 point(const glm::dvec3& p) const;
  /// Maps a surface normal, by the inverse transpose; unit length. The side it points to stays the same side, also
  /// in a mirror image.
  glm::dvec3 normal(const glm::dvec3& n) const;
  /// Maps a gradient such as Plane::texture_u: dot(p - point, gradient) is the same before and after.
  glm::dvec3 gradient(const glm::dvec3& g) const { return inverse_transpose_ * g; }
  /// True for a mirror image, which turns counter-clockwise corners clockwise.
  bool mirrors() const { return mirrors_; }
  /// The factor of all lengths; throws Error, naming `what`, where it depends on the direction.
  double uniform_scale(const char* what) const;

 private:
  glm::dmat3 linear_{1.0};
  glm::dmat3 inverse_transpose_{1.0};
  glm::dvec3 translation_{0.0};
  bool mirrors_ = false;
  SourceLocation where_;
  std::string name_;
};

}  // namespace vitrum
