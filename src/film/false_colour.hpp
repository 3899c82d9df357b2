#pragma once
// Numbers as colours: a picture that shows the size of a quantity at each pixel, beside a bar that tells which colour
// means how much. Pure functions.

#include <glm/glm.hpp>
#include <span>

#include "film/images.hpp"

namespace vitrum {

/// The colour of `t` in 0..1 (clamped), in the screen's sRGB values, 0..1: from black to white, the more the lighter,
/// so that the order can be seen at a glance, also by those who tell colours badly, and in a grey print. Cubehelix with
/// its default parameters: D. A. Green, "A colour scheme for the display of astronomical intensity images", Bulletin of
/// the Astronomical Society of India 39 (2011).
glm::vec3 false_colour(double t);

/// A scale for values >= 0 that 99 of 100 of those above 0 do not exceed, so that a few bright dots do not darken all
/// others: rounded up to two digits, 1 if there are none. Values that are not finite do not count.
double false_colour_scale(std::span<const float> values);

/// Shows `width` x `height` values >= 0 as false_colour(value / scale); `scale` > 0. What is larger is as white as the
/// scale, what is no number or infinite is magenta. The picture lies at the top left of the result, pixel by pixel; to
/// its right stands the bar with its numbers, for which a picture of few rows gets a margin below. Colours are linear,
/// so that write_picture with the sRGB curve gives those of the scheme.
Picture false_colour_picture(std::span<const float> values, int width, int height, double scale);

}  // namespace vitrum
