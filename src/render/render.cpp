#include "render/render.hpp"

#include <time.h>

#include <algorithm>
#include <span>

#include "core/log.hpp"
#include "core/progress.hpp"
#include "core/suggest.hpp"
#include "render/photon_dots.hpp"

namespace vitrum {
namespace {

constexpr View all_views[] = {View::beauty, View::photons, View::caustics, View::albedo, View::normal, View::depth};

// Samples that are summed in float on the device before the film takes them over in double.
constexpr uint32_t samples_per_download = 32;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Books the CPU time of the process, all threads and the system's part of it, while it lives.
class CpuTimer {
 public:
  explicit CpuTimer(double& seconds) : seconds_(seconds), start_(now()) {}
  ~CpuTimer() { seconds_ += now() - start_; }
  CpuTimer(const CpuTimer&) = delete;
  CpuTimer& operator=(const CpuTimer&) = delete;

 private:
  static double now() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }
  double& seconds_;
  double start_;
};

/// `channels` planes of a pass's film, interleaved as the film has them.
std::vector<float> interleaved(const std::vector<float>& planes, size_t pixels, size_t first, int channels) {
  std::vector<float> values(pixels * static_cast<size_t>(channels));
  for (size_t c = 0; c < static_cast<size_t>(channels); ++c)
    for (size_t i = 0; i < pixels; ++i)
      values[i * static_cast<size_t>(channels) + c] = planes[(first + c) * pixels + i];
  return values;
}

}  // namespace

const char* view_name(View view) {
  switch (view) {
    case View::beauty: return "beauty";
    case View::photons: return "photons";
    case View::caustics: return "caustics";
    case View::albedo: return "albedo";
    case View::normal: return "normal";
    case View::depth: return "depth";
  }
  return "";
}

View view_of_name(const std::string& name) {
  for (View view : all_views)
    if (name == view_name(view)) return view;
  std::vector<std::string> names;
  for (View view : all_views) names.push_back(view_name(view));
  throw Error({"--view " + name}, "there is no such view", suggestion(name, names, "views"));
}

RenderResult render(const Scene& scene, Device& device, const RenderOptions& options) {
  RenderResult result;
  const auto start = std::chrono::steady_clock::now();
  const Features features = result.features = scene_features(scene);
  note("features: " + features.names());

  const auto wants = [&](View view) {
    return std::find(options.views.begin(), options.views.end(), view) != options.views.end();
  };
  const SceneData data = scene_data(scene, features);
  Tree tree;
  if (features.mesh) tree = build_tree(data.tree_triangles);
  result.seconds["tree"] = seconds_since(start);
  const Kernels kernels(device, options.kernels, stages_for(features), features.build_options());
  result.seconds["build"] = kernels.build_seconds();
  const auto upload_start = std::chrono::steady_clock::now();
  DeviceScene device_scene = upload(device, data, features, features.mesh ? &tree : nullptr);
  result.seconds["upload"] = seconds_since(upload_start);
  const KernelContext context{device, kernels, scene, data, device_scene, features};

  const uint32_t samples = static_cast<uint32_t>(scene.render.samples);
  const uint64_t photons = features.caustics ? scene.photons.count : 0;
  // A pass holds no more photons than the device has room for.
  uint64_t passes = static_cast<uint64_t>(scene.render.passes);
  if (photons > 0) passes = std::max(passes, (photons + PhotonPass::capacity(device) - 1) / PhotonPass::capacity(device));
  passes = std::min<uint64_t>(passes, samples);
  result.passes = static_cast<int>(passes);
  const int replicates = static_cast<int>(std::min<uint64_t>(passes, Film::max_replicates));
  result.film = Film(scene.film.width, scene.film.height, replicates);
  const size_t pixels = static_cast<size_t>(scene.film.width) * static_cast<size_t>(scene.film.height);
  const bool first_hits = wants(View::albedo) || wants(View::normal) || wants(View::depth);

  CameraPass camera(context, first_hits);
  std::unique_ptr<PhotonPass> photon_pass;
  if (photons > 0) photon_pass = std::make_unique<PhotonPass>(context, (photons + passes - 1) / passes);
  std::vector<uint64_t> photons_before(static_cast<size_t>(replicates), 0);
  Progress progress("render");
  for (uint64_t pass = 0; pass < passes; ++pass) {
    const uint32_t replicate = static_cast<uint32_t>(pass % static_cast<uint64_t>(replicates));
    const double photon_share = photon_pass ? 0.3 : 0.0;
    const auto done = [&](double within) { progress.update((static_cast<double>(pass) + within) / static_cast<double>(passes)); };
    if (photon_pass) {
      const CpuTimer timer(result.cpu_seconds["photon"]);
      const uint64_t count = photons * (pass + 1) / passes - photons * pass / passes;
      photon_pass->run(pass, replicate, photons_before[replicate], count, [&](double d) { done(photon_share * d); });
      photons_before[replicate] += count;
      result.photon_radius = photon_pass->map().radius;
      if (wants(View::photons)) {
        result.film.add(pass, "photons", 1, photon_dots(read_photons(device, photon_pass->map()), data.camera), 1.0);
      }
    }
    if (pass == 0 && features.textures) {
      if (options.textures_ready.valid()) options.textures_ready.get();
      device_scene.upload_texels(device, texel_data(scene));
    }
    const uint32_t first = static_cast<uint32_t>(samples * pass / passes);
    const uint32_t last = static_cast<uint32_t>(samples * (pass + 1) / passes);
    const CpuTimer timer(result.cpu_seconds["camera"]);
    for (uint32_t sample = first; sample < last; sample += samples_per_download) {
      const uint32_t count = std::min(samples_per_download, last - sample);
      camera.run(replicate, sample, count, samples, photon_pass ? &photon_pass->map() : nullptr, [&](double d) {
        if (result.first_pixels == std::chrono::steady_clock::time_point())
          result.first_pixels = std::chrono::steady_clock::now();
        done(photon_share + (1.0 - photon_share) * (sample - first + d * count) / (last - first));
      });
      const std::vector<float> planes = camera.take_film();
      const auto add = [&](const char* name, size_t plane, int channels) {
        result.film.add(pass, name, channels, interleaved(planes, pixels, plane, channels), count);
      };
      add("radiance", FILM_BEAUTY, 3);
      add("cut", FILM_CUT, 1);
      if (wants(View::caustics)) add("caustics", FILM_CAUSTICS, 3);
      if (wants(View::albedo)) add("albedo", FILM_ALBEDO, 3);
      if (wants(View::normal)) add("normal", FILM_NORMAL, 3);
      if (wants(View::depth)) add("depth", FILM_DEPTH, 1);
    }
  }
  if (photon_pass) {
    // Every pass shoots the lights' whole power; the picture is the mean of the passes.
    result.photons = photon_pass->balance();
    for (Spectrum PhotonBalance::*power : {&PhotonBalance::shot, &PhotonBalance::stored, &PhotonBalance::absorbed,
                                           &PhotonBalance::direct, &PhotonBalance::lost, &PhotonBalance::cut,
                                           &PhotonBalance::not_aimed})
      result.photons.*power /= static_cast<double>(passes);
  }
  result.rays = camera.counts();
  for (const auto& [stage, seconds] : device.stage_seconds()) result.seconds[stage] = seconds;
  result.memory = device.memory_by_purpose();
  return result;
}

}  // namespace vitrum
