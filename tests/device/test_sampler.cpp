// kernels/sampler.h by itself, and where samples fall in a pixel.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "device/kernels.hpp"
#include "render/render.hpp"
#include "verify/scenes.hpp"

using namespace vitrum;

TEST_CASE("sine and cosine of a turn are within 2 ulp of 1") {
  Device device;
  const std::string kernel_text = R"(
__kernel void turn(__global float* sines, __global float* cosines) {
  const uint i = get_global_id(0);
  Float s, c;
  sin_cos_turn(LOAD(sines, i * WIDTH), &s, &c);
  STORE(sines, i * WIDTH, s);
  STORE(cosines, i * WIDTH, c);
}
)";
  const std::string source = kernel_source({}, {"sampler.h"}) + kernel_text;
  cl::Kernel kernel(device.build("sampler_test.cl", source, "-cl-std=CL1.2"), "turn");
  constexpr uint32_t count = 1u << 20;
  std::vector<float> turns(count);
  for (uint32_t i = 0; i < count; ++i) turns[i] = static_cast<float>(i) / count;
  const Buffer<float> sines = device.upload(turns, "test"), cosines = device.allocate<float>(count, "test");
  set_arguments(kernel, 0, sines, cosines);
  device.launch("test", kernel, count / device.width());
  const std::vector<float> s = device.read(sines, 0, count), c = device.read(cosines, 0, count);
  double worst = 0;
  for (uint32_t i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(turns[i]);
    worst = std::max({worst, std::abs(static_cast<double>(s[i]) - std::sin(angle)),
                      std::abs(static_cast<double>(c[i]) - std::cos(angle))});
  }
  MESSAGE("off by " << worst / 0x1p-24 << " units of 2^-24");
  CHECK(worst <= 2 * 0x1p-23);
}

TEST_CASE("samples fill a pixel in both directions together") {
  // The one pixel sees four texels, a quarter of it each.
  Scene scene;
  scene.camera = {CameraType::pinhole, {0, 1, 0}, {0, 0, 0}, {0, 0, -1}, 90.0};
  scene.film.width = scene.film.height = 1;
  scene.render.samples = 64;
  Texture texture;
  texture.filter = TextureFilter::nearest;
  texture.offset = {0.5, 0.5};
  texture.width = texture.height = 2;
  texture.texels = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
  scene.textures.push_back(texture);
  Material material = surface(Surface::unlit);
  material.diffuse_texture = 0;
  scene.materials.push_back(material);
  add(scene, Plane{{0, 0, 0}, {0, 1, 0}, {0.5, 0, 0}, {0, 0, -0.5}}, 0);
  Device device;
  const std::vector<double> radiance = render(scene, device, {}).film.mean("radiance");
  // Low-discrepancy points: a few of 64 at most are in another quarter.
  for (const double share : radiance) CHECK(std::abs(share - 0.25) <= 3.0 / 64);
}

TEST_CASE("each replicate shifts the samples of a pixel anew") {
  // The one pixel sees a ramp from 0 to 1, so its radiance tells where a sample fell.
  Scene scene;
  scene.camera = {CameraType::pinhole, {0, 1, 0}, {0, 0, 0}, {0, 0, -1}, 90.0};
  scene.film.width = scene.film.height = 1;
  scene.render.samples = scene.render.passes = 2;
  Texture texture;
  texture.offset = {0.5, 0.5};
  texture.width = 2;
  texture.height = 1;
  texture.texels = {glm::vec3(0), glm::vec3(1)};
  scene.textures.push_back(texture);
  Material material = surface(Surface::unlit);
  material.diffuse_texture = 0;
  scene.materials.push_back(material);
  add(scene, Plane{{0, 0, 0}, {0, 1, 0}, {0.25, 0, 0}, {0, 0, 0.25}}, 0);
  Device device;
  // With a shift in common, the second sample would always be the sequence's step away from the first.
  double low = 1, high = 0;
  for (uint64_t seed = 0; seed < 8; ++seed) {
    scene.render.seed = seed;
    const Film film = render(scene, device, {}).film;
    REQUIRE(film.replicates() == 2);
    const double step = film.plane("radiance", 1)->sums[0] - film.plane("radiance", 0)->sums[0];
    low = std::min(low, step - std::floor(step));
    high = std::max(high, step - std::floor(step));
  }
  CHECK(high - low > 0.2);
}
