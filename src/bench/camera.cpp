// Error of a picture against the processor time that it takes, by samples a pixel. Photons are left out.

#include "bench/benchmarks.hpp"
#include "bench/timed_render.hpp"
#include "core/fit.hpp"
#include "film/metrics.hpp"
#include "verify/scenes.hpp"

namespace vitrum {
namespace {

/// A ball of glass and one that scatters under a round lamp: edges, penumbras, splitting.
Scene two_balls(int size) {
  Scene scene;
  scene.film.width = scene.film.height = size;
  scene.camera = {CameraType::pinhole, {2, 1.5, 2}, {0, 0.4, 0}, {0, 1, 0}, 40};
  scene.background = {0.1, 0.3, 0.6};
  scene.materials = {glass(1.5), surface(Surface::opaque, 0.7)};
  scene.materials[0].absorption = {0.1, 0.5, 2.0};
  add(scene, Sphere{{0, 0.5, 0}, 0.3}, 0);
  add(scene, Sphere{{-0.7, 0.3, 0.2}, 0.3}, 1);
  add(scene, Plane{{0, 0, 0}, {0, 1, 0}, {}, {}}, 1);
  scene.lights.push_back({"lamp", {}, DiscLight{{0.1, 1.8, 0.2}, {0, -1, 0}, 0.3, Spectrum(10.0)}});
  return scene;
}

}  // namespace

BenchResult bench_camera(const BenchContext& context) {
  Scene scene = context.scene ? *context.scene : two_balls(context.quick ? 32 : 256);
  scene.render.caustics = false;
  const int most = context.quick ? 16 : 256;
  BenchResult result;
  result.plot = {"A picture without caustics, against a long run", "processor time of camera rays [s]", "relative RMSE", {}, true, true};
  RenderOptions options;
  options.kernels = context.kernels;
  Scene longest = scene;
  longest.render.samples = static_cast<int>(truth_factor) * most;
  longest.render.seed += 1;
  const std::vector<double> truth = render(longest, context.device, options).film.mean("radiance");
  result.truth = {"beauty", 3, {truth.begin(), truth.end()}};
  result.width = scene.film.width, result.height = scene.film.height;
  context.progress(0.5);
  std::vector<std::pair<double, double>> by_samples, by_seconds;
  for (int samples = 1; samples <= most; samples *= 4) {
    scene.render.samples = samples;
    const RenderResult r = timed_render(context, scene, View::beauty);
    const double seconds = compute_seconds(r), error = error_over_mean(r.film.mean("radiance"), truth);
    const double rays = static_cast<double>(r.rays.camera + r.rays.secondary + r.rays.shadow);
    result.rows.push_back({context.scene ? "scene" : "two balls", {{"samples", static_cast<double>(samples)}, {"CPU s", seconds}, {"error", error},
                                         {"M rays/CPU s", 1e-6 * rays / seconds}}});
    by_samples.emplace_back(samples, error);
    by_seconds.emplace_back(seconds, error);
  }
  context.progress(1.0);
  result.findings.push_back(printed("error ~ samples^%.2f", fitted_exponent(by_samples)));
  result.plot.lines.push_back({context.scene ? "scene" : "two balls", by_seconds});
  return result;
}

}  // namespace vitrum
