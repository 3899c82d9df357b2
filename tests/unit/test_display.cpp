#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "film/display.hpp"

using namespace vitrum;

namespace {
constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();
}  // namespace

TEST_CASE("the sRGB curve has the values of its standard and is undone by its inverse") {
  CHECK(srgb_encode(0.0) == 0.0);
  CHECK(srgb_encode(1.0) == doctest::Approx(1.0).epsilon(1e-15));
  CHECK(srgb_encode(0.001) == doctest::Approx(0.01292).epsilon(1e-14));
  // Middle grey: 18 % reflectance is 117.7 of 255; 50 % of the code is 21.4 % of the light.
  CHECK(255 * srgb_encode(0.18) == doctest::Approx(117.6457).epsilon(1e-6));
  CHECK(srgb_decode(0.5) == doctest::Approx(0.21404114).epsilon(1e-8));
  // The two pieces of the curve meet (the standard rounds its constants, so nearly).
  CHECK(srgb_encode(0.0031308) == doctest::Approx(srgb_encode(std::nextafter(0.0031308, 1.0))).epsilon(1e-6));
  double before = -1;
  for (int i = 0; i <= 1000; ++i) {
    const double value = i / 1000.0;
    CHECK(srgb_decode(srgb_encode(value)) == doctest::Approx(value).epsilon(1e-6));
    CHECK(srgb_encode(value) > before);
    before = srgb_encode(value);
  }
  CHECK(srgb_encode(-0.18) == -srgb_encode(0.18));
}

TEST_CASE("gamma and exposure") {
  DisplaySettings gamma;
  gamma.srgb = false;
  gamma.gamma = 1.8;
  CHECK(display_grey(0.25f, gamma) == doctest::Approx(std::pow(0.25, 1 / 1.8)));
  gamma.exposure = 1;
  CHECK(display_grey(0.25f, gamma) == doctest::Approx(std::pow(0.5, 1 / 1.8)));
  gamma.exposure = -2;
  CHECK(display_grey(1.0f, gamma) == doctest::Approx(std::pow(0.25, 1 / 1.8)));

  const glm::vec3 colour = display_colour({0.0f, 0.18f, 1.0f}, {});
  CHECK(colour.x == 0.0f);
  CHECK(colour.y == doctest::Approx(srgb_encode(0.18)));
  CHECK(colour.z == 1.0f);
}

TEST_CASE("what a screen cannot show is clamped, and a NaN is loud") {
  CHECK(display_colour({-1.0f, 7.0f, infinity}, {}) == glm::vec3(0, 1, 1));
  CHECK(display_colour({-infinity, 0.0f, 0.0f}, {}) == glm::vec3(0, 0, 0));
  for (int c = 0; c < 3; ++c) {
    glm::vec3 colour(0.2f);
    colour[c] = nan_value;
    CHECK(display_colour(colour, {}) == glm::vec3(1, 0, 1));
  }
  CHECK(display_grey(nan_value, {}) == 1.0f);

  std::vector<float> row{0.0f, 0.0f, 0.0f, 0.5f, nan_value, 0.5f};
  display_in_place(row, 3, {});
  CHECK(row == std::vector<float>{0, 0, 0, 1, 0, 1});
  display_in_place(row, 1, {});
  CHECK(row == std::vector<float>{0, 0, 0, 1, 0, 1});
}

TEST_CASE("data that is no colour is made visible") {
  std::vector<float> normals{0, 1, -1, nan_value, 0, 0};
  show_data_in_place(normals, 3);
  CHECK(normals == std::vector<float>{0.5f, 1, 0, 1, 0, 1});

  std::vector<float> depths{0, 2, 4, infinity, nan_value, -1};
  show_data_in_place(depths, 1);
  CHECK(depths == std::vector<float>{0, 0.5f, 1, 1, 1, 0});

  std::vector<float> nothing{infinity, 0};
  show_data_in_place(nothing, 1);
  CHECK(nothing == std::vector<float>{1, 0});
}
