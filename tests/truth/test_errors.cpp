// What a render tells of its own errors: standard error, radiance cut, noise and bias of the photons' estimate.

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "device/opencl.hpp"
#include "film/statistics.hpp"
#include "render/render.hpp"
#include "verify/scenes.hpp"

using namespace vitrum;

namespace {

constexpr double pi = std::numbers::pi;

/// A plane under a lamp, and a ball of glass in between.
Scene ball_over_plane(double index) {
  Scene scene;
  scene.camera = {CameraType::pinhole, {0.9, 0.9, 0}, {0, 0, 0}, {0, 1, 0}, 30};
  scene.film.width = scene.film.height = 16;
  scene.materials = {surface(Surface::opaque, 0.8), glass(index)};
  add(scene, Plane{{0, 0, 0}, {0, 1, 0}, {}, {}}, 0);
  add(scene, Sphere{{0, 0.5, 0}, 0.2}, 1);
  return scene;
}

/// Student's test of `values` that have the mean 0 if all is right.
struct StudentTest {
  double mean = 0, error = 0, p = 0;

  explicit StudentTest(const std::vector<double>& values) {
    const double n = static_cast<double>(values.size());
    double squares = 0;
    for (const double value : values) mean += value / n;
    for (const double value : values) squares += (value - mean) * (value - mean);
    error = std::sqrt(squares / (n * (n - 1)));
    p = student_two_sided(mean / error, n - 1);
  }
};

RenderResult rendered(const Scene& scene, Device& device, std::vector<View> views) {
  RenderOptions options;
  options.views = std::move(views);
  return render(scene, device, options);
}

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

}  // namespace

TEST_CASE("the standard error is that of the scatter over seeds") {
  Device device;
  struct Case {
    const char* name;
    Sampling sampling;
    int samples;
    bool caustics;
  };
  // 20 samples are shared out unevenly, which is exact where the variance goes as 1 / samples, as here.
  const Case cases[] = {{"direct light, independent", Sampling::independent, 20, false},
                        {"caustic, independent", Sampling::independent, 16, true},
                        {"both, low-discrepancy", Sampling::low_discrepancy, 16, true}};
  constexpr size_t seeds = 48;
  for (const Case& c : cases) {
    CAPTURE(std::string(c.name));
    Scene scene = ball_over_plane(1.5);
    scene.lights.push_back({"lamp", {}, DiscLight{{0.3, 1.5, 0}, {0, -1, 0}, 0.3, Spectrum(5.0)}});
    scene.render.sampling = scene.photons.sampling = c.sampling;
    scene.render.samples = c.samples;
    scene.render.caustics = c.caustics;
    scene.render.lights = !c.caustics || c.sampling == Sampling::low_discrepancy;
    scene.photons.count = 40'000;
    scene.photons.estimate = PhotonEstimate::fixed_radius;
    scene.photons.radius = 0.02;
    std::vector<std::vector<double>> pictures, errors;
    for (size_t seed = 0; seed < seeds; ++seed) {
      scene.render.seed = seed + 1;
      const RenderResult result = rendered(scene, device, {View::beauty, View::error});
      REQUIRE(result.film.replicates() == 8);
      pictures.push_back(result.film.mean("radiance"));
      errors.push_back(result.standard_error());
    }
    // For each seed, summed over all values: the variance that it claims beside that which it has.
    std::vector<double> excess(seeds, 0.0);
    double claimed = 0;
    for (size_t i = 0; i < pictures.front().size(); ++i) {
      double mean = 0;
      for (const auto& picture : pictures) mean += picture[i] / seeds;
      for (size_t s = 0; s < seeds; ++s) {
        const double variance = errors[s][i] * errors[s][i], deviation = pictures[s][i] - mean;
        excess[s] += variance - deviation * deviation * seeds / (seeds - 1);
        claimed += variance / seeds;
      }
    }
    for (double& value : excess) value /= claimed;
    const StudentTest test(excess);
    MESSAGE(std::string(c.name) << ": claimed variance off by " << 100 * test.mean << " +- " << 100 * test.error << " %");
    CHECK(test.p > sidak_level(1e-3, std::size(cases)));
    CHECK(test.error < 0.08);  // else the test is blunt
  }
}

