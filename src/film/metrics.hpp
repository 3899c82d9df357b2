#pragma once
// How far one picture is from another. Pure functions, in double.

#include <cstdint>

#include "film/images.hpp"

namespace vitrum {

/// The difference of a picture from the truth, over all pixels and channels, each value v against its truth t.
/// Where v and t are equal, infinities included, the difference is 0; where they differ and one of them is NaN or
/// infinite, it is infinite, and so are all the errors below.
struct PictureError {
  double bias = 0.0;           ///< mean of v - t (NaN if there are values that are not finite)
  double mse = 0.0;            ///< mean of (v - t)^2
  double rmse = 0.0;           ///< square root of mse
  double relative_mse = 0.0;   ///< mean of (v - t)^2 / (t^2 + epsilon)
  double maximum = 0.0;        ///< largest |v - t| of any channel
  int maximum_x = 0, maximum_y = 0;  ///< the first pixel that has it, from the top left
  uint64_t not_finite = 0;     ///< values that differ while one of the two is NaN or infinite
};

/// Compares two pictures of the same size. `epsilon`, in units of t^2, keeps black pixels from deciding the relative
/// error; .01 as in Rousselle, Knaus and Zwicker, "Adaptive sampling and reconstruction using greedy error
/// minimization" (2011), section 4. Throws Error if the sizes differ.
PictureError picture_error(const Picture& picture, const Picture& truth, double epsilon = 0.01);

}  // namespace vitrum
