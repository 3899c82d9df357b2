// The reference renderer against closed forms of glass: furnaces, slabs, nested media, and what is cut.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "reference/fresnel.hpp"
#include "reference/renderer.hpp"
#include "reference_scenes.hpp"

using namespace vitrum;

namespace {

/// Power shares of an unpolarised slab: Stokes' sums over all inner reflections.
struct Slab {
  double R, T;
};
Slab slab(double n, double tau, double cos_i) {
  const double R = reference::fresnel(1, n, cos_i).R;
  return {R + (1 - R) * (1 - R) * R * tau * tau / (1 - R * R * tau * tau),
          (1 - R) * (1 - R) * tau / (1 - R * R * tau * tau)};
}

}  // namespace

TEST_CASE("white furnace: a ball of glass in a uniform surround") {
  for (const double sigma_a : {0.0, 0.7}) {
    for (const double offset : {0.0, 0.3, 0.9, 0.999}) {
      CAPTURE(sigma_a);
      CAPTURE(offset);
      Scene scene = looking({offset, 0, 5}, {offset, 0, 0}, {0, 1, 0});
      scene.background = {1, 2, 4};
      scene.materials = {glass(1.5, sigma_a)};
      add(scene, Sphere{{0, 0, 0}, 1}, 0);
      const double cos_i = std::sqrt(1 - offset * offset), cos_t = std::sqrt(1 - offset * offset / 2.25);
      const double R = reference::fresnel(1, 1.5, cos_i).R, tau = std::exp(-2 * sigma_a * cos_t);
      const double expected = R + (1 - R) * (1 - R) * tau / (1 - R * tau);
      const auto sample = seen(scene);
      CHECK(sample.radiance.r + sample.energy_cut == doctest::Approx(expected).epsilon(1e-12));
      CHECK(sample.radiance.b == doctest::Approx(4 * sample.radiance.r).epsilon(1e-14));
    }
  }
}

TEST_CASE("white furnace: what is cut by depth and by weight is what is missing") {
  Scene scene = looking({0.9, 0, 5}, {0.9, 0, 0}, {0, 1, 0});
  scene.background = Spectrum(1);
  scene.materials = {glass(1.5)};
  add(scene, Sphere{{0, 0, 0}, 1}, 0);
  scene.render.min_weight = 1e-2;
  const auto by_weight = seen(scene);
  CHECK(by_weight.energy_cut > 1e-5);
  CHECK(by_weight.energy_cut < 1e-2);
  CHECK(by_weight.radiance.g + by_weight.energy_cut == doctest::Approx(1).epsilon(1e-14));

  scene.render.min_weight = 0;
  const double R = reference::fresnel(1, 1.5, std::sqrt(1 - 0.81)).R;
  double left = 1;                          // before the first surface
  for (int depth = 1; depth < 5; ++depth) {
    scene.render.max_depth = depth;
    const auto by_depth = seen(scene);
    CHECK(by_depth.radiance.g + by_depth.energy_cut == doctest::Approx(1).epsilon(1e-14));
    // A path that has met `depth` surfaces goes no further: both branches at the last of them are cut.
    CHECK(by_depth.energy_cut == doctest::Approx(left).epsilon(1e-14));
    left *= depth == 1 ? 1 - R : R;
  }
}

TEST_CASE("slab: a mesh box reflects and transmits what Stokes' sums say") {
  for (const double sigma_a : {0.0, 0.4}) {
    for (const double degrees : {0.0, 30.0, 80.0}) {
      CAPTURE(sigma_a);
      CAPTURE(degrees);
      // 1 m thick, seen from above; what is transmitted meets a light plane, what is reflected another.
      const double angle = glm::radians(degrees), cos_i = std::cos(angle);
      Scene scene = looking({-5 * std::tan(angle), 5, 0}, {0, 0, 0});
      scene.materials = {glass(1.5, sigma_a), surface(Surface::unlit, 0, 1), surface(Surface::unlit, 0.25, 0.75)};
      add(scene, box({-4000, -1, -4000}, {4000, 0, 4000}, 0));
      add(scene, Plane{{0, -3, 0}, {0, 1, 0}, {}, {}}, 1);
      const double cos_t = std::sqrt(1 - std::pow(std::sin(angle) / 1.5, 2)), tau = std::exp(-sigma_a / cos_t);
      const Slab expected = slab(1.5, tau, cos_i);
      CHECK(seen(scene).radiance.r == doctest::Approx(expected.T).epsilon(1e-12));
      scene.shapes.pop_back();
      add(scene, Plane{{0, 30, 0}, {0, 1, 0}, {}, {}}, 2);
      CHECK(seen(scene).radiance.r == doctest::Approx(expected.R).epsilon(1e-12));
      if (sigma_a == 0) {
        const double R = reference::fresnel(1, 1.5, cos_i).R;
        CHECK(expected.R == doctest::Approx(2 * R / (1 + R)).epsilon(1e-14));
      }
    }
  }
}

