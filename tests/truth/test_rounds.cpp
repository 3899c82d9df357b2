// Rendering to an error: the true one lies in the interval that is told as often as it claims. Adaptive sampling.

#include <doctest/doctest.h>

#include <cmath>

#include "film/metrics.hpp"
#include "scene/scene_file.hpp"
#include "verify/caustic_plate.hpp"

namespace vitrum {
namespace {

constexpr int seeds = 100;

struct Coverage {
  int within = 0, met = 0;      ///< intervals that hold the truth; pictures whose true error is below the target
  double told = 0.0, truth = 0.0;  ///< means

  void add(const RoundsResult& rounds, double error, double target) {
    CHECK(rounds.end == RoundsResult::End::target);
    CHECK(rounds.error.value <= target);
    within += rounds.error.low <= error && error <= rounds.error.high;
    met += error <= target;
    told += rounds.error.value;
    truth += error;
  }
};

/// A ball of glass over a plane that a lamp lights, without its caustic.
Scene ball_under_lamp() {
  Scene scene;
  scene.camera = {CameraType::pinhole, {0.9, 0.7, 0}, {0, 0.2, 0}, {0, 1, 0}, 40};
  scene.film.width = scene.film.height = 24;
  scene.background = Spectrum(0.3);
  scene.materials = {surface(Surface::opaque, 0.8), glass(1.5)};
  add(scene, Plane{{0, 0, 0}, {0, 1, 0}, {}, {}}, 0);
  add(scene, Sphere{{0, 0.3, 0}, 0.2}, 1);
  scene.lights.push_back({"lamp", {}, PointLight{{0.2, 1, 0.1}, Spectrum(1.0)}});
  scene.render.caustics = false;
  return scene;
}

}  // namespace

TEST_CASE("rounds: the error of a picture by camera rays alone is what it is told to be") {
  Device device;
  Scene scene = ball_under_lamp();
  scene.render.samples = 1 << 14;
  const std::vector<double> truth = render(scene, device, {}).film.mean("radiance");
  scene.render.target_error = 0.01;
  Coverage coverage;
  for (int seed = 1; seed <= seeds; ++seed) {
    scene.render.seed = static_cast<uint64_t>(seed);
    const RenderResult result = render(scene, device, {});
    coverage.add(*result.rounds, error_over_mean(result.film.mean("radiance"), truth), scene.render.target_error);
    CHECK(result.rounds->error.bias == 0.0);
  }
  MESSAGE("within " << coverage.within << ", met " << coverage.met << ", told " << coverage.told / seeds << ", true "
                    << coverage.truth / seeds);
  // 95 are expected, and fewer than 88 by chance once in a thousand times.
  CHECK(coverage.within >= 88);
  CHECK(std::abs(coverage.told / coverage.truth - 1.0) < 0.1);
}

TEST_CASE("rounds: the error of a caustic, noise and bias, is within what it is told to be") {
  Device device;
  const CausticPlate plate;
  RenderOptions options;
  options.views = {View::caustics};
  struct Case {
    PhotonEstimate estimate;
    double target_error;
    int seeds, least;           // of them, in the interval of 95 % but once in 300 times; and below the target
  };
  for (const Case& c : {Case{PhotonEstimate::automatic, 0.15, 50, 43}, Case{PhotonEstimate::footprints, 0.15, 50, 43},
                        Case{PhotonEstimate::footprints, 0.01, 25, 20}}) {
    CAPTURE(c.estimate == PhotonEstimate::footprints);
    CAPTURE(c.target_error);
    Scene scene = plate.scene;
    scene.render.lights = false;
    scene.photons.estimate = c.estimate;
    scene.render.target_error = c.target_error;
    Coverage coverage;
    for (int seed = 1; seed <= c.seeds; ++seed) {
      scene.render.seed = static_cast<uint64_t>(seed);
      const RenderResult result = render(scene, device, options);
      coverage.add(*result.rounds, error_over_mean(CausticPlate::irradiance(result), plate.truth()), scene.render.target_error);
    }
    MESSAGE("within " << coverage.within << ", met " << coverage.met << ", told " << coverage.told / c.seeds << ", true "
                      << coverage.truth / c.seeds);
    // What is not known of the bias is on the safe side.
    CHECK(coverage.within >= c.least);
    CHECK(coverage.met >= c.least);
    CHECK(coverage.told > coverage.truth);
  }
}

TEST_CASE("adaptive sampling: as many samples leave less error, and none on average") {
  Device device;
  // The lamp's highlights are small and bright.
  Scene scene = load_scene(VITRUM_SOURCE_DIR "/models/default_scene/scene.toml",
                           {"film.size=[40, 40]", "render.caustics=false", "render.textures=false"});
  scene.render.samples = 1 << 15;
  const std::vector<double> truth = render(scene, device, {}).film.mean("radiance");
  scene.render.samples = 32;
  const int pictures = 40;
  double errors[2] = {}, errors_of_mean[2] = {};
  for (const bool adaptive : {false, true}) {
    scene.render.adaptive = adaptive;
    std::vector<double> mean(truth.size(), 0.0);
    for (int seed = 1; seed <= pictures; ++seed) {
      scene.render.seed = static_cast<uint64_t>(seed);
      const RenderResult result = render(scene, device, {});
      CHECK(result.samples <= 44.0);  // neighbours in a packet take as many as the neediest
      CHECK(result.samples >= 16.0);
      const std::vector<double> picture = result.film.mean("radiance");
      errors[adaptive] += std::pow(error_over_mean(picture, truth), 2.0) / pictures;
      for (size_t i = 0; i < mean.size(); ++i) mean[i] += picture[i] / pictures;
    }
    errors_of_mean[adaptive] = std::pow(error_over_mean(mean, truth), 2.0);
  }
  MESSAGE("squared errors " << errors[0] << " and " << errors[1] << ", of means of " << pictures << ": " << errors_of_mean[0]
                            << " and " << errors_of_mean[1]);
  CHECK(errors[1] < 0.5 * errors[0]);
  // Without bias, the mean of N pictures has an N-th of the squared error.
  CHECK(errors_of_mean[1] < 2.0 / pictures * errors[1]);
}

TEST_CASE("rounds: a time limit ends them, with a picture and what is known of its error") {
  Device device;
  Scene scene = CausticPlate().scene;
  scene.render.time_limit = 0.001;  // less than a round takes
  const RenderResult one = render(scene, device, {});
  CHECK(one.rounds->end == RoundsResult::End::time);
  CHECK(one.rounds->rounds == 1);
  CHECK(!one.rounds->error.bias_known);
  CHECK(one.rounds->error.noise > 0.0);
  CHECK(one.film.mean("radiance").size() == 3 * 128 * 128);
  // Of both limits the first met counts.
  scene.render.time_limit = 1e6;
  scene.render.target_error = 0.5;
  CHECK(render(scene, device, {}).rounds->end == RoundsResult::End::target);
}

TEST_CASE("rounds: footprints that no memory would make small enough end them") {
  Device device;
  Scene scene = CausticPlate().scene;
  scene.render.lights = false;
  scene.film.width = scene.film.height = 16;
  scene.photons.estimate = PhotonEstimate::footprints;
  scene.render.target_error = 1e-4;
  CHECK(render(scene, device, {}).rounds->end == RoundsResult::End::footprints);
}

}  // namespace vitrum
