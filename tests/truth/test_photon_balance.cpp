// The photons' power: what is shot, and what becomes of it.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "film/statistics.hpp"
#include "verify/photon_run.hpp"
#include "verify/scenes.hpp"

using namespace vitrum;

// Photons that wait for a packet of their own must not overrun their queue: it lost their power once, with 16 lanes first
// of all in this very scene.
TEST_CASE("the balance of power holds where photons often change between inside and outside") {
  Scene scene = ball_over_plane(2.4, Spectrum(0.0), INFINITY);
  scene.render.seed = 7;
  Device device;
  PhotonRun run(scene, device);
  run.shoot(0, 500'000);
  const PhotonBalance& b = run.balance();
  // The same floats are added up in another order: by Kahan's bound each sum is within two roundings of the whole.
  for (int c = 0; c < 3; ++c) {
    const double ends = b.stored[c] + b.direct[c] + b.lost[c] + b.cut[c];
    CHECK(std::abs(ends / (b.shot[c] + b.split[c]) - 1) < 0x1p-23);
  }
  CHECK(b.photons_shot + b.photons_branched == b.photons_stored + b.photons_direct + b.photons_lost + b.photons_cut);
}

namespace {

/// A lamp of 1 W/sr at the origin, in the dark.
Scene lamp() {
  Scene scene;
  scene.camera = {CameraType::pinhole, {0, 3, 8}, {0, 0, 0}, {0, 1, 0}, 45.0};
  scene.materials = {glass(1.0), surface(Surface::opaque, 0.5), surface(Surface::mirror)};
  scene.lights.push_back({"lamp", {}, PointLight{{0, 0, 0}, Spectrum(1.0)}});
  scene.photons.estimate = PhotonEstimate::fixed_radius;
  scene.photons.radius = 0.05;
  return scene;
}
constexpr uint32_t air = 0, matt = 1, mirror = 2;     // materials of lamp()

void add_floor(Scene& scene, double y) { add(scene, Plane{{0, y, 0}, {0, 1, 0}, {}, {}}, matt); }

/// Solid angle of the cone from the origin around a ball whose centre is at distance d [sr].
double solid_angle(double radius, double d) { return 2 * std::numbers::pi * (1 - std::sqrt(1 - radius * radius / (d * d))); }

/// The power shot, by 16 replicates, must be that in the union of the cones, which counts nothing twice.
void check_power_shot(const Scene& scene, double truth) {
  constexpr uint32_t replicates = 16;
  Device device;
  PhotonRun run(scene, device);
  double sum = 0, squares = 0, before = 0;
  for (uint32_t replicate = 0; replicate < replicates; ++replicate) {
    run.shoot(replicate, 20'000);
    const double power = run.balance().shot.y - std::exchange(before, run.balance().shot.y);
    sum += power;
    squares += power * power;
  }
  const double mean = sum / replicates;
  const double error = std::sqrt(std::max(squares / replicates - mean * mean, 0.0) / (replicates - 1));
  MESSAGE("power " << mean << " +- " << error << ", truth " << truth);
  CHECK(error < 1e-3 * truth);
  // Powers are floats.
  CHECK(std::abs(mean - truth) <= student_limit(sidak_level(1e-4, 3), replicates - 1) * error + 1e-6 * truth);
}

}  // namespace

TEST_CASE("where casters share a direction, the light's power is shared too") {
  Scene scene = lamp();
  add(scene, Sphere{{0, -2, 0}, 0.8}, air);
  SUBCASE("one behind the other") {
    add(scene, Sphere{{0, -4, 0}, 1.0}, air);
    check_power_shot(scene, solid_angle(0.8, 2));
  }
  SUBCASE("side by side, apart") {
    add(scene, Sphere{{4, 0, 0}, 1.0}, air);
    check_power_shot(scene, solid_angle(0.8, 2) + solid_angle(1.0, 4));
  }
  SUBCASE("the lamp in one of them, which lies the other way") {
    add(scene, Sphere{{0, 0.3, 0}, 0.5}, air);
    check_power_shot(scene, 4 * std::numbers::pi);
  }
}

TEST_CASE("photons of a lamp that is far away fill their narrow cone evenly") {
  Scene scene = lamp();
  add(scene, Sphere{{0, -1000, 0}, 1.0}, air);
  add_floor(scene, -1002);
  Device device;
  constexpr uint64_t count = 20'000;
  const std::vector<cl_float8> photons = PhotonRun(scene, device).shoot(0, count);
  CHECK(photons.size() == count);
  for (const double part : {0.1, 0.3, 0.7}) {
    const auto within = std::count_if(photons.begin(), photons.end(), [&](const cl_float8& p) {
      return std::hypot(p.s[0], p.s[2]) < part * 1.002;  // the ball's shadow on the plane
    });
    // Low-discrepancy points: 20 of 20,000 at most are on the wrong side of a circle.
    CHECK(std::abs(static_cast<double>(within) / count - part * part) < 1e-3);
  }
}

TEST_CASE("photons that miss what they are aimed at are direct light, which the map does not hold") {
  Scene scene = lamp();
  // Its bound is larger than the triangle, which throws the light back to where nothing is.
  add(scene, Triangle{{-0.2, -1, -0.1}, {0, -1, 0.2}, {0.2, -1, -0.1}, {}, {}, {}}, mirror);
  add_floor(scene, -2);
  Device device;
  PhotonRun run(scene, device);
  CHECK(run.shoot(0, 20'000).empty());
  CHECK(run.balance().photons_direct > 2'000);
  CHECK(run.balance().photons_lost > 2'000);
}

TEST_CASE("photons meet max_depth surfaces and no more") {
  // Into the air, out of it, and the floor: that is three.
  Scene scene = lamp();
  add(scene, Sphere{{0, -2, 0}, 0.8}, air);
  add_floor(scene, -4);
  Device device;
  constexpr uint64_t count = 10'000;
  for (const int max_depth : {1, 2, 3, 4}) {
    CAPTURE(max_depth);
    scene.photons.max_depth = max_depth;
    PhotonRun run(scene, device);
    CHECK(run.shoot(0, count).size() == (max_depth < 3 ? 0 : count));
    CHECK(run.balance().photons_cut == (max_depth < 3 ? count : 0));
    CHECK(run.balance().surfaces_met == static_cast<uint64_t>(std::min(max_depth, 3)) * count);
  }
}

// What branches off inside a mesh must know on which side of its facet it is: else its media are "mended", and it finds
// itself twice in the glass that it leaves.
TEST_CASE("light that is thrown back and forth in a slab comes out of it, where media may be stacked") {
  Scene scene = lamp();
  scene.lights = {{"sun", {}, DirectionalLight{{0, -1, 0}, Spectrum(1.0)}}};
  scene.materials[air] = glass(2.4);
  add_floor(scene, -2);
  add(scene, box({-0.5f, -0.2f, -0.5f}, {0.5f, 0.2f, 0.5f}, air));
  // Too small to matter.
  add(scene, Sphere{{2, 0, 0}, 1e-3}, air);
  Device device;
  constexpr uint64_t count = 200'000;
  PhotonRun run(scene, device);
  run.run(0, 0, 0, count);
  const double R = std::pow(1.4 / 3.4, 2), through = (1 - R) / (1 + R);
  MESSAGE("through the slab " << run.balance().stored.x << ", truth " << through);
  CHECK(std::abs(run.balance().stored.x / through - 1) < 0.005);
}
