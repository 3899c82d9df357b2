#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "film/display.hpp"
#include "film/false_colour.hpp"

using namespace vitrum;

namespace {

/// CIE luminance of a colour in the screen's values (IEC 61966-2-1).
double luminance(const glm::vec3& screen) {
  return 0.2126 * srgb_decode(screen.x) + 0.7152 * srgb_decode(screen.y) + 0.0722 * srgb_decode(screen.z);
}

/// A pixel in the screen's values.
glm::vec3 screen_pixel(const Picture& picture, int x, int y) {
  const glm::vec3 linear = picture.pixels[size_t(y) * size_t(picture.width) + size_t(x)];
  return {srgb_encode(linear.x), srgb_encode(linear.y), srgb_encode(linear.z)};
}

float distance(const glm::vec3& a, const glm::vec3& b) { return glm::length(a - b); }

/// A piece of the picture as text, a character for every second pixel of every second row: '#' where it is light.
std::string as_text(const Picture& picture, int left, int top, int columns, int rows) {
  std::string text;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      text += luminance(screen_pixel(picture, left + 2 * column, top + 2 * row)) > 0.5 ? '#' : '.';
    }
    text += '\n';
  }
  return text;
}

}  // namespace

TEST_CASE("false colours go from black to white and get lighter all the way") {
  CHECK(false_colour(0.0) == glm::vec3(0));
  CHECK(distance(false_colour(1.0), glm::vec3(1)) < 1e-6f);
  CHECK(false_colour(-1.0) == false_colour(0.0));
  CHECK(false_colour(7.0) == false_colour(1.0));
  double before = -1.0;
  for (int i = 0; i <= 255; ++i) {
    CAPTURE(i);
    const double now = luminance(false_colour(i / 255.0));
    CHECK(now > before);
    before = now;
  }
}

TEST_CASE("the lightness of false colours is what they stand for") {
  // By the weights that the scheme is made for (Green 2011, section 2), where no channel is cut off at 0 or 1.
  for (const double t : {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8}) {
    CAPTURE(t);
    const glm::vec3 colour = false_colour(t);
    for (int c = 0; c < 3; ++c) CHECK((colour[c] > 0.0f && colour[c] < 1.0f));
    CHECK(std::abs(0.30 * colour.x + 0.59 * colour.y + 0.11 * colour.z - t) < 1e-4);
  }
}

TEST_CASE("a false-colour picture shows each pixel in its place") {
  const float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> values{0, 1, 2, 4, 8, nan, infinity, 0};
  const Picture picture = false_colour_picture(values, 4, 2, 4.0);
  CHECK(picture.pixels.size() == size_t(picture.width) * size_t(picture.height));
  for (int i = 0; i < 5; ++i) {
    CAPTURE(i);
    CHECK(distance(screen_pixel(picture, i % 4, i / 4), false_colour(values[size_t(i)] / 4.0)) < 1e-5f);
  }
  CHECK(distance(screen_pixel(picture, 0, 1), glm::vec3(1)) < 1e-5f);  // above the scale
  CHECK(distance(screen_pixel(picture, 1, 1), glm::vec3(1, 0, 1)) < 1e-5f);
  CHECK(distance(screen_pixel(picture, 2, 1), glm::vec3(1, 0, 1)) < 1e-5f);
  CHECK(screen_pixel(picture, 3, 1) == glm::vec3(0));
}

TEST_CASE("the bar runs over the scale, and its numbers stand beside it") {
  // Dots of 2 pixels, 120 rows: the bar is 8 pixels from the picture and from both ends, 16 wide, its ticks are 4 long.
  const std::vector<float> values(20, 0.0f);
  const Picture picture = false_colour_picture(values, 5, 4, 0.52);
  CHECK(picture.height == 120);
  for (const int x : {13, 28}) {
    for (int y = 8; y < 112; ++y) {
      CHECK(distance(screen_pixel(picture, x, y), false_colour(1.0 - (y - 8) / 103.0)) < 1e-5f);
    }
  }
  const int label = 13 + 16 + 8;
  CHECK(as_text(picture, label, 8 - 5, 16, 5) ==
        "###.....###.###.\n"
        "#.#.....#.....#.\n"
        "#.#.....###.###.\n"
        "#.#.......#.#...\n"
        "###..#..###.###.\n");
  CHECK(as_text(picture, label, 111 - 5, 4, 5) == "###.\n#.#.\n#.#.\n#.#.\n###.\n");
  // Ticks at 0, .2, .4 and the end: .4 is (1 - .4 / .52) * 103 = 24 rows below it.
  CHECK(as_text(picture, label, 8 + 24 - 5, 12, 5) ==
        "###.....#.#.\n"
        "#.#.....#.#.\n"
        "#.#.....###.\n"
        "#.#.......#.\n"
        "###..#....#.\n");
  int ticks = 0;
  for (int y = 0; y < 120; ++y) ticks += luminance(screen_pixel(picture, 13 + 16 + 1, y)) > 0.5;
  CHECK(ticks == 4);
}

TEST_CASE("every number of a scale can be drawn") {
  for (const double scale : {1e-45, 1.2345e-37, 3.45e-9, 6.78e-5, 0.9, 1.0, 9.99, 1234.0, 8.76e20, 3.4e38}) {
    CAPTURE(scale);
    const Picture picture = false_colour_picture(std::vector<float>(6, 0.0f), 3, 2, scale);
    const auto is_light = [&](int x, int y) { return luminance(screen_pixel(picture, x, y)) > 0.5; };
    int light = 0;
    for (int y = 0; y < picture.height; ++y) {
      for (int x = 3 + 8 + 16 + 8; x < picture.width; ++x) light += is_light(x, y);
      // The room of the longest label: none runs out of the picture.
      CHECK_FALSE(is_light(picture.width - 1, y));
    }
    CHECK(light > 100);
  }
}

TEST_CASE("letters grow with the picture, which keeps its height") {
  const Picture picture = false_colour_picture(std::vector<float>(800 * 3, 0.0f), 3, 800, 1.0);
  CHECK(picture.height == 800);
  CHECK(picture.width > 3 + 4 * 40);
}

TEST_CASE("the usual scale leaves out the brightest of a hundred, what is 0 and what is not finite") {
  const float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  CHECK(false_colour_scale({}) == 1.0);
  CHECK(false_colour_scale(std::vector<float>{0, 0, nan, infinity}) == 1.0);
  CHECK(false_colour_scale(std::vector<float>{0, 0, 0.0123f}) == doctest::Approx(0.013));
  CHECK(false_colour_scale(std::vector<float>{30, 20}) == doctest::Approx(30));
  std::vector<float> values;
  for (int i = 1; i <= 1000; ++i) values.push_back(float(i > 990 ? 1000 * i : i));
  CHECK(false_colour_scale(values) == doctest::Approx(990));
  values.push_back(5e6f);  // 10 of 1001 may be above
  CHECK(false_colour_scale(values) == doctest::Approx(1e6).epsilon(0.01));
}
