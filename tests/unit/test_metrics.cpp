#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "film/metrics.hpp"

using namespace vitrum;

namespace {
Picture grey(int width, int height, float value) {
  return {width, height, std::vector<glm::vec3>(size_t(width) * size_t(height), glm::vec3(value))};
}
}  // namespace

TEST_CASE("a picture does not differ from itself") {
  Picture picture = grey(3, 2, 0.5f);
  picture.pixels[4].x = std::numeric_limits<float>::infinity();  // a depth of the sky
  const PictureError error = picture_error(picture, picture);
  CHECK(error.bias == 0);
  CHECK(error.mse == 0);
  CHECK(error.rmse == 0);
  CHECK(error.relative_mse == 0);
  CHECK(error.maximum == 0);
  CHECK(error.maximum_x == 0);
  CHECK(error.maximum_y == 0);
  CHECK(error.not_finite == 0);
}

TEST_CASE("the errors of known differences") {
  // 3 x 2 pixels of 3 channels: 18 values, one 2 too large, one 1 too small.
  const Picture truth = grey(3, 2, 4.0f);
  Picture picture = truth;
  picture.pixels[1].y -= 1.0f;
  picture.pixels[5].z += 2.0f;
  const PictureError error = picture_error(picture, truth);
  CHECK(error.bias == doctest::Approx(1.0 / 18));
  CHECK(error.mse == doctest::Approx(5.0 / 18));
  CHECK(error.rmse == doctest::Approx(std::sqrt(5.0 / 18)));
  CHECK(error.relative_mse == doctest::Approx(5.0 / 16.01 / 18));
  CHECK(error.maximum == 2);
  CHECK(error.maximum_x == 2);
  CHECK(error.maximum_y == 1);
  CHECK(picture_error(picture, truth, 9.0).relative_mse == doctest::Approx(5.0 / 25 / 18));
}

TEST_CASE("of equal differences the first pixel is named") {
  const Picture truth = grey(4, 4, 1.0f);
  Picture picture = truth;
  picture.pixels[6].x = picture.pixels[9].x = 0.0f;
  const PictureError error = picture_error(picture, truth);
  CHECK(error.maximum_x == 2);
  CHECK(error.maximum_y == 1);
}

TEST_CASE("a NaN or an infinity cannot hide") {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Picture picture = grey(2, 2, 1.0f);
    picture.pixels[3].y = bad;
    for (const bool swapped : {false, true}) {
      const PictureError error =
          swapped ? picture_error(grey(2, 2, 1.0f), picture) : picture_error(picture, grey(2, 2, 1.0f));
      CHECK(error.not_finite == 1);
      CHECK(std::isinf(error.mse));
      CHECK(std::isinf(error.rmse));
      CHECK(std::isinf(error.relative_mse));
      CHECK(std::isinf(error.maximum));
      CHECK(std::isnan(error.bias));
      CHECK(error.maximum_x == 1);
      CHECK(error.maximum_y == 1);
    }
  }
}

TEST_CASE("pictures of different sizes are not compared") {
  CHECK_THROWS_WITH_AS(picture_error(grey(2, 3, 0), grey(3, 2, 0)),
                       "pictures of 2 x 3 and 3 x 2 pixels cannot be compared; give two pictures of the same size", Error);
}
