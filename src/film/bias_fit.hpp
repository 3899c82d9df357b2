#pragma once
// The bias of pictures whose estimates take in a wider or narrower area, told by how far such pictures are apart.

#include <span>
#include <vector>

namespace vitrum {

/// What two pictures tell: how far apart they are, where the area of the first's estimates was `area_a` and of the second's
/// `area_b`, each over that of some first picture.
struct BiasStep {
  double area_a = 1.0, area_b = 1.0;
  double square = 0.0;          ///< mean squared difference less that of noise: may be negative
  double deviation = 0.0;       ///< of `square`, by noise; > 0
};

/// Squared bias of a picture with parts of several areas: its mean where it is known with a normal deviation and is not
/// negative, so that what is hidden in noise counts; and the range it lies in.
struct SquaredBias {
  double value = 0.0, low = 0.0, high = 0.0;
  double exponent = 0.0;        ///< of the bias with the area
};

/// The bias goes as area^c: c = 1 where the irradiance is smooth, down to .25 at edges, where only the border of an area's
/// width is off. c and the bias at area 1 are fitted to `steps` (at least one), where c is .65 within .2 before anything is
/// known. `areas` and `weights` (> 0): of the parts whose mean the picture is. Low and high: at two standard deviations.
SquaredBias fit_bias(std::span<const BiasStep> steps, std::span<const double> areas, std::span<const double> weights);

}  // namespace vitrum
