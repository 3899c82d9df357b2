#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <thread>

#include "film/images.hpp"
#include "temporary_folder.hpp"

using namespace vitrum;
namespace fs = std::filesystem;

namespace {

constexpr int width = 5, height = 3;
const SourceLocation here{"test.mtl", 7};

/// Colours from 0 to 1, every channel and pixel of its own.
PictureLayer ramp(const std::string& name, int channels = 3) {
  PictureLayer layer{name, channels, {}, true};
  const int count = width * height * channels;
  for (int i = 0; i < count; ++i) layer.values.push_back(float(i) / float(count - 1));
  return layer;
}

glm::vec3 colour(const PictureLayer& layer, int i) {
  if (layer.channels == 1) return glm::vec3(layer.values[size_t(i)]);
  return {layer.values[size_t(3 * i)], layer.values[size_t(3 * i + 1)], layer.values[size_t(3 * i + 2)]};
}

DisplaySettings identity() {
  DisplaySettings display;
  display.srgb = false;
  display.gamma = 1.0;
  return display;
}

/// Largest difference of a channel.
float distance(const glm::vec3& a, const glm::vec3& b) {
  const glm::vec3 d = glm::abs(a - b);
  return std::max(d.x, std::max(d.y, d.z));
}

}  // namespace

TEST_CASE("EXR keeps every float, the range and the sign") {
  const TemporaryFolder folder;
  PictureLayer beauty = ramp("beauty");
  beauty.values[0] = 1e30f;
  beauty.values[1] = -2.5f;
  beauty.values[2] = 1e-30f;
  beauty.values[3] = std::numeric_limits<float>::infinity();
  write_picture(folder / "x.exr", width, height, {beauty}, {}, {});
  const Picture picture = read_picture(folder / "x.exr", here);
  REQUIRE(picture.width == width);
  REQUIRE(picture.height == height);
  for (int i = 0; i < width * height; ++i) CHECK(picture.pixels[size_t(i)] == colour(beauty, i));
}

TEST_CASE("integer formats round to the nearest of 256 values, after the display transform") {
  const TemporaryFolder folder;
  const PictureLayer beauty = ramp("beauty");
  for (const std::string name : {"x.png", "x.tif", "x.tiff", "x.bmp", "X.PNG"}) {
    CAPTURE(name);
    write_picture(folder / name, width, height, {beauty}, identity(), {});
    const Picture plain = read_picture(folder / name, here);
    write_picture(folder / name, width, height, {beauty}, {}, {});
    const Picture shown = read_picture(folder / name, here);
    REQUIRE(plain.width == width);
    REQUIRE(plain.height == height);
    for (int i = 0; i < width * height; ++i) {
      const glm::vec3 linear = colour(beauty, i);
      const glm::vec3 srgb(srgb_encode(linear.x), srgb_encode(linear.y), srgb_encode(linear.z));
      CHECK(distance(plain.pixels[size_t(i)], linear) <= 0.5f / 255 + 1e-6f);
      CHECK(distance(shown.pixels[size_t(i)], srgb) <= 0.5f / 255 + 1e-6f);
    }
  }
}

TEST_CASE("JPEG comes near, HDR comes within its shared exponent") {
  const TemporaryFolder folder;
  PictureLayer smooth{"beauty", 3, {}, true};
  for (int i = 0; i < 64 * 64; ++i) smooth.values.insert(smooth.values.end(), {float(i % 64) / 63.0f, 0.5f, 0.25f});
  for (const std::string name : {"x.jpg", "x.jpeg"}) {
    write_picture(folder / name, 64, 64, {smooth}, identity(), {});
    const Picture picture = read_picture(folder / name, here);
    for (int i = 0; i < 64 * 64; ++i) CHECK(distance(picture.pixels[size_t(i)], colour(smooth, i)) < 6.0f / 255);
  }
  for (float& value : smooth.values) value *= 100.0f;  // linear: neither clamped nor curved
  write_picture(folder / "x.hdr", 64, 64, {smooth}, {}, {});
  const Picture picture = read_picture(folder / "x.hdr", here);
  for (int i = 0; i < 64 * 64; ++i) {
    const glm::vec3 expected = colour(smooth, i);
    const float largest = std::max(expected.x, std::max(expected.y, expected.z));
    CHECK(distance(picture.pixels[size_t(i)], expected) <= largest / 128);
  }
}

TEST_CASE("planes of one channel are grey in every format") {
  const TemporaryFolder folder;
  PictureLayer depth = ramp("depth", 1);
  depth.is_colour = false;
  for (const std::string name : {"x.exr", "x.hdr", "x.png", "x.tif", "x.bmp"}) {
    CAPTURE(name);
    write_picture(folder / name, width, height, {depth}, {}, {});
    const Picture picture = read_picture(folder / name, here);
    for (int i = 0; i < width * height; ++i) {
      CHECK(distance(picture.pixels[size_t(i)], colour(depth, i)) <= 1.0f / 128);
    }
  }
}

TEST_CASE("layers have names that viewers know, and the beauty is what a plain reader sees") {
  const TemporaryFolder folder;
  const PictureLayer beauty = ramp("beauty");
  PictureLayer albedo = ramp("albedo"), normal = ramp("normal"), depth = ramp("depth", 1);
  for (float& value : albedo.values) value = 0.25f;
  normal.is_colour = depth.is_colour = false;
  write_picture(folder / "x.exr", width, height, {albedo, normal, beauty, depth}, {}, {});
  const Picture picture = read_picture(folder / "x.exr", here);
  for (int i = 0; i < width * height; ++i) CHECK(picture.pixels[size_t(i)] == colour(beauty, i));
  // The header lists its channels by name, each closed by a zero.
  const std::string bytes = file_bytes(folder / "x.exr");
  for (const std::string name : {"R", "G", "B", "albedo.R", "albedo.G", "albedo.B", "normal.X", "normal.Y", "normal.Z",
                           "depth.Z"}) {
    CAPTURE(name);
    CHECK(bytes.find(std::string(1, '\0') + name + '\0') != std::string::npos);
  }
  // Another format takes the first layer.
  write_picture(folder / "x.png", width, height, {albedo, beauty}, identity(), {});
  CHECK(distance(read_picture(folder / "x.png", here).pixels[3], glm::vec3(0.25f)) <= 0.5f / 255);
}

