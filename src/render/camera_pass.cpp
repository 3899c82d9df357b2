#include "render/camera_pass.hpp"

#include <algorithm>
#include <chrono>
#include <numeric>

#include "render/patch_view.hpp"
#include "render/photon_pass.hpp"
#include "render/sequences.hpp"

namespace vitrum {
namespace {

constexpr double seconds_per_launch = 0.1;

}  // namespace

SampleCounts SampleCounts::uniform(uint32_t pixels, uint32_t samples) {
  SampleCounts counts;
  counts.pixel_of_slot.resize(pixels);
  std::iota(counts.pixel_of_slot.begin(), counts.pixel_of_slot.end(), 0u);
  counts.of_group.assign((pixels + SLOT_GROUP - 1) / SLOT_GROUP, samples);
  return counts;
}

SampleCounts SampleCounts::of(std::span<const uint32_t> wanted) {
  SampleCounts counts = uniform(static_cast<uint32_t>(wanted.size()), 1);
  std::stable_sort(counts.pixel_of_slot.begin(), counts.pixel_of_slot.end(),
                   [&wanted](uint32_t a, uint32_t b) { return wanted[a] > wanted[b]; });
  for (size_t group = 0; group < counts.of_group.size(); ++group)
    counts.of_group[group] = wanted[counts.pixel_of_slot[group * SLOT_GROUP]];
  return counts;
}

uint64_t SampleCounts::total() const {
  uint64_t sum = 0;
  for (size_t slot = 0; slot < pixel_of_slot.size(); ++slot) sum += in_slot(slot);
  return sum;
}

struct CameraPass::State {
  KernelContext context;
  bool first_hits;
  uint32_t pixels, film_stride;
  uint32_t samples_per_launch;
  SampleCounts allotted;
  bool is_only = false;
  uint32_t touched = 0;         ///< slots that have samples in the film
  Buffer<float> film;
  Buffer<uint32_t> counts, pixel_of_slot, of_group;
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
    pixel_of_slot = device.allocate<uint32_t>(film_stride, "film");
    device.fill_zero(pixel_of_slot);
    of_group = device.allocate<uint32_t>((pixels + SLOT_GROUP - 1) / SLOT_GROUP, "film");
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

  /// Slots whose pixels have more samples than `first`.
  uint32_t slots_beyond(uint32_t first) const {
    const auto end = std::partition_point(allotted.of_group.begin(), allotted.of_group.end(),
                                          [first](uint32_t count) { return count > first; });
    return std::min(pixels, static_cast<uint32_t>(end - allotted.of_group.begin()) * SLOT_GROUP);
  }

  /// Samples [first, last) of the pixels in slots [first_slot, last_slot).
  void launch(uint32_t part, uint32_t first, uint32_t last, uint32_t first_slot, uint32_t last_slot, const PhotonMap* map,
              const PatchView* patches) {
    const Scene& scene = context.scene;
    unsigned next = context.device_scene.set_arguments(kernel);
    set_arguments(kernel, next, context.device_scene.camera, samples, pixel_of_slot, of_group, part, first, last,
                  uint32_t{!is_only}, first_slot, last_slot, static_cast<uint32_t>(scene.render.max_depth),
                  static_cast<float>(scene.render.min_weight), context.data.eye_index, context.data.eye_media,
                  static_cast<uint32_t>(scene.lights.size()), uint32_t{first_hits});
    next += 16;
    if (context.features.caustics) next = set_map_arguments(kernel, next, *map, scene);
    if (patches) next = patches->set_arguments_of(kernel, next);
    set_arguments(kernel, next, film_stride, film, counts);
    context.device.launch("camera", kernel, context.device.packets(last_slot - first_slot));
  }
};

CameraPass::CameraPass(const KernelContext& context, bool first_hits) : state_(new State(context, first_hits)) {}
CameraPass::~CameraPass() = default;

void CameraPass::start(uint32_t replicate, uint32_t first, SampleCounts counts, uint32_t parts, bool is_only) {
  State& s = *state_;
  Device& device = s.context.device;
  s.is_only = is_only;
  const std::vector<kernel::CameraSample> points = s.sample_points(replicate, first, parts * counts.most());
  if (s.samples.size() < points.size()) s.samples = device.allocate<kernel::CameraSample>(points.size(), "film");
  device.write(s.samples, points);
  if (s.allotted.pixel_of_slot != counts.pixel_of_slot) device.write(s.pixel_of_slot, counts.pixel_of_slot);
  if (s.allotted.of_group != counts.of_group) device.write(s.of_group, counts.of_group);
  s.allotted = std::move(counts);
}

void CameraPass::run(uint32_t part, uint32_t first, uint32_t last, const PhotonMap* map, const PatchView* patches,
                     const std::function<void(double)>& progress) {
  State& s = *state_;
  const Launches& launches = s.context.launches;
  for (uint32_t done = first; done < last;) {
    const uint32_t slots = s.slots_beyond(done);
    s.touched = std::max(s.touched, slots);
    const uint32_t until = std::min(last, done + s.samples_per_launch);
    double longest = 0.0;
    const uint32_t tiles = (slots + launches.pixels - 1) / launches.pixels;
    for (uint32_t tile = 0; tile < tiles; ++tile) {
      const auto start = std::chrono::steady_clock::now();
      const uint32_t slot = (launches.last_pixels_first ? tiles - 1 - tile : tile) * launches.pixels;
      s.launch(part, done, until, slot, std::min(slots, slot + launches.pixels), map, patches);
      s.context.device.finish();
      progress((done - first + (tile + 1.0) / tiles * (until - done)) / (last - first));
      longest = std::max(longest, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    for (uint32_t sample = done; sample < until; ++sample) s.camera_rays += s.slots_beyond(sample);
    done = until;
    if (launches.samples > 0) continue;
    // What a launch holds changes nothing but its time.
    if (2.0 * longest < seconds_per_launch) s.samples_per_launch = std::min(2 * s.samples_per_launch, 64u);
    if (longest > 2.0 * seconds_per_launch) s.samples_per_launch = std::max(s.samples_per_launch / 2, 1u);
  }
}

std::vector<float> CameraPass::take_film() {
  State& s = *state_;
  std::vector<float> planes(size_t{FILM_PLANES} * s.pixels, 0.0f);
  const std::vector<uint32_t>& pixel_of_slot = s.allotted.pixel_of_slot;
  for (size_t plane = 0; plane < FILM_PLANES; ++plane) {
    const std::vector<float> slots = s.context.device.read(s.film, plane * s.film_stride, s.touched);
    for (size_t slot = 0; slot < slots.size(); ++slot) planes[plane * s.pixels + pixel_of_slot[slot]] = slots[slot];
  }
  s.context.device.fill_zero(s.film);
  s.touched = 0;
  return planes;
}

CameraCounts CameraPass::counts() const {
  const std::vector<uint32_t> halves = state_->context.device.read(state_->counts, 0, COUNTS);
  const auto whole = [&halves](size_t i) { return uint64_t{halves[i + 1]} << 32 | halves[i]; };
  return {state_->camera_rays, whole(COUNT_SECONDARY), whole(COUNT_SHADOW), whole(COUNT_GATHERED), whole(COUNT_PAIRS)};
}

}  // namespace vitrum
