#include "film/metrics.hpp"

#include <cmath>
#include <limits>

namespace vitrum {
namespace {

std::string size_text(const Picture& picture) {
  return std::to_string(picture.width) + " x " + std::to_string(picture.height);
}

}  // namespace

PictureError picture_error(const Picture& picture, const Picture& truth, double epsilon) {
  if (picture.width != truth.width || picture.height != truth.height) {
    throw Error({}, "pictures of " + size_text(picture) + " and " + size_text(truth) + " pixels cannot be compared",
                "give two pictures of the same size");
  }
  PictureError error;
  for (size_t i = 0; i < picture.pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double value = picture.pixels[i][c], expected = truth.pixels[i][c];
      if (value == expected) continue;
      double difference = value - expected;
      double relative_square = difference * difference / (expected * expected + epsilon);
      if (!std::isfinite(difference)) {
        ++error.not_finite;
        difference = relative_square = std::numeric_limits<double>::infinity();
      }
      error.bias += difference;
      error.mse += difference * difference;
      error.relative_mse += relative_square;
      if (std::abs(difference) > error.maximum) {
        error.maximum = std::abs(difference);
        error.maximum_x = int(i % size_t(picture.width));
        error.maximum_y = int(i / size_t(picture.width));
      }
    }
  }
  const double count = 3.0 * double(picture.pixels.size());
  if (count > 0) {
    error.bias /= count;
    error.mse /= count;
    error.relative_mse /= count;
  }
  if (error.not_finite > 0) error.bias = std::numeric_limits<double>::quiet_NaN();
  error.rmse = std::sqrt(error.mse);
  return error;
}

}  // namespace vitrum