TEST_CASE("what the limits cut of a white surround is what is missing") {
  // Every path ends at a radiance of 2; of the ball's light the picture lacks what was cut, times 2.
  Device device;
  Scene scene;
  scene.camera = {CameraType::pinhole, {0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 40};
  scene.film.width = scene.film.height = 32;
  scene.background = Spectrum(2.0);
  scene.materials = {glass(1.5), surface(Surface::mirror)};
  add(scene, Sphere{{0, 0, 0}, 0.5}, 0);
  add(scene, Sphere{{0.5, 0.3, -0.6}, 0.3}, 1);
  scene.render.samples = 2;
  struct Limits {
    int max_depth;
    double min_weight;
  };
  for (const Limits& limits : {Limits{1, 1e-4}, {2, 1e-4}, {3, 1e-4}, {20, 0.01}}) {
    CAPTURE(limits.max_depth);
    scene.render.max_depth = limits.max_depth;
    scene.render.min_weight = limits.min_weight;
    const RenderResult result = rendered(scene, device, {View::beauty});
    CHECK(result.limit.is_bound);
    CHECK(result.limit.radiance == Spectrum(2.0));
    const std::vector<double> radiance = result.film.mean("radiance"), cut = cut_radiance(result.film, result.limit);
    double worst = 0, most = 0;
    for (size_t i = 0; i < radiance.size(); ++i) {
      worst = std::max(worst, std::abs(radiance[i] + cut[i] - 2.0));
      most = std::max(most, cut[i]);
    }
    CHECK(most > 0.01);
    CHECK(worst < 1e-5);  // a few dozen roundings
  }
}

TEST_CASE("the limit of radiance: which scenes have a bound") {
  const Film film(1, 1);
  Scene scene;
  scene.background = {1, 2, 3};
  scene.materials = {glass(1.5), surface(Surface::opaque, 0.5, 0.25)};
  CHECK(radiance_limit(scene, 1.0, film).is_bound);
  CHECK(radiance_limit(scene, 1.0, film).radiance == Spectrum(1, 2, 3));
  // From within the glass, air is seen (1.5 / 1)^2 as bright.
  CHECK(radiance_limit(scene, 1.5, film).radiance.x == doctest::Approx(2.25));
  // An area light, and what a surface adds of its own: .25 + .5 * 4, and with a highlight of .1 (8 + 2) / (8 + 1) more.
  scene.lights.push_back({"disc", {}, DiscLight{{0, 1, 0}, {0, -1, 0}, 1, {4, 4, 0}}});
  CHECK(radiance_limit(scene, 1.0, film).radiance == Spectrum(4, 4, 3));
  scene.materials[1].diffuse = Spectrum(1.0);
  scene.materials[1].specular = Spectrum(0.1);
  scene.materials[1].shininess = 8;
  CHECK(radiance_limit(scene, 1.0, film).radiance.x == doctest::Approx(0.25 + 4 + 4 * 0.1 * 10 / 9));
  CHECK(radiance_limit(scene, 1.0, film).is_bound);
  // Glass that shines by itself may do so at each encounter.
  scene.materials[0].emission = Spectrum(0.1);
  CHECK_FALSE(radiance_limit(scene, 1.0, film).is_bound);
  scene.materials[0].emission = Spectrum(0.0);
  // A point has no radiance. What was seen tells.
  scene.lights.push_back({"point", {}, PointLight{{0, 1, 0}, Spectrum(1.0)}});
  Film seen(1, 1);
  seen.add(0, "radiance", 3, std::vector<float>{9, 0, 0}, 1);
  CHECK_FALSE(radiance_limit(scene, 1.0, seen).is_bound);
  CHECK(radiance_limit(scene, 1.0, seen).radiance.x == 9);
  scene.render.lights = scene.render.caustics = false;
  CHECK(radiance_limit(scene, 1.0, seen).is_bound);
}

TEST_CASE("number and noise of the photons in an estimate") {
  // Parallel light through a ball of air: photons lie evenly. Seen from below the ball, places as far apart as no two
  // estimates share photons.
  Device device;
  Scene scene = ball_over_plane(1.0);
  scene.lights.push_back({"sun", {}, DirectionalLight{{0, -1, 0}, Spectrum(3.0)}});
  scene.camera = {CameraType::pinhole, {0, 0.25, 0}, {0, 0, 0}, {0, 0, 1}, 360 / pi * std::atan(0.12 / 0.25)};
  scene.film.width = scene.film.height = 8;
  scene.photons.sampling = Sampling::independent;
  scene.photons.count = 50'000;
  scene.photons.estimate = PhotonEstimate::fixed_radius;
  scene.photons.radius = 0.01;
  const double truth = 3.0 * 0.8 / pi;
  for (const int passes : {1, 8}) {
    CAPTURE(passes);
    scene.render.passes = scene.render.samples = passes;
    constexpr size_t seeds = 24;
    std::vector<double> off, noise;
    double photons = 0, gathered = 0, pairs = 0;
    for (size_t seed = 0; seed < seeds; ++seed) {
      scene.render.seed = seed + 1;
      const RenderResult result = rendered(scene, device, {View::caustics});
      const double in_radius = 1e-4 / 0.04 * static_cast<double>(result.photons.photons_stored);
      photons += in_radius / seeds;
      gathered += static_cast<double>(result.rays.gathered);
      pairs += static_cast<double>(result.rays.gathered_pairs);
      const std::vector<double> radiance = result.film.mean("caustics");
      for (size_t i = 0; i < radiance.size(); i += 3) {
        off.push_back(radiance[i] / truth - 1);
        noise.push_back(off.back() * off.back() * in_radius - 4.0 / 3.0);
      }
      // Of 64 estimates it is known to 1 / sqrt(125 * 64).
      CHECK(result.photons_in_estimate() == doctest::Approx(in_radius).epsilon(0.05));
    }
    const double found = pairs / gathered * passes;
    const StudentTest mean(off), variance(noise);
    MESSAGE(photons << " photons, found " << found << "; E off by " << mean.mean << " +- " << mean.error
                    << "; n times its relative variance off 4/3 by " << variance.mean << " +- " << variance.error);
    const double level = sidak_level(1e-3, 6);
    CHECK(mean.p > level);
    CHECK(variance.p > level);
    CHECK(variance.error < 0.1);  // a circle's would be off by 1/3
    // Counts scatter as Poisson's.
    const double z = (found / photons - 1) * std::sqrt(photons * 64 * seeds);
    CHECK(normal_two_sided(z) > level);
  }
}

TEST_CASE("an automatic radius takes in as many of all photons, whatever the passes") {
  Device device;
  Scene scene = ball_over_plane(1.0);
  scene.lights.push_back({"sun", {}, DirectionalLight{{0, -1, 0}, Spectrum(3.0)}});
  scene.render.samples = 8;
  scene.photons.estimate = PhotonEstimate::automatic_radius;
  scene.photons.count = 200'000;
  const RenderResult one = rendered(scene, device, {View::beauty});
  const RenderResult eight = rendered(scene, device, {View::beauty, View::error});
  CHECK(one.passes == 1);
  CHECK(eight.passes == 8);
  // Judged by 128 of 1,024 places and their 8th neighbours: a Poisson number's root is off by 1 / (2 sqrt(8)) at a place,
  // the median over places by some hundredths.
  CHECK(eight.photon_radius / one.photon_radius == doctest::Approx(1.0).epsilon(0.1));
  CHECK(one.photons_in_estimate() == doctest::Approx(50).epsilon(0.25));
  CHECK(eight.photons_in_estimate() == doctest::Approx(50).epsilon(0.25));
}

TEST_CASE("the bias of the photons' radius under a point light") {
  // E = I h / (h^2 + x^2)^(3/2). Its mean over a disc of radius s is 2 I / s^2 (1 - h / sqrt(h^2 + s^2)), and Epanechnikov's
  // kernel of radius r is discs with the weights 4 s^3 / r^4 ds: E_r = 8 I / r^4 (r^2 / 2 - h sqrt(h^2 + r^2) + h^2).
  constexpr double h = 0.8, r = 0.16;
  const auto smoothed = [](double s) {
    return 8 / std::pow(s, 4) * (s * s / 2 - h * std::sqrt(h * h + s * s) + h * h);
  };
  const double truth = 1 / (h * h), bias = smoothed(r) - truth;
  const double estimate = 2 * (smoothed(r) - smoothed(r / std::numbers::sqrt2));
  // The leading term, r^2 lap(E) / 12 with lap(E) = -6 I / h^4, and what the estimate lacks of the rest.
  CHECK(bias == doctest::Approx(-r * r / (2 * std::pow(h, 4))).epsilon(0.03));
  CHECK(estimate == doctest::Approx(bias).epsilon(0.03));

  Device device;
  Scene scene = ball_over_plane(1.0);
  scene.lights.push_back({"lamp", {}, PointLight{{0, h, 0}, Spectrum(1.0)}});
  std::get<Sphere>(scene.shapes[1].geometry) = {{0, 0.3, 0}, 0.15};
  scene.camera = {CameraType::pinhole, {0.9, 0.5, 0}, {0, 0, 0}, {0, 1, 0}, 0.01};
  scene.film.width = scene.film.height = 2;
  scene.render.samples = 8;
  scene.render.lights = false;
  scene.photons.count = 400'000;
  scene.photons.estimate = PhotonEstimate::fixed_radius;
  scene.photons.radius = r;
  std::vector<double> off;
  for (uint64_t seed = 1; seed <= 32; ++seed) {
    scene.render.seed = seed;
    const RenderResult result = rendered(scene, device, {View::caustics, View::bias});
    REQUIRE(result.passes == 8);
    off.push_back(mean_of(result.film.mean("bias")) * pi / 0.8 / estimate - 1);
  }
  const StudentTest test(off);
  MESSAGE("bias " << 100 * bias / truth << " % of E; its estimate off by " << 100 * test.mean << " +- " << 100 * test.error
                  << " % of it");
  CHECK(test.p > 1e-4);
  CHECK(test.error < 0.05);
}
