#include <doctest/doctest.h>

#include <cmath>

#include "film/display.hpp"
#include "film/images.hpp"

using namespace vitrum;

TEST_CASE("the lawn's picture has the reflectance of a lawn and no seam") {
  const Picture grass = read_picture(VITRUM_SOURCE_DIR "/models/default_scene/grass.png", {"test"});
  REQUIRE(grass.width == 600);
  REQUIRE(grass.height == 600);
  glm::dvec3 mean(0.0);
  for (const glm::vec3& texel : grass.pixels) {
    mean += glm::dvec3(srgb_decode(texel.x), srgb_decode(texel.y), srgb_decode(texel.z));
  }
  mean /= double(grass.pixels.size());
  CHECK(std::abs(mean.x / 0.15 - 1) < 0.005);
  CHECK(std::abs(mean.y / 0.35 - 1) < 0.005);
  CHECK(std::abs(mean.z / 0.06 - 1) < 0.005);

  // Neighbours across the border differ as neighbours inside do.
  const auto green = [&](int x, int y) { return grass.pixels[size_t(y % 600 * 600 + x % 600)].y; };
  double across_columns = 0, across_rows = 0, inside = 0;
  for (int i = 0; i < 600; ++i) {
    across_columns += std::abs(green(599, i) - green(600, i));
    across_rows += std::abs(green(i, 599) - green(i, 600));
    for (int j = 0; j < 599; ++j) inside += std::abs(green(j, i) - green(j + 1, i)) / 599;
  }
  CHECK(across_columns < 1.15 * inside);
  CHECK(across_rows < 1.15 * inside);
}
