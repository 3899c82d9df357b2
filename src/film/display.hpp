#pragma once
// The display transform: how linear values become what a screen is given. Pure functions.

#include <glm/glm.hpp>
#include <span>

namespace vitrum {

/// How linear radiance becomes the values of a PNG: value = transform(radiance * 2^exposure), clamped to 0..1.
struct DisplaySettings {
  bool srgb = true;                         ///< false: power 1 / gamma
  double gamma = 1.8;                       ///< > 0
  double exposure = 0.0;                    ///< stops
};

/// The sRGB curve, linear to encoded, both in 0..1 (IEC 61966-2-1). Continues past 1; negative values are mirrored.
double srgb_encode(double linear);

/// Inverse of srgb_encode.
double srgb_decode(double encoded);

/// One colour for the screen, in 0..1. A colour with a NaN is shown as magenta, so that it cannot be missed;
/// infinity is white, what is below 0 is 0.
glm::vec3 display_colour(const glm::vec3& radiance, const DisplaySettings& settings);

/// One grey value for the screen, in 0..1; NaN is white.
float display_grey(float radiance, const DisplaySettings& settings);

/// Applies display_colour (3 channels) or display_grey (1 channel) to interleaved values, in place.
void display_in_place(std::span<float> values, int channels, const DisplaySettings& settings);

/// Makes data that is no colour visible, in place. 3 channels are vectors: -1..1 becomes 0..1 (NaN: magenta).
/// 1 channel is a distance: 0 becomes black and the largest finite value white, as does what is not finite.
void show_data_in_place(std::span<float> values, int channels);

}  // namespace vitrum