TEST_CASE("slab with a constant reflectance; total reflection all the same") {
  Scene scene = looking({0, 5, 0}, {0, 0, 0});
  scene.render.constant_reflectance = 0.1;
  scene.materials = {glass(1.5), surface(Surface::unlit, 0, 1)};
  add(scene, box({-40, -1, -40}, {40, 0, 40}, 0));
  add(scene, Plane{{0, -3, 0}, {0, 1, 0}, {}, {}}, 1);
  CHECK(seen(scene).radiance.r == doctest::Approx(0.9 / 1.1).epsilon(1e-12));

  // From inside, beyond the critical angle of 41.8 degrees, against a top above which all is bright.
  scene = looking({0, -0.5, 0}, {1, 0, 0});
  scene.render.constant_reflectance = 0.1;
  scene.background = Spectrum(1);
  scene.materials = {glass(1.5), surface(Surface::opaque)};
  add(scene, box({-40, -1, -40}, {40, 0, 40}, 0));
  add(scene, Plane{{0, -1, 0}, {0, 1, 0}, {}, {}}, 1);
  std::swap(scene.shapes[0], scene.shapes[1]);  // of what coincides the first is met
  CHECK(seen(scene).radiance.r == 0);
  scene.camera.look_at = {0.1, 0, 0};
  CHECK(seen(scene).radiance.r == doctest::Approx(0.9 * 2.25).epsilon(1e-12));
}

TEST_CASE("radiance scales with the square of the index where the eye is in the medium") {
  // Snell's window from 0.3 m below the surface of a box of water that holds the eye.
  Scene scene = looking({0.1, -0.3, 0.2}, {0.1, 0, 0.2});
  scene.background = Spectrum(1);
  scene.materials = {glass(1.333, 0.5)};
  add(scene, box({-4, -1, -4}, {4, 0, 4}, 0));
  scene.render.max_depth = 1;               // the way up alone is cut there
  CHECK(seen(scene).radiance.r == 0);
  CHECK(seen(scene).energy_cut == doctest::Approx(std::exp(-0.15)).epsilon(1e-14));
  scene.render.max_depth = 200;
  const double R = std::pow(0.333 / 2.333, 2), tau = std::exp(-0.5), half_way = std::exp(-0.15);
  // Up at once, or after going down and up again any number of times; and what leaves through the bottom.
  const double up = half_way * (1 - R) / (1 - R * R * tau * tau), down = R * tau * up;
  CHECK(seen(scene).radiance.r == doctest::Approx(1.333 * 1.333 * (up + down)).epsilon(1e-12));
}

TEST_CASE("media that overlap by priority, and media that touch, have one interface") {
  // Dark glass 1 m on clear water 1 m on a light plane, straight from above.
  const double tau = std::exp(-0.5), R_glass = 0.04;
  const double R_contact = std::pow((1.5 - 1.333) / (1.5 + 1.333), 2), R_water = std::pow(0.333 / 2.333, 2);
  // Below the glass two faces with nothing dark between: R / (1 - R) adds up (Stokes 1862). Then Stokes' sum with tau.
  const double both = R_contact / (1 - R_contact) + R_water / (1 - R_water), R_below = both / (1 + both);
  const double T = (1 - R_glass) * tau * (1 - R_below) / (1 - R_glass * R_below * tau * tau);

  for (const float overlap : {0.0f, 0.25f}) {
    for (const bool water_first : {false, true}) {
      CAPTURE(overlap);
      CAPTURE(water_first);
      Scene scene = looking({0.1, 5, 0.2}, {0.1, 0, 0.2});
      scene.render.min_weight = 1e-12;
      scene.materials = {glass(1.5, 0.5, 1), glass(1.333, 0, 0), surface(Surface::unlit, 0, 1)};
      add(scene, box({-4, 0, -4}, {4, 1, 4}, 0));
      add(scene, box({-4, -1, -4}, {4, overlap, 4}, 1));
      if (water_first) std::swap(scene.shapes[0], scene.shapes[1]);
      add(scene, Plane{{0, -3, 0}, {0, 1, 0}, {}, {}}, 2);
      CHECK(seen(scene).radiance.r == doctest::Approx(T).epsilon(1e-10));
    }
  }
}

