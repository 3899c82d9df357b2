#include "render/camera_pass.hpp"

#include <algorithm>
#include <chrono>

#include "render/photon_pass.hpp"
#include "render/sequences.hpp"

namespace vitrum {
namespace {

constexpr double seconds_per_launch = 0.1;

}  // namespace

struct CameraPass::State {
  KernelContext context;
  bool first_hits;
  uint32_t pixels, film_stride;
  uint32_t samples_per_launch;
  Buffer<float> film;
  Buffer<uint32_t> counts;
  Buffer<kernel::CameraSample> samples;
  cl::Kernel kernel;
  uint64_t camera_rays = 0;

  State(const KernelContext& c, bool with_first_hits)
      : context(c), first_hits(with_first_hits), samples_per_launch(std::max(c.launches.samples, 1u)) {
    Device& device = context.device;
    pixels = static_cast<uint32_t>(context.scene.film.width) * static_cast<uint32_t>(context.scene.film.height);
    film_stride = padded(pixels);
    film = device.allocate<float>(size_t{FILM_PLANES} * film_stride, "film");
    device.fill_zero(film);
    counts = device.allocate<uint32_t>(COUNTS, "film");
    device.fill_zero(counts);
    kernel = context.kernels.get("camera");
  }

  /// What samples [first, first + count) of a replicate have in common over all pixels.
  std::vector<kernel::CameraSample> sample_points(uint32_t replicate, uint32_t first, uint32_t count) const {
    const RenderSettings& settings = context.scene.render;
    const bool independent = settings.sampling == Sampling::independent;
    std::vector<kernel::CameraSample> points;
    for (uint32_t sample = first; sample < first + count; ++sample) {
      // Low-discrepancy: all samples of a replicate share the shifts of their pixels and go on in one sequence.
      const uint64_t key = mix_bits(mix_bits(settings.seed, replicate), independent ? sample + 1 : 0);
      const std::array<float, 2> jitter = independent ? std::array<float, 2>{} : r2_point(sample);
      points.push_back({static_cast<uint32_t>(key >> 32), jitter[0], jitter[1], jitter[0], jitter[1],
                        independent ? 0.0f : golden_point(sample)});
    }
    return points;
  }

  /// Samples [first, last) of those in the buffer, of pixels from `first_pixel` on.
  void launch(uint32_t first, uint32_t last, bool jitter, uint32_t first_pixel, uint32_t last_pixel,
              const PhotonMap* map) {
    const Scene& scene = context.scene;
    unsigned next = context.device_scene.set_arguments(kernel);
    set_arguments(kernel, next, context.device_scene.camera, samples, first, last, uint32_t{jitter}, first_pixel,
                  last_pixel, static_cast<uint32_t>(scene.render.max_depth), static_cast<float>(scene.render.min_weight),
                  context.data.eye_index, context.data.eye_media, static_cast<uint32_t>(scene.lights.size()),
                  uint32_t{first_hits});
    next += 13;
    if (context.features.caustics) next = set_map_arguments(kernel, next, *map, scene);
    set_arguments(kernel, next, film_stride, film, counts);
    context.device.launch("camera", kernel, context.packets(last_pixel - first_pixel));
    camera_rays += uint64_t{last - first} * (last_pixel - first_pixel);
  }
};

CameraPass::CameraPass(const KernelContext& context, bool first_hits) : state_(new State(context, first_hits)) {}
CameraPass::~CameraPass() = default;

void CameraPass::run(uint32_t replicate, uint32_t first, uint32_t count, uint32_t total, const PhotonMap* map,
                     const std::function<void(double)>& progress) {
  State& s = *state_;
  const std::vector<kernel::CameraSample> points = s.sample_points(replicate, first, count);
  if (s.samples.size() < points.size()) s.samples = s.context.device.allocate<kernel::CameraSample>(points.size(), "film");
  s.context.device.write(s.samples, points);
  const Launches& launches = s.context.launches;
  for (uint32_t done = 0; done < count;) {
    const uint32_t last = std::min(count, done + s.samples_per_launch);
    double longest = 0.0;
    const uint32_t tiles = (s.pixels + launches.pixels - 1) / launches.pixels;
    for (uint32_t tile = 0; tile < tiles; ++tile) {
      const auto start = std::chrono::steady_clock::now();
      const uint32_t pixel = (launches.last_pixels_first ? tiles - 1 - tile : tile) * launches.pixels;
      const uint32_t last_pixel = std::min(s.pixels, pixel + launches.pixels);
      s.launch(done, last, total > 1, pixel, last_pixel, map);
      s.context.device.finish();
      progress((done + (tile + 1.0) / tiles * (last - done)) / count);
      longest = std::max(longest, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    done = last;
    if (launches.samples > 0) continue;
    // What a launch holds changes nothing but its time.
    if (2.0 * longest < seconds_per_launch) s.samples_per_launch = std::min(2 * s.samples_per_launch, 64u);
    if (longest > 2.0 * seconds_per_launch) s.samples_per_launch = std::max(s.samples_per_launch / 2, 1u);
  }
}

std::vector<float> CameraPass::take_film() {
  State& s = *state_;
  const std::vector<float> padded_planes = s.context.device.read(s.film, 0, s.film.size());
  s.context.device.fill_zero(s.film);
  std::vector<float> planes(size_t{FILM_PLANES} * s.pixels);
  for (size_t plane = 0; plane < FILM_PLANES; ++plane)
    std::copy_n(padded_planes.begin() + static_cast<std::ptrdiff_t>(plane * s.film_stride), s.pixels,
                planes.begin() + static_cast<std::ptrdiff_t>(plane * s.pixels));
  return planes;
}

CameraCounts CameraPass::counts() const {
  const std::vector<uint32_t> halves = state_->context.device.read(state_->counts, 0, COUNTS);
  const auto whole = [&halves](size_t i) { return uint64_t{halves[i + 1]} << 32 | halves[i]; };
  return {state_->camera_rays, whole(COUNT_SECONDARY), whole(COUNT_SHADOW), whole(COUNT_GATHERED), whole(COUNT_PAIRS)};
}

}  // namespace vitrum
