#include "scene/transform.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/ext/matrix_double3x3.hpp>
#include <glm/gtc/matrix_inverse.hpp>
#include <numbers>

namespace vitrum {
namespace {

/// Rotation about an axis (0 x, 1 y, 2 z), counter-clockwise for who looks against the axis; exact at right angles.
glm::dmat3 rotation(int axis, double degrees) {
  const double rest = std::remainder(degrees, 90.0);
  const int quarter = static_cast<int>(std::lround(std::fmod((degrees - rest) / 90.0, 4.0)));
  double s = std::sin(rest * std::numbers::pi / 180.0), c = std::cos(rest * std::numbers::pi / 180.0);
  for (int turn = 0; turn < ((quarter % 4) + 4) % 4; ++turn) {
    std::swap(s, c);
    c = -c;
  }
  const int a = (axis + 1) % 3, b = (axis + 2) % 3;
  glm::dmat3 matrix(1.0);
  matrix[a][a] = c;
  matrix[a][b] = s;
  matrix[b][a] = -s;
  matrix[b][b] = c;
  return matrix;
}

constexpr double scale_limit = 1e9;

struct Affine {
  glm::dmat3 linear{1.0};
  glm::dvec3 translation{0.0};
};

Affine read_matrix(const TomlTable& shape) {
  std::array<double, 16> m{};
  shape.numbers("transform", m.data(), m.size(), {-length_limit, length_limit});
  if (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1)
    shape.fail("transform", "is no affine map: its last row is not 0, 0, 0, 1",
               "give the rows of the matrix one after the other, the translation at the end of each");
  Affine map;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) map.linear[column][row] = m[static_cast<size_t>(4 * row + column)];
    map.translation[row] = m[static_cast<size_t>(4 * row + 3)];
  }
  return map;
}

Affine read_steps(const TomlTable& steps) {
  steps.check_keys({}, {"translate", "rotate", "scale"});
  glm::dvec3 translate(0.0), rotate(0.0), scale(1.0);
  steps.vector("translate", translate, coordinate);
  steps.vector("rotate", rotate, {-1e6, 1e6});
  const Range factor{-scale_limit, scale_limit};
  if (steps.is_number("scale")) {
    double uniform = 1.0;
    steps.number("scale", uniform, factor);
    scale = glm::dvec3(uniform);
  } else {
    steps.vector("scale", scale, factor);
  }
  if (scale.x == 0 || scale.y == 0 || scale.z == 0)
    steps.fail("scale", "is 0, which leaves nothing of the shape", "give a scale that is not 0");
  glm::dmat3 linear = rotation(2, rotate.z) * rotation(1, rotate.y) * rotation(0, rotate.x);
  for (int axis = 0; axis < 3; ++axis) linear[axis] *= scale[axis];
  return {linear, translate};
}

}  // namespace

Transform::Transform(const TomlTable& shape, double metres_per_unit)
    : where_(shape.where("transform")), name_(shape.path()) {
  Affine map;
  if (shape.is_array("transform"))
    map = read_matrix(shape);
  else if (shape.has("transform"))
    map = read_steps(shape.table("transform"));
  linear_ = map.linear * metres_per_unit;
  translation_ = map.translation * metres_per_unit;

  // A determinant is a product of three lengths: compared with them, it says how flat the image of a cube is.
  const double determinant = glm::determinant(linear_);
  const double lengths = glm::length(linear_[0]) * glm::length(linear_[1]) * glm::length(linear_[2]);
  if (!(std::abs(determinant) > 1e-12 * lengths))
    throw Error(where_, name_ + ".transform flattens the shape: its determinant is 0",
                "give a matrix that has an inverse");
  mirrors_ = determinant < 0;
  inverse_transpose_ = glm::inverseTranspose(linear_);
}

glm::dvec3 Transform::point(const glm::dvec3& p) const {
  const glm::dvec3 image = linear_ * p + translation_;
  for (int axis = 0; axis < 3; ++axis)
    if (!(std::abs(image[axis]) <= length_limit))
      throw Error(where_, name_ + " reaches farther than 1e9 metres from the origin", "scale it down, or check `unit`");
  return image;
}

glm::dvec3 Transform::normal(const glm::dvec3& n) const { return glm::normalize(inverse_transpose_ * n); }

double Transform::uniform_scale(const char* what) const {
  // The map scales all lengths alike when its columns are perpendicular and of one length.
  const glm::dmat3 gram = glm::transpose(linear_) * linear_;
  const double square = (gram[0][0] + gram[1][1] + gram[2][2]) / 3.0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (!(std::abs(gram[i][j] - (i == j ? square : 0.0)) <= 1e-9 * square))
        throw Error(where_, name_ + ".transform does not scale all directions alike, which " + what + " cannot bear",
                    "give one number as scale, or use a mesh");
  return std::sqrt(square);
}

}  // namespace vitrum
