// What becomes of a texture's pixels.

#include "scene/textures.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "film/images.hpp"
#include "scratch.hpp"

using namespace vitrum;

namespace {

/// A picture of one row with these values in all channels.
void write_row(const std::string& path, const std::vector<float>& values) {
  write_picture(path, static_cast<int>(values.size()), 1, {{"", 1, values, true}}, {}, {});
}

Texture texture_of(const std::string& path, ColourSpace colour_space = ColourSpace::linear) {
  Texture texture;
  texture.path = path;
  texture.where = {"lawn.mtl", 12, 3};
  texture.colour_space = colour_space;
  return texture;
}

}  // namespace

TEST_CASE("every texture gets its texels: of its own picture, in its own colour space") {
  const ScratchFolder folder;
  Scene scene;
  const std::string a = folder.path("a.exr"), b = folder.path("b.exr");
  scene.textures = {texture_of(a), texture_of(b), texture_of(a), texture_of(a, ColourSpace::srgb)};
  write_row(a, {0.0f, 0.5f, 1.0f});
  write_row(b, {0.25f, 0.75f});
  scene.textures[2].clamp = true;
  load_textures(scene);
  CHECK(scene.textures[0].texels == std::vector{glm::vec3(0.0f), glm::vec3(0.5f), glm::vec3(1.0f)});
  CHECK(scene.textures[1].texels == std::vector{glm::vec3(0.25f), glm::vec3(0.75f)});
  CHECK(scene.textures[2].texels == scene.textures[0].texels);
  // (.5 + .055)/1.055 to the power 2.4.
  CHECK(scene.textures[3].texels[1].g == doctest::Approx(0.2140411).epsilon(1e-6));
  for (const Texture& texture : scene.textures) {
    CHECK(texture.width == static_cast<int>(texture.texels.size()));
    CHECK(texture.height == 1);
  }
}

TEST_CASE("a texture's values are reflectances") {
  const ScratchFolder folder;
  Scene scene;
  scene.textures = {texture_of(folder.path("a.exr"))};
  write_row(folder.path("a.exr"), {0.5f, 1.5f});
  CapturedWarnings warnings;
  load_textures(scene);
  CHECK(warnings.text().find("lawn.mtl:12:3: the texture '" + folder.path("a.exr") + "' holds reflectances above 1") !=
        std::string::npos);
  for (const float value : {-0.5f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    CAPTURE(value);
    write_row(folder.path("a.exr"), {0.5f, value});
    CHECK_THROWS_WITH_AS(load_textures(scene), doctest::Contains("lawn.mtl:12:3: the texture"), Error);
  }
}
