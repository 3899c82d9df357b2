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
  CHECK(error.maximum_channel == 2);
  CHECK(error.relative_rmse == doctest::Approx(std::sqrt(5.0 / 16.01 / 18)));
  CHECK(error.differing_pixels == 2);
  CHECK(error.channel_means[0] == 4);
  CHECK(error.channel_means[1] == doctest::Approx(4 - 1.0 / 6));
  CHECK(error.channel_means[2] == doctest::Approx(4 + 2.0 / 6));
  CHECK(error.truth_channel_means == std::vector<double>{4, 4, 4});
  CHECK(error.mean == doctest::Approx(4 + 1.0 / 18));
  CHECK(error.truth_mean == 4);
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

TEST_CASE("a layer of one channel, and what is infinite in both pictures") {
  const float infinity = std::numeric_limits<float>::infinity();
  const std::vector<float> values{1, 5, infinity, 2, 2, 2}, truth{1, 2, infinity, 2, 2, 2};
  const PictureError error = values_error(values, truth, 2, 3, 1);
  CHECK(error.mse == doctest::Approx(9.0 / 6));
  CHECK(error.maximum == 3);
  CHECK(error.maximum_x == 1);
  CHECK(error.maximum_y == 0);
  CHECK(error.maximum_channel == 0);
  CHECK(error.not_finite == 0);
  CHECK(error.differing_pixels == 1);
  CHECK(error.mean == doctest::Approx(12.0 / 5));
  CHECK(error.truth_mean == doctest::Approx(9.0 / 5));
  CHECK(pixels_not_finite(values, 1) == 1);
  CHECK(pixels_not_finite(values, 2) == 1);
  CHECK(pixels_not_finite(truth, 3) == 1);
  CHECK(pixel_differences(values, truth, 1) == std::vector<float>{0, 3, 0, 0, 0, 0});
  CHECK(pixel_differences(values, truth, 3) == std::vector<float>{3, 0});
}

TEST_CASE("means are those of values that are finite in both pictures") {
  const float infinity = std::numeric_limits<float>::infinity();
  const PictureError error = values_error(std::vector<float>{1, 3, infinity}, std::vector<float>{5, infinity, 2}, 3, 1, 1);
  CHECK(error.mean == 1);
  CHECK(error.truth_mean == 5);
  CHECK(error.not_finite == 2);
}

TEST_CASE("pixels differ by their bits") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> values{0.0f, nan, 1.0f, -0.0f}, truth{-0.0f, nan, 1.0f, 0.0f};
  const PictureError error = values_error(values, truth, 4, 1, 1);
  CHECK(error.differing_pixels == 2);  // 0 and -0, but not NaN and the same NaN
  CHECK(error.not_finite == 1);
  CHECK(std::isinf(pixel_differences(std::vector<float>{nan}, std::vector<float>{nan}, 1)[0]));
}

TEST_CASE("pictures of different sizes are not compared") {
  CHECK_THROWS_WITH_AS(picture_error(grey(2, 3, 0), grey(3, 2, 0)),
                       "pictures of 2 x 3 and 3 x 2 pixels cannot be compared; give two pictures of the same size", Error);
}
