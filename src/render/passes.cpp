#include "render/passes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/cpu_time.hpp"
#include "render/photon_dots.hpp"

namespace vitrum {
namespace {

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

bool is_among(View view, const std::vector<View>& views) {
  return std::find(views.begin(), views.end(), view) != views.end();
}

}  // namespace

Passes::Passes(const KernelContext& context, DeviceScene& device_scene, const std::vector<View>& views,
               std::shared_future<void> textures_ready)
    : context_(context),
      device_scene_(device_scene),
      views_(views),
      textures_ready_(std::move(textures_ready)),
      camera_(context, is_among(View::albedo, views) || is_among(View::normal, views) || is_among(View::depth, views)) {
  if (!context.features.caustics) return;
  photons_ = std::make_unique<PhotonPass>(context);
  if (context.features.patches) {
    const CpuTimer timer(cpu_seconds_["camera"]);
    patches_ = std::make_unique<PatchView>(context);
  }
  if (wants(View::bias)) narrow_camera_ = std::make_unique<CameraPass>(context, false);
}

bool Passes::wants(View view) const { return is_among(view, views_); }

void Passes::shoot(const PhotonPassPlan& plan, const std::function<void(double)>& progress) {
  const CpuTimer timer(cpu_seconds_["photon"]);
  photons_->run(plan, patches_.get(), wants(View::photons), progress);
  radius_sum_ += static_cast<double>(photons_->map().radius);
}

std::vector<float> Passes::dots() const {
  if (!photons_ || !wants(View::photons)) return {};
  return photon_dots(read_photons(context_.device, photons_->map()), context_.data.camera);
}

void Passes::start(uint32_t replicate, uint32_t first, SampleCounts counts, uint32_t parts, bool is_only) {
  if (!std::exchange(textures_there_, true) && context_.features.textures) {
    if (textures_ready_.valid()) textures_ready_.get();
    device_scene_.upload_texels(context_.device, texel_data(context_.scene));
  }
  const CpuTimer timer(cpu_seconds_["camera"]);
  if (narrow_camera_) narrow_camera_->start(replicate, first, counts, parts, is_only);
  camera_.start(replicate, first, std::move(counts), parts, is_only);
}

std::vector<PlaneSums> Passes::trace(uint32_t part, uint32_t first, uint32_t last,
                                     const std::function<void(double)>& progress) {
  const CpuTimer timer(cpu_seconds_["camera"]);
  const size_t pixels = static_cast<size_t>(context_.scene.film.width) * static_cast<size_t>(context_.scene.film.height);
  camera_.run(part, first, last, map(), patches_.get(), [&](double done) {
    if (first_pixels_ == std::chrono::steady_clock::time_point()) first_pixels_ = std::chrono::steady_clock::now();
    progress(done);
  });
  const std::vector<float> planes = camera_.take_film();
  std::vector<PlaneSums> sums;
  const auto add = [&](const char* name, size_t plane, int channels) {
    sums.push_back({name, channels, interleaved(planes, pixels, plane, channels)});
  };
  add("radiance", FILM_BEAUTY, 3);
  add("cut", FILM_CUT, 1);
  if (wants(View::caustics)) add("caustics", FILM_CAUSTICS, 3);
  if (wants(View::albedo)) add("albedo", FILM_ALBEDO, 3);
  if (wants(View::normal)) add("normal", FILM_NORMAL, 3);
  if (wants(View::depth)) add("depth", FILM_DEPTH, 1);
  if (narrow_camera_) {
    // The bias of Epanechnikov's kernel goes as the square of the radius: half of it is half as much.
    PhotonMap narrow = photons_->map();
    narrow.radius *= std::numbers::sqrt2_v<float> / 2.0f;
    narrow_camera_->run(part, first, last, &narrow, nullptr, [](double) {});
    const std::vector<float> less = interleaved(narrow_camera_->take_film(), pixels, FILM_CAUSTICS, 3);
    std::vector<float> bias = interleaved(planes, pixels, FILM_CAUSTICS, 3);
    for (size_t i = 0; i < bias.size(); ++i) bias[i] = 2.0f * (bias[i] - less[i]);
    sums.push_back({"bias", 3, std::move(bias)});
  }
  return sums;
}

HalvedPass Passes::trace_halves(uint32_t replicate, uint32_t first, const SampleCounts& counts,
                                const std::function<void(double)>& progress) {
  start(replicate, first, counts, 2, false);
  std::vector<PlaneSums> halves[2];
  for (uint32_t half = 0; half < 2; ++half)
    for (uint32_t sample = 0; sample < counts.most(); sample += samples_per_noisy_batch) {
      const uint32_t last = std::min(counts.most(), sample + samples_per_noisy_batch);
      std::vector<PlaneSums> sums = trace(half, sample, last, [&](double done) {
        progress(0.5 * (half + (sample + done * (last - sample)) / counts.most()));
      });
      if (halves[half].empty()) {
        halves[half] = std::move(sums);
        continue;
      }
      for (size_t plane = 0; plane < sums.size(); ++plane)
        for (size_t i = 0; i < sums[plane].values.size(); ++i) halves[half][plane].values[i] += sums[plane].values[i];
    }

  const size_t pixels = counts.pixel_of_slot.size();
  std::vector<float> inverse(pixels);  // of all samples
  for (size_t slot = 0; slot < pixels; ++slot)
    inverse[counts.pixel_of_slot[slot]] = 0.5f / static_cast<float>(counts.in_slot(slot));
  HalvedPass pass;
  pass.variance.assign(pixels, 0.0);
  for (size_t plane = 0; plane < halves[0].size(); ++plane) {
    PlaneSums& sums = halves[0][plane];
    const std::vector<float>& rest = halves[1][plane].values;
    const auto channels = static_cast<size_t>(sums.channels);
    const bool is_radiance = sums.name == "radiance";
    for (size_t i = 0; i < sums.values.size(); ++i) {
      const float share = inverse[i / channels];
      // Half the difference of the halves' means is as far off as their mean is.
      const double off = static_cast<double>(share) * (static_cast<double>(sums.values[i]) - static_cast<double>(rest[i]));
      if (is_radiance && std::isfinite(off)) {
        pass.variance[i / channels] += off * off / static_cast<double>(share);
        pass.error += off * off / static_cast<double>(sums.values.size());
      }
      sums.values[i] = (sums.values[i] + rest[i]) * share;
    }
    pass.means.push_back(std::move(sums));
  }
  return pass;
}

}  // namespace vitrum