TEST_CASE("glass that stands on an opaque surface shows it, whichever comes first") {
  for (const bool glass_first : {false, true}) {
    CAPTURE(glass_first);
    Scene scene = looking({0.1, 5, 0.2}, {0.1, 0, 0.2});
    scene.materials = {glass(1.5, 0.5), surface(Surface::unlit, 0, 1)};
    add(scene, box({-4, 0, -4}, {4, 1, 4}, 0));
    add(scene, Plane{{0, 0, 0}, {0, 1, 0}, {}, {}}, 1);
    if (!glass_first) std::swap(scene.shapes[0], scene.shapes[1]);
    // Glass first: a slab over the table. Table first: it shines into the glass, whose radiance is n^2 that of air.
    const double tau = std::exp(-0.5);
    CHECK(seen(scene).radiance.r ==
          doctest::Approx(glass_first ? slab(1.5, tau, 1).T : 0.96 * tau / 2.25).epsilon(1e-12));
  }
}

TEST_CASE("a sheet of glass that was never entered is left all the same") {
  // From below at 60 degrees: beyond the critical angle, so the sheet mirrors the light plane below.
  Scene scene = looking({0, -1, 0}, {std::sqrt(3.0), 0, 0});
  scene.materials = {glass(1.5), surface(Surface::unlit, 0, 1)};
  add(scene, Triangle{{-9, 0, -9}, {0, 0, 9}, {9, 0, -9}, {}, {}, {}}, 0);
  add(scene, Plane{{0, -3, 0}, {0, 1, 0}, {}, {}}, 1);
  CHECK(seen(scene).radiance.r == doctest::Approx(1).epsilon(1e-12));
}

TEST_CASE("two bodies of the same glass that touch are one") {
  Scene scene = looking({0, 5, 0}, {0, 0, 0});  // straight along the diagonals' crossing
  scene.materials = {glass(1.5, 0.3), surface(Surface::unlit, 0, 1)};
  add(scene, box({-4, 0, -4}, {4, 1, 4}, 0));
  add(scene, box({-4, -1, -4}, {4, 0, 4}, 0));
  add(scene, Plane{{0, -3, 0}, {0, 1, 0}, {}, {}}, 1);
  CHECK(seen(scene).radiance.r == doctest::Approx(slab(1.5, std::exp(-0.6), 1).T).epsilon(1e-12));
}

TEST_CASE("opaque glass lets nothing through and gives no NaN") {
  Scene scene = looking({0, 0, 5}, {0, 0, 0}, {0, 1, 0});
  scene.background = Spectrum(1);
  scene.materials = {glass(1.5)};
  scene.materials[0].absorption = {std::numeric_limits<double>::infinity(), 0, 1};
  add(scene, Sphere{{0, 0, 0}, 1}, 0);
  const Spectrum radiance = seen(scene).radiance;
  CHECK(radiance.r == doctest::Approx(0.04).epsilon(1e-12));
  CHECK(radiance.g == doctest::Approx(1).epsilon(1e-12));
  CHECK(radiance.b < 0.2);
}

TEST_CASE("mirrors face to face: every reflection meets one more surface") {
  Scene scene = looking({0, 0.5, 0}, {0, 0, 0});
  scene.materials = {surface(Surface::mirror), surface(Surface::mirror)};
  scene.materials[1].emission = Spectrum(1);
  add(scene, Plane{{0, 0, 0}, {0, 1, 0}, {}, {}}, 0);
  add(scene, Plane{{0, 1, 0}, {0, 1, 0}, {}, {}}, 1);
  scene.render.max_depth = 9;
  CHECK(seen(scene).radiance.r == doctest::Approx(4));
  CHECK(seen(scene).energy_cut == 1);
}
