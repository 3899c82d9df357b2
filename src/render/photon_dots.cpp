#include "render/photon_dots.hpp"

#include <cmath>

namespace vitrum {

std::vector<float> photon_dots(std::span<const cl_float8> photons, const kernel::CameraData& camera) {
  const auto vector = [](const float* v) { return glm::vec3(v[0], v[1], v[2]); };
  std::vector<float> dots(size_t{camera.width} * camera.height, 0.0f);
  for (const cl_float8& photon : photons) {
    const glm::vec3 d = vector(photon.s) - vector(camera.eye);
    const float z = glm::dot(d, vector(camera.forward));
    if (!(z > 0.0f)) continue;
    const float x = glm::dot(d, vector(camera.right)) / z, y = glm::dot(d, vector(camera.up)) / z;
    const float column = std::floor((x - camera.left) / camera.step_x);
    const float row = std::floor((camera.top - y) / camera.step_y);
    if (column < 0 || row < 0 || column >= static_cast<float>(camera.width) || row >= static_cast<float>(camera.height))
      continue;
    dots[static_cast<size_t>(row) * camera.width + static_cast<size_t>(column)] = 1.0f;
  }
  return dots;
}

}  // namespace vitrum