TEST_CASE("layers are read as they were written, to the bit") {
  const TemporaryFolder folder;
  PictureLayer beauty = ramp("beauty"), albedo = ramp("albedo"), normal = ramp("normal"), depth = ramp("depth", 1);
  for (float& value : albedo.values) value = 1e-30f - value;
  normal.values[4] = std::numeric_limits<float>::infinity();
  normal.is_colour = depth.is_colour = false;
  write_picture(folder / "x.exr", width, height, {albedo, normal, beauty, depth}, {}, {});
  const LayeredPicture picture = read_layers(folder / "x.exr", here);
  CHECK(picture.width == width);
  CHECK(picture.height == height);
  CHECK(picture.is_float);
  REQUIRE(picture.layers.size() == 4);
  for (const PictureLayer& written : {beauty, albedo, normal, depth}) {
    CAPTURE(written.name);
    const auto read = std::find_if(picture.layers.begin(), picture.layers.end(),
                                   [&](const PictureLayer& layer) { return layer.name == written.name; });
    REQUIRE(read != picture.layers.end());
    CHECK(read->channels == written.channels);
    CHECK(read->is_colour == written.is_colour);
    CHECK(read->values == written.values);
  }
}

TEST_CASE("a picture of many rows is read in several pieces, each in its place") {
  const TemporaryFolder folder;
  constexpr int rows = 600;
  PictureLayer beauty{"beauty", 3, {}, true}, depth{"depth", 1, {}, false};
  for (int i = 0; i < 2 * rows; ++i) {
    beauty.values.insert(beauty.values.end(), {float(i), float(-i), 0.5f});
    depth.values.push_back(float(10 * i));
  }
  write_picture(folder / "x.exr", 2, rows, {beauty, depth}, {}, {});
  const Picture plain = read_picture(folder / "x.exr", here);
  REQUIRE(plain.pixels.size() == size_t(2 * rows));
  for (int i = 0; i < 2 * rows; ++i) CHECK(plain.pixels[size_t(i)] == colour(beauty, i));
  const LayeredPicture layered = read_layers(folder / "x.exr", here);
  REQUIRE(layered.layers.size() == 2);
  for (const PictureLayer& layer : layered.layers)
    CHECK(layer.values == (layer.name == "beauty" ? beauty.values : depth.values));
}

TEST_CASE("pictures without layers have one, the beauty") {
  const TemporaryFolder folder;
  for (const int channels : {1, 3}) {
    for (const std::string name : {"x.png", "x.jpg", "x.tif", "x.bmp", "x.hdr", "x.exr"}) {
      CAPTURE(name);
      write_picture(folder / name, width, height, {ramp("", channels)}, identity(), {});
      const LayeredPicture layered = read_layers(folder / name, here);
      const Picture plain = read_picture(folder / name, here);
      CHECK(layered.width == width);
      CHECK(layered.height == height);
      CHECK(layered.is_float == (name == "x.hdr" || name == "x.exr"));
      REQUIRE(layered.layers.size() == 1);
      const PictureLayer& layer = layered.layers.front();
      CHECK(layer.name == "beauty");
      CHECK(layer.is_colour);
      REQUIRE(layer.channels == 3);
      for (int i = 0; i < width * height; ++i) CHECK(colour(layer, i) == plain.pixels[size_t(i)]);
    }
  }
}

TEST_CASE("the header holds the metadata and the version") {
  const TemporaryFolder folder;
  for (const std::string name : {"x.exr", "x.png", "x.jpg", "x.tif"}) {
    CAPTURE(name);
    write_picture(folder / name, width, height, {ramp("")}, {}, {{"seed", "4711"}, {"device", "pocl-cpu"}});
    const std::string bytes = file_bytes(folder / name);
    CHECK(bytes.find("seed") != std::string::npos);
    CHECK(bytes.find("4711") != std::string::npos);
    CHECK(bytes.find("pocl-cpu") != std::string::npos);
    CHECK(bytes.find("vitrum 0.") != std::string::npos);
  }
}

TEST_CASE("the same picture gives the same bytes, whatever the time") {
  const TemporaryFolder folder;
  const std::vector<std::string> names{"x.exr", "x.png", "x.jpg", "x.tif", "x.bmp", "x.hdr"};
  std::vector<std::string> before;
  for (const std::string& name : names) {
    write_picture(folder / name, width, height, {ramp("")}, {}, {{"seed", "1"}});
    before.push_back(file_bytes(folder / name));
    CHECK(!before.back().empty());
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(1010));  // formats write the time in seconds
  for (size_t i = 0; i < names.size(); ++i) {
    CAPTURE(names[i]);
    write_picture(folder / names[i], width, height, {ramp("")}, {}, {{"seed", "1"}});
    CHECK(file_bytes(folder / names[i]) == before[i]);
  }
  CHECK(folder.entries() == int(names.size()));
}

TEST_CASE("a picture is read by what it is, not by its name") {
  const TemporaryFolder folder;
  write_picture(folder / "x.png", width, height, {ramp("")}, identity(), {});
  fs::rename(folder / "x.png", folder / "x.jpg");
  CHECK(read_picture(folder / "x.jpg", here).width == width);
}
