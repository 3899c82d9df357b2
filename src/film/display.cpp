#include "film/display.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace vitrum {
namespace {

constexpr glm::vec3 loud_colour{1, 0, 1};

bool has_nan(const glm::vec3& colour) { return std::isnan(colour.x) || std::isnan(colour.y) || std::isnan(colour.z); }

/// Of a value that is no NaN.
float display_value(float radiance, const DisplaySettings& settings) {
  const double exposed = std::clamp(double(radiance) * std::exp2(settings.exposure), 0.0, 1.0);
  return float(settings.srgb ? srgb_encode(exposed) : std::pow(exposed, 1.0 / settings.gamma));
}

/// Calls `change` for each pixel of three interleaved values.
template <typename Change>
void for_each_colour(std::span<float> values, Change change) {
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) {
    const glm::vec3 colour = change(glm::vec3(values[i], values[i + 1], values[i + 2]));
    for (int c = 0; c < 3; ++c) values[i + std::size_t(c)] = colour[c];
  }
}

}  // namespace

double srgb_encode(double linear) {
  const double size = std::abs(linear);
  return std::copysign(size <= 0.0031308 ? 12.92 * size : 1.055 * std::pow(size, 1.0 / 2.4) - 0.055, linear);
}

double srgb_decode(double encoded) {
  const double size = std::abs(encoded);
  return std::copysign(size <= 0.04045 ? size / 12.92 : std::pow((size + 0.055) / 1.055, 2.4), encoded);
}

glm::vec3 display_colour(const glm::vec3& radiance, const DisplaySettings& settings) {
  if (has_nan(radiance)) return loud_colour;
  return {display_value(radiance.x, settings), display_value(radiance.y, settings),
          display_value(radiance.z, settings)};
}

float display_grey(float radiance, const DisplaySettings& settings) {
  return std::isnan(radiance) ? 1.0f : display_value(radiance, settings);
}

void display_in_place(std::span<float> values, int channels, const DisplaySettings& settings) {
  assert(channels == 1 || channels == 3);
  if (channels == 3) {
    for_each_colour(values, [&](const glm::vec3& colour) { return display_colour(colour, settings); });
  } else {
    for (float& value : values) value = display_grey(value, settings);
  }
}

void show_data_in_place(std::span<float> values, int channels) {
  assert(channels == 1 || channels == 3);
  if (channels == 3) {
    for_each_colour(values, [](const glm::vec3& vector) {
      return has_nan(vector) ? loud_colour : glm::clamp(0.5f * vector + 0.5f, 0.0f, 1.0f);
    });
    return;
  }
  float largest = 0.0f;
  for (const float value : values) {
    if (std::isfinite(value)) largest = std::max(largest, value);
  }
  for (float& value : values) {
    if (!std::isfinite(value)) {
      value = 1.0f;
    } else {
      value = largest > 0.0f ? std::max(value, 0.0f) / largest : 0.0f;
    }
  }
}

}  // namespace vitrum
