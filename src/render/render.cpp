#include "render/render.hpp"

#include <algorithm>
#include <cmath>

#include "core/log.hpp"
#include "core/printed.hpp"
#include "core/progress.hpp"
#include "render/passes.hpp"
#include "render/sample_allocation.hpp"

namespace vitrum {
namespace {

constexpr uint32_t least_adaptive = 8;        // samples of a pixel in a pass
constexpr uint64_t replicates_of_rounds = 4;  // fewer, longer sequences are more even; 4 tell the error of a whole picture

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// A pass of about `samples` of a pixel: a quarter of them for all alike, and what these tell decides where the others go.
/// As in rounds (rounds.hpp), each part has one weight in all pixels, the square of its cost. Returns the samples taken.
double trace_adaptively(Passes& passes, uint64_t pass, uint32_t replicate, uint32_t first, uint32_t samples, int width,
                        RenderResult& result, const std::function<void(double)>& progress) {
  const auto pixels = static_cast<uint32_t>(width * result.film.height());
  const auto mean = [pixels](const SampleCounts& counts) { return 2.0 * static_cast<double>(counts.total()) / pixels; };
  const SampleCounts alike = SampleCounts::uniform(pixels, samples / 8);
  HalvedPass pilot = passes.trace_halves(replicate, first, alike, [&](double d) { progress(0.25 * d); });
  const SampleCounts rest = SampleCounts::of(allot_samples(pilot.variance, width, 0.5 * (samples - mean(alike))));
  const double taken = mean(alike) + mean(rest);
  const auto add = [&](HalvedPass& part, double cost) {
    const double weight = taken * cost * cost / (mean(alike) * mean(alike) + mean(rest) * mean(rest));
    for (PlaneSums& plane : part.means) {
      for (float& value : plane.values) value *= static_cast<float>(weight);
      result.rejected_values += result.film.add(pass, plane.name, plane.channels, plane.values, weight);
    }
  };
  add(pilot, mean(alike));
  HalvedPass others = passes.trace_halves(replicate, first + 2 * alike.most(), rest, [&](double d) { progress(0.25 + 0.75 * d); });
  add(others, mean(rest));
  return taken;
}

/// The passes of a picture whose samples and photons are given.
void run_fixed(const KernelContext& context, Passes& passes, uint64_t n_passes, RenderResult& result, Progress& progress) {
  const Scene& scene = context.scene;
  const auto samples = static_cast<uint32_t>(scene.render.samples);
  const uint64_t photons = passes.has_photons() ? scene.photons.count : 0;
  const auto replicates = static_cast<uint64_t>(result.film.replicates());
  const auto pixels = static_cast<uint32_t>(scene.film.width) * static_cast<uint32_t>(scene.film.height);
  std::vector<uint64_t> photons_before(replicates, 0);
  const double photon_share = photons > 0 ? 0.3 : 0.0;
  double taken = 0.0;           // samples of a pixel, mean
  for (uint64_t pass = 0; pass < n_passes; ++pass) {
    const auto replicate = static_cast<uint32_t>(pass % replicates);
    const auto done = [&](double within) {
      progress.update((static_cast<double>(pass) + within) / static_cast<double>(n_passes));
    };
    if (photons > 0) {
      const uint64_t count = photons * (pass + 1) / n_passes - photons * pass / n_passes;
      passes.shoot({pass, replicate, photons_before[replicate], count,
                    static_cast<double>(count) / static_cast<double>(photons), scene.render.samples},
                   [&](double d) { done(photon_share * d); });
      photons_before[replicate] += count;
      if (const std::vector<float> dots = passes.dots(); !dots.empty()) result.film.add(pass, "photons", 1, dots, 1.0);
    }
    const auto first = static_cast<uint32_t>(samples * pass / n_passes);
    const auto last = static_cast<uint32_t>(samples * (pass + 1) / n_passes);
    const auto trace_done = [&](double d) { done(photon_share + (1.0 - photon_share) * d); };
    if (scene.render.adaptive && last - first >= least_adaptive) {
      // A pixel may get many more than the mean: passes of a replicate begin far apart in its sequence.
      const auto begin = static_cast<uint32_t>(pass / replicates << 18);
      taken += trace_adaptively(passes, pass, replicate, begin, last - first, scene.film.width, result, trace_done);
      continue;
    }
    taken += last - first;
    passes.start(replicate, first, SampleCounts::uniform(pixels, last - first), 1, samples == 1);
    for (uint32_t sample = 0; sample < last - first; sample += Passes::samples_per_batch) {
      const uint32_t count = std::min(Passes::samples_per_batch, last - first - sample);
      for (const PlaneSums& sums :
           passes.trace(0, sample, sample + count, [&](double d) { trace_done((sample + d * count) / (last - first)); }))
        result.rejected_values += result.film.add(pass, sums.name, sums.channels, sums.values, count);
    }
  }
  result.passes = static_cast<int>(n_passes);
  result.samples = taken;
}

}  // namespace

std::vector<double> RenderResult::standard_error() const {
  std::vector<double> error = film.variance_of_mean("radiance");
  for (double& value : error) value = std::sqrt(value);
  return error;
}

double RenderResult::photons_in_estimate() const {
  if (rays.gathered == 0) return 0.0;
  return static_cast<double>(rays.gathered_pairs) / static_cast<double>(rays.gathered) * passes;
}

RenderResult render(const Scene& scene, Device& device, const RenderOptions& options) {
  RenderResult result;
  const auto start = std::chrono::steady_clock::now();
  Features features = scene_features(scene);

  const auto wants = [&](View view) {
    return std::find(options.views.begin(), options.views.end(), view) != options.views.end();
  };
  for (const View view : {View::error, View::bias})
    if (wants(view) && scene.render.samples < 2 && !scene.render.by_rounds())
      throw Error({std::string("--view ") + view_name(view)}, "one sample a pixel has no scatter",
                  "take at least --samples 2; 8 and their multiples tell the error best");
  if (wants(View::bias) && (features.nearest_photons || features.footprints))
    throw Error({"--view bias"},
                printed("the bias of %s is not known", features.footprints ? "footprints" : "the k nearest photons"),
                "take photons.estimate \"automatic\" or \"radius\"");
  // The bias is that of a radius, and told where one is.
  if (wants(View::bias)) features.patches = false;
  result.features = features;
  note("features: " + features.names());
  const SceneData data = scene_data(scene, features);
  Tree tree;
  if (features.mesh) tree = build_tree(data.tree_triangles);
  result.seconds["tree"] = seconds_since(start);
  const Kernels kernels(device, options.kernels, stages_for(features), features.build_options());
  result.seconds["build"] = kernels.build_seconds();
  const auto upload_start = std::chrono::steady_clock::now();
  DeviceScene device_scene = upload(device, data, features, features.mesh ? &tree : nullptr);
  result.seconds["upload"] = seconds_since(upload_start);
  const KernelContext context{device, kernels, scene, data, device_scene, features, options.launches};

  Passes passes(context, device_scene, options.views, options.textures_ready);
  const bool wants_scatter = wants(View::error) || wants(View::bias);
  const auto film_of = [&scene](uint64_t replicates) {
    return Film(scene.film.width, scene.film.height, static_cast<int>(std::min<uint64_t>(replicates, Film::max_replicates)));
  };
  Progress progress("render");
  if (scene.render.by_rounds()) {
    result.film = film_of(wants_scatter ? Film::max_replicates : replicates_of_rounds);
    result.rounds = run_rounds(context, passes, result.film, options.start, progress);
    result.rejected_values = result.rounds->rejected_values;
    result.passes = result.rounds->passes;
    result.samples = result.rounds->samples;
  } else {
    uint64_t n_passes = static_cast<uint64_t>(scene.render.passes);
    // A pass holds no more photons than the device has room for.
    const uint64_t capacity = PhotonPass::capacity(device, features);
    if (passes.has_photons()) n_passes = std::max(n_passes, (scene.photons.count + capacity - 1) / capacity);
    // Each replicate needs a pass.
    if (wants_scatter) n_passes = std::max<uint64_t>(n_passes, Film::max_replicates);
    n_passes = std::min(n_passes, static_cast<uint64_t>(scene.render.samples));
    result.film = film_of(n_passes);
    run_fixed(context, passes, n_passes, result, progress);
  }
  result.cpu_seconds = passes.cpu_seconds();
  result.first_pixels = passes.first_pixels();
  if (passes.has_photons()) {
    result.photon_radius = passes.radius_sum() / result.passes;
    // Every pass shoots the lights' whole power; the picture is the mean of the passes.
    result.photons = passes.balance();
    for (Spectrum PhotonBalance::*power : {&PhotonBalance::shot, &PhotonBalance::stored, &PhotonBalance::absorbed,
                                           &PhotonBalance::direct, &PhotonBalance::lost, &PhotonBalance::cut,
                                           &PhotonBalance::split, &PhotonBalance::not_aimed})
      result.photons.*power /= static_cast<double>(result.passes);
  }
  result.rays = passes.counts();
  result.limit = radiance_limit(scene, static_cast<double>(data.eye_index), result.film);
  const uint64_t rejected_photons = result.photons.photons_rejected;
  if (result.rejected_values + rejected_photons > 0)
    warn({}, printed("%llu values of the picture and %llu photons were not finite and are left out: a fault of vitrum's; "
                     "please report it with the scene",
                     static_cast<unsigned long long>(result.rejected_values),
                     static_cast<unsigned long long>(rejected_photons)));
  for (const auto& [stage, seconds] : device.stage_seconds()) result.seconds[stage] = seconds;
  result.memory = device.memory_by_purpose();
  return result;
}

}  // namespace vitrum
