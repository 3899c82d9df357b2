// models/caustic_plate: photons and picture against the quadrature of the ball's caustic over all orders of paths.

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "verify/photon_run.hpp"
#include "reference/ball_caustic.hpp"
#include "render/render.hpp"
#include "scene/scene_file.hpp"

namespace vitrum {
namespace {

using std::numbers::pi;

constexpr std::array<double, 4> radii = {0.05, 0.10, 0.15, 0.20};       // [m]
constexpr std::array<double, 3> sigma_a = {0.0, 2.0 / 3.0, 1.0};        // [1/m], one in each channel
const char* const three_glasses = "material.glass.Kd=[1, 0.6, 0.5]";   // sigma_a = 1/Kd - 1
constexpr double light_power = 4 * pi * pi;                             // of pi W/sr [W]

Scene plate(std::vector<std::string> overrides) {
  return load_scene(VITRUM_SOURCE_DIR "/models/caustic_plate/scene.toml", overrides);
}

/// Power within each radius of the axis in each channel, by the photons' places [W]; and the sum of its squares.
struct Encircled {
  std::array<std::array<double, 3>, 4> power{}, squares{};

  explicit Encircled(const std::vector<cl_float8>& photons) {
    for (const cl_float8& p : photons) {
      const double r = std::hypot(double{p.s[0]}, double{p.s[2]});
      for (size_t k = 0; k < radii.size(); ++k) {
        if (r >= radii[k]) continue;
        for (size_t c = 0; c < 3; ++c) {
          const double w = p.s[4 + c];
          power[k][c] += w;
          squares[k][c] += w * w;
        }
      }
    }
  }
};

double true_power(size_t radius, size_t channel) {
  return light_power * reference::encircled_flux(reference::default_scene_ball(sigma_a[channel]), radii[radius],
                                                 reference::Orders::all);
}

}  // namespace

TEST_CASE("caustic_plate: ten million photons encircle the flux of all orders within a thousandth") {
  Device device;
  constexpr uint64_t count = 10'000'000;
  // With and without absorption the kernels differ.
  for (const std::string kd : {"material.glass.Kd=[1, 1, 1]", three_glasses}) {
    const bool absorbs = kd == three_glasses;
    const Scene scene = plate({kd});
    PhotonRun run(scene, device);
    const std::vector<cl_float8> photons = run.shoot(0, count);
    const Encircled encircled(photons);
    for (size_t k = 0; k < radii.size(); ++k)
      for (size_t c = 0; c < (absorbs ? 3 : 1); ++c) {
        CAPTURE(radii[k]);
        CAPTURE(sigma_a[c]);
        const double ratio = encircled.power[k][c] / true_power(k, c);
        MESSAGE("sigma_a " << sigma_a[c] << ", r < " << radii[k] << ": off by " << 1e6 * (ratio - 1) << " millionths");
        CHECK(std::abs(ratio - 1) < 1e-3);
      }

    const PhotonBalance& b = run.balance();
    CHECK(b.photons_shot == count);
    CHECK(b.photons_stored == photons.size());
    for (int c = 0; c < 3; ++c) {
      CAPTURE(c);
      // Each term is counted by itself.
      const double ends = b.stored[c] + b.absorbed[c] + b.direct[c] + b.lost[c] + b.cut[c];
      CHECK(std::abs(ends / (b.shot[c] + b.split[c]) - 1) < 1e-6);
      CHECK(std::abs(b.split[c]) < 1e-4 * b.shot[c]);
      double stored = 0;
      for (const cl_float8& p : photons) stored += p.s[4 + c];
      CHECK(std::abs(b.stored[c] / stored - 1) < 1e-6);
      // Photons fill the cone around the ball: (1 - cos(asin .6)) / 2 of all directions.
      CHECK(std::abs(b.shot[c] / light_power - 0.1) < 1e-6);
      CHECK(std::abs((b.shot[c] + b.not_aimed[c]) / light_power - 1) < 1e-6);
      CHECK(b.direct[c] == 0);
      CHECK(b.cut[c] < 1e-4 * b.shot[c]);
      const size_t channel = static_cast<size_t>(c);
      const auto ball = reference::default_scene_ball(absorbs ? sigma_a[channel] : 0.0);
      const double absorbed = reference::absorbed_flux(ball);
      if (ball.sigma_a == 0)
        CHECK(b.absorbed[c] == 0);
      else
        CHECK(std::abs(b.absorbed[c] / (light_power * absorbed) - 1) < 1e-4);
      // What neither the plane nor the glass takes goes to the sky.
      const double landed =
          reference::encircled_flux(ball, std::numeric_limits<double>::infinity(), reference::Orders::all);
      CHECK(std::abs(b.stored[c] / (light_power * landed) - 1) < 1e-4);
      CHECK(std::abs((b.lost[c] + b.cut[c]) / light_power - (0.1 - landed - absorbed)) < 1e-5);
    }
  }
}

TEST_CASE("caustic_plate: independent photons deviate from the encircled flux as chance has it") {
  Device device;
  constexpr uint64_t count = 250'000;
  constexpr uint32_t seeds = 12;
  const Scene scene = plate({three_glasses, "photons.sampling='independent'"});
  PhotonRun run(scene, device);
  // Two-sided, at 1 in 1000 for all tests together: Sidak 1967.
  constexpr double tests = seeds * radii.size() * sigma_a.size();
  const double level = 1 - std::pow(1 - 1e-3, 1 / tests);
  std::array<std::array<double, 3>, 4> sum{};
  double sum_of_squares = 0;
  for (uint32_t replicate = 0; replicate < seeds; ++replicate) {
    const Encircled encircled(run.shoot(replicate, count));
    for (size_t k = 0; k < radii.size(); ++k)
      for (size_t c = 0; c < sigma_a.size(); ++c) {
        const double truth = true_power(k, c);
        // Shots that end elsewhere count as zeros.
        const double variance = encircled.squares[k][c] - truth * truth / count;
        const double z = (encircled.power[k][c] - truth) / std::sqrt(variance);
        CAPTURE(z);
        CHECK(std::erfc(std::abs(z) / std::numbers::sqrt2) > level);
        sum[k][c] += z / std::sqrt(double{seeds});
        sum_of_squares += z * z / tests;
      }
  }
  for (size_t k = 0; k < radii.size(); ++k)
    for (size_t c = 0; c < sigma_a.size(); ++c) {
      MESSAGE("sigma_a " << sigma_a[c] << ", r < " << radii[k] << ": z " << sum[k][c]);
      CHECK(std::erfc(std::abs(sum[k][c]) / std::numbers::sqrt2) > 1 - std::pow(1 - 1e-3, 1.0 / 12));
    }
  // Photons that were not independent would scatter less, or more. Radii and channels share photons: loose bounds.
  MESSAGE("mean of z^2: " << sum_of_squares);
  CHECK(sum_of_squares > 0.4);
  CHECK(sum_of_squares < 2.0);
}

// What remains of the error is where irradiance diverges. With an automatic radius of .34 mm on pixels of 3.1 mm the
// relative RMSE is .147, .041 and .017 with 16, 64 and 256 samples a pixel; of the last, .015 stem from the fold at
// r = .138, .005 from the axis, .0055 from all other pixels. With 16 samples it is their sparseness at the fold that
// shows: a radius of 1 mm has .100, and one of 2 mm, with .154, blurs the fold more than it helps.
TEST_CASE("caustic_plate: ten million photons give the picture of irradiance within 3 %") {
  Device device;
  const Scene scene = plate({three_glasses, "render.samples=256"});
  RenderOptions options;
  options.views = {View::caustics};
  const RenderResult result = render(scene, device, options);
  const std::vector<double> radiance = result.film.mean("caustics");
  const int size = 128;
  REQUIRE(radiance.size() == size_t{size * size * 3});
  MESSAGE("radius of the estimate: " << 1e3 * result.photon_radius << " mm");
  const std::vector<bool> mask = reference::disc_mask(0.2, size, size, 0.2);
  for (size_t c = 0; c < 3; ++c) {
    CAPTURE(sigma_a[c]);
    std::vector<double> irradiance;
    for (size_t i = c; i < radiance.size(); i += 3) irradiance.push_back(radiance[i] * pi / 0.01);
    const std::vector<double> truth = reference::irradiance_picture(reference::default_scene_ball(sigma_a[c]),
                                                                    light_power, 0.2, size, size);
    const double error = reference::relative_rmse(irradiance, truth, mask);
    MESSAGE("sigma_a " << sigma_a[c] << ": relative RMSE " << error);
    CHECK(error < 0.03);
    // Noise aside, no light is gained or lost: a scale wrong by 1 % would hide in the error of single pixels.
    double seen = 0, all = 0;
    for (size_t i = 0; i < truth.size(); ++i) {
      seen += mask[i] ? irradiance[i] : 0.0;
      all += mask[i] ? truth[i] : 0.0;
    }
    MESSAGE("flux of the picture: off by " << seen / all - 1);
    CHECK(std::abs(seen / all - 1) < 2e-3);
  }
}

}  // namespace vitrum
