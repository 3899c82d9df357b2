// Error of a caustic against the processor time that it takes, by number of photons.

#include <algorithm>

#include "bench/benchmarks.hpp"
#include "bench/timed_render.hpp"
#include "core/fit.hpp"
#include "film/metrics.hpp"
#include "verify/caustic_plate.hpp"

namespace vitrum {
namespace {

/// A line of the plot: a scene, and what is right.
struct Case {
  std::string name;
  Scene scene;
  std::function<double(const RenderResult&)> error;
  PictureLayer truth;
  bool draws = false;  ///< what its photons light is drawn by area: one sample shows it
};

/// The caustic is finer than pixels, which shows once there are many photons.
int samples_for(uint64_t photons) { return static_cast<int>(std::clamp<uint64_t>(photons >> 14, 4, 256)); }

/// The default scene's caustic, from the exact ball and from a mesh of 516,960 triangles.
std::vector<Case> plates(bool quick) {
  std::vector<Case> cases;
  const auto add_case = [&](const char* name, const CausticPlate& plate) {
    cases.push_back({name, plate.scene, [plate](const RenderResult& result) { return plate.error(result); },
                     {"beauty", 1, {plate.truth().begin(), plate.truth().end()}}});
    cases.back().scene.photons.estimate = PhotonEstimate::automatic_radius;
  };
  const auto add_footprints = [&](const char* name, const CausticPlate& plate) {
    add_case(name, plate);
    cases.back().scene.photons.estimate = PhotonEstimate::footprints;
    cases.back().draws = true;
  };
  const CausticPlate exact;
  add_case("exact ball", exact);
  add_case("exact ball, 50 nearest photons (Jensen 1996)", exact);
  cases.back().scene.photons.estimate = PhotonEstimate::nearest;
  cases.back().scene.photons.max_radius = 0.1;
  add_footprints("exact ball, footprints", exact);
  if (quick) return cases;
  const CausticPlate mesh(360);
  add_case("ball of 516,960 triangles", mesh);
  add_footprints("ball of 516,960 triangles, footprints", mesh);
  return cases;
}

/// The user's scene, against a run of many more photons.
Case long_run(const BenchContext& context, uint64_t most) {
  Scene scene = *context.scene;
  scene.photons.count = truth_factor * most;
  scene.render.samples = 4 * samples_for(most);
  scene.render.seed += 1;
  RenderOptions options;
  options.kernels = context.kernels;
  options.views = {View::caustics};
  const std::vector<double> truth = render(scene, context.device, options).film.mean("caustics");
  return {"scene", *context.scene, [truth](const RenderResult& result) { return error_over_mean(result.film.mean("caustics"), truth); },
          {"beauty", 3, {truth.begin(), truth.end()}}};
}

}  // namespace

BenchResult bench_photons(const BenchContext& context) {
  const uint64_t least = context.quick ? 1u << 10 : 1u << 12, most = context.quick ? 1u << 12 : 1u << 22;
  const std::vector<Case> cases =
      context.scene ? std::vector<Case>{long_run(context, most)} : plates(context.quick);
  BenchResult result;
  result.plot = {context.scene ? "Caustics of a scene, against a long run" : "The default scene's caustic, against its irradiance by quadrature",
                 "processor time of photons and camera rays [s]", "relative RMSE", {}, true, true};
  const FilmSettings& film = cases.front().scene.film;
  result.truth = cases.front().truth;
  result.width = film.width, result.height = film.height;
  double done = 0.0;
  for (const Case& c : cases) {
    std::vector<std::pair<double, double>> by_photons, by_seconds;
    for (uint64_t count = least; count <= most; count *= 4) {
      Scene scene = c.scene;
      scene.photons.count = count;
      scene.render.samples = c.draws ? 1 : samples_for(count);
      const RenderResult r = timed_render(context, scene, View::caustics);
      const double photons = static_cast<double>(count), error = c.error(r);
      const double photon_seconds = r.cpu_seconds.at("photon"), seconds = compute_seconds(r);
      result.rows.push_back({c.name, {{"photons", photons}, {"samples", static_cast<double>(scene.render.samples)},
                                      {"photon CPU s", photon_seconds}, {"camera CPU s", r.cpu_seconds.at("camera")},
                                      {"CPU s", seconds}, {"error", error}, {"M photons/CPU s", 1e-6 * photons / photon_seconds}}});
      by_photons.emplace_back(photons, error);
      by_seconds.emplace_back(seconds, error);
      context.progress((done += 4.0 / 3.0 * photons / static_cast<double>(most) / static_cast<double>(cases.size())) );
    }
    result.findings.push_back(printed("%s: error ~ photons^%.2f, ~ (CPU s)^%.2f", c.name.c_str(), fitted_exponent(by_photons),
                                      fitted_exponent(by_seconds)));
    for (const double level : {0.1, 0.02})
      if (const double at = first_at_level(by_seconds, level); at == at)
        result.findings.push_back(printed("%s: error %.2f after %.3g CPU s, %.3g photons", c.name.c_str(), level, at,
                                          first_at_level(by_photons, level)));
    result.plot.lines.push_back({c.name, by_seconds});
  }
  return result;
}

}  // namespace vitrum
