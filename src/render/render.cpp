#include "render/render.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "core/cpu_time.hpp"
#include "core/log.hpp"
#include "core/printed.hpp"
#include "core/progress.hpp"
#include "core/suggest.hpp"
#include "render/photon_dots.hpp"

namespace vitrum {
namespace {

constexpr View all_views[] = {View::beauty, View::photons, View::caustics, View::albedo, View::normal,
                              View::depth,  View::error,   View::cut,      View::bias};

// Samples that are summed in float on the device before the film takes them over in double.
constexpr uint32_t samples_per_download = 32;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Books the CPU time of the process while it lives.
class CpuTimer {
 public:
  explicit CpuTimer(double& seconds) : seconds_(seconds), start_(process_cpu_seconds()) {}
  ~CpuTimer() { seconds_ += process_cpu_seconds() - start_; }
  CpuTimer(const CpuTimer&) = delete;
  CpuTimer& operator=(const CpuTimer&) = delete;

 private:
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

std::vector<double> RenderResult::standard_error() const {
  std::vector<double> error = film.variance_of_mean("radiance");
  for (double& value : error) value = std::sqrt(value);
  return error;
}

double RenderResult::photons_in_estimate() const {
  if (rays.gathered == 0) return 0.0;
  return static_cast<double>(rays.gathered_pairs) / static_cast<double>(rays.gathered) * passes;
}

const char* view_name(View view) {
  switch (view) {
    case View::beauty: return "beauty";
    case View::photons: return "photons";
    case View::caustics: return "caustics";
    case View::albedo: return "albedo";
    case View::normal: return "normal";
    case View::depth: return "depth";
    case View::error: return "error";
    case View::cut: return "cut";
    case View::bias: return "bias";
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
  for (const View view : {View::error, View::bias})
    if (wants(view) && scene.render.samples < 2)
      throw Error({std::string("--view ") + view_name(view)}, "one sample a pixel has no scatter",
                  "take at least --samples 2; 8 and their multiples tell the error best");
  if (wants(View::bias) && (features.nearest_photons || features.footprints))
    throw Error({"--view bias"},
                printed("the bias of %s is not known", features.footprints ? "footprints" : "the k nearest photons"),
                "take photons.estimate \"automatic\" or \"radius\"");
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

  const uint32_t samples = static_cast<uint32_t>(scene.render.samples);
  const uint64_t photons = features.caustics ? scene.photons.count : 0;
  // A pass holds no more photons than the device has room for.
  uint64_t passes = static_cast<uint64_t>(scene.render.passes);
  const uint64_t capacity = PhotonPass::capacity(device, features);
  if (photons > 0) passes = std::max(passes, (photons + capacity - 1) / capacity);
  // Each replicate needs a pass.
  if (wants(View::error) || wants(View::bias)) passes = std::max<uint64_t>(passes, Film::max_replicates);
  passes = std::min<uint64_t>(passes, samples);
  result.passes = static_cast<int>(passes);
  const int replicates = static_cast<int>(std::min<uint64_t>(passes, Film::max_replicates));
  result.film = Film(scene.film.width, scene.film.height, replicates);
  const size_t pixels = static_cast<size_t>(scene.film.width) * static_cast<size_t>(scene.film.height);
  const bool first_hits = wants(View::albedo) || wants(View::normal) || wants(View::depth);

  CameraPass camera(context, first_hits);
  std::unique_ptr<CameraPass> narrow_camera;  // gathers within a smaller radius
  if (wants(View::bias) && photons > 0) narrow_camera = std::make_unique<CameraPass>(context, false);
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
      result.photon_radius += static_cast<double>(photon_pass->map().radius) / static_cast<double>(passes);
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
        result.rejected_values += result.film.add(pass, name, channels, interleaved(planes, pixels, plane, channels), count);
      };
      add("radiance", FILM_BEAUTY, 3);
      add("cut", FILM_CUT, 1);
      if (wants(View::caustics)) add("caustics", FILM_CAUSTICS, 3);
      if (wants(View::albedo)) add("albedo", FILM_ALBEDO, 3);
      if (wants(View::normal)) add("normal", FILM_NORMAL, 3);
      if (wants(View::depth)) add("depth", FILM_DEPTH, 1);
      if (narrow_camera) {
        // The bias of Epanechnikov's kernel goes as the square of the radius: half of it is half as much.
        PhotonMap narrow = photon_pass->map();
        narrow.radius *= std::numbers::sqrt2_v<float> / 2.0f;
        narrow_camera->run(replicate, sample, count, samples, &narrow, [](double) {});
        const std::vector<float> less = interleaved(narrow_camera->take_film(), pixels, FILM_CAUSTICS, 3);
        std::vector<float> bias = interleaved(planes, pixels, FILM_CAUSTICS, 3);
        for (size_t i = 0; i < bias.size(); ++i) bias[i] = 2.0f * (bias[i] - less[i]);
        result.rejected_values += result.film.add(pass, "bias", 3, bias, count);
      }
    }
  }
  if (photon_pass) {
    // Every pass shoots the lights' whole power; the picture is the mean of the passes.
    result.photons = photon_pass->balance();
    for (Spectrum PhotonBalance::*power : {&PhotonBalance::shot, &PhotonBalance::stored, &PhotonBalance::absorbed,
                                           &PhotonBalance::direct, &PhotonBalance::lost, &PhotonBalance::cut,
                                           &PhotonBalance::split, &PhotonBalance::not_aimed})
      result.photons.*power /= static_cast<double>(passes);
  }
  result.rays = camera.counts();
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
