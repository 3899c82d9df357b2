#include "render/camera_pass.hpp"

#include <algorithm>
#include <deque>

#include "render/photon_pass.hpp"
#include "render/sequences.hpp"

namespace vitrum {
namespace {

constexpr uint32_t batch_size = 1u << 15;           // rays in flight: their state fits a CPU's caches
constexpr uint32_t queue_size = 4 * batch_size;     // rays that wait in one generation
const uint32_t queue_stride = padded(queue_size);   // of all arrays of rays, so that a batch can lie anywhere in a queue

}  // namespace

struct CameraPass::State {
  /// Rays of one generation that wait to be traced.
  struct Generation {
    Buffer<float> rays;
    uint32_t count = 0;
  };

  KernelContext context;
  bool first_hits;
  uint32_t pixels, film_stride;
  Buffer<float> film;
  Buffer<float> surfaces, shares, scatter, children;
  Buffer<uint32_t> counts, totals;
  std::deque<Generation> generations;  // references to earlier ones stay good as it grows
  cl::Kernel generate, trace_exact, trace_mesh, shade, direct, gather, count_children, scan, append, film_add,
      film_add_runs, film_add_first_hits;
  RayCounts rays_traced;
  // Of the sample at hand.
  const PhotonMap* map = nullptr;
  std::array<float, 3> light_offsets{};
  uint32_t first_pixel = 0;

  State(const KernelContext& c, bool with_first_hits) : context(c), first_hits(with_first_hits) {
    Device& device = context.device;
    pixels = static_cast<uint32_t>(context.scene.film.width) * static_cast<uint32_t>(context.scene.film.height);
    film_stride = padded(pixels);
    film = device.allocate<float>(size_t{FILM_PLANES} * film_stride, "film");
    device.fill_zero(film);
    auto in_flight = [&](size_t fields) { return device.allocate<float>(fields * queue_stride, "camera rays"); };
    surfaces = in_flight(SURFACE_FIELDS);
    shares = in_flight(SHARE_FIELDS);
    scatter = in_flight(SCATTER_FIELDS);
    children = in_flight(CHILD_FIELDS);
    counts = device.allocate<uint32_t>(batch_size / block_size, "camera rays");
    totals = device.allocate<uint32_t>(1, "camera rays");
    generations.push_back({in_flight(RAY_FIELDS), 0});

    const Programs& programs = context.programs;
    const Features& features = context.features;
    generate = programs.kernel("camera_generate", "camera_generate");
    trace_exact = programs.kernel("trace", "trace_exact");
    if (features.mesh) trace_mesh = programs.kernel("trace", "trace_mesh");
    shade = programs.kernel("camera_shade", "camera_shade");
    if (features.lights) direct = programs.kernel("direct_light", "direct_light");
    const char* gather_name = features.nearest_photons ? "gather_nearest" : "gather";
    if (features.caustics) gather = programs.kernel(gather_name, gather_name);
    count_children = programs.kernel("camera_queue", "camera_count");
    scan = programs.kernel("camera_queue", "scan_blocks");
    append = programs.kernel("camera_queue", "camera_append");
    film_add = programs.kernel("film", "film_add");
    film_add_runs = programs.kernel("film", "film_add_runs");
    film_add_first_hits = programs.kernel("film", "film_add_first_hits");
  }

  /// Adds the caustic on the surfaces that `count` rays meet.
  void gather_photons(uint32_t count) {
    if (context.features.nearest_photons) {
      set_arguments(gather, 0, count, queue_stride, static_cast<uint32_t>(context.scene.photons.nearest), map->radius,
                    map->tree, map->nodes, map->leaves, surfaces, scatter, shares);
    } else {
      const cl_float4 low = {{map->low[0], map->low[1], map->low[2], 0}};
      const cl_float4 high = {{map->high[0], map->high[1], map->high[2], 0}};
      set_arguments(gather, 0, count, queue_stride, map->grid, map->radius, low, high, map->stride, map->first_of_cell,
                    map->sorted, surfaces, scatter, shares);
    }
    context.device.launch("gather", gather, count);
  }

  /// Traces and shades `count` rays of a generation; their children join the next one, which has room for them.
  void process(uint32_t depth, const Buffer<float>& rays, uint32_t count) {
    Device& device = context.device;
    const Scene& scene = context.scene;
    const DeviceScene& on_device = context.device_scene;
    set_arguments(trace_exact, on_device.set_arguments(trace_exact), count, queue_stride, rays, surfaces);
    device.launch("camera", trace_exact, context.packets(count));
    if (context.features.mesh) {
      set_arguments(trace_mesh, on_device.set_arguments(trace_mesh), count, queue_stride, rays, surfaces);
      device.launch("camera", trace_mesh, count);
    }
    set_arguments(shade, on_device.set_arguments(shade), count, queue_stride, depth,
                  static_cast<uint32_t>(scene.render.max_depth), static_cast<float>(scene.render.min_weight),
                  context.data.eye_index, rays, surfaces, shares, scatter, children);
    device.launch("camera", shade, context.packets(count));
    if (context.features.lights)
      for (uint32_t light = 0; light < scene.lights.size(); ++light) {
        set_arguments(direct, on_device.set_arguments(direct), count, queue_stride, light, light_offsets[0], light_offsets[1],
                      light_offsets[2], rays, surfaces, scatter, shares);
        device.launch("camera", direct, context.packets(count));
        rays_traced.shadow += count;
      }
    if (map != nullptr && map->count > 0) gather_photons(count);
    if (depth == 0) {
      rays_traced.camera += count;
      set_arguments(film_add, 0, count, queue_stride, first_pixel, film_stride, shares, film);
      device.launch("camera", film_add, context.packets(count));
      if (first_hits) {
        set_arguments(film_add_first_hits, 0, count, queue_stride, first_pixel, film_stride, on_device.materials, surfaces,
                      scatter, film);
        device.launch("camera", film_add_first_hits, count);
      }
    } else {
      rays_traced.secondary += count;
      set_arguments(film_add_runs, 0, count, queue_stride, film_stride, rays, shares, film);
      device.launch("camera", film_add_runs, count);
    }
    if (depth + 1 < static_cast<uint32_t>(scene.render.max_depth)) append_children(depth, rays, count);
  }

  void append_children(uint32_t depth, const Buffer<float>& rays, uint32_t count) {
    Device& device = context.device;
    const uint32_t blocks = (count + block_size - 1) / block_size;
    set_arguments(count_children, 0, count, queue_stride, children, counts);
    device.launch_singly("camera", count_children, blocks);
    set_arguments(scan, 0, blocks, uint32_t{1}, counts, totals);
    device.launch_singly("camera", scan, 1);
    const uint32_t born = device.read(totals, 0, 1)[0];
    if (born == 0) return;
    if (generations.size() == depth + 1)
      generations.push_back({device.allocate<float>(size_t{RAY_FIELDS} * queue_stride, "camera rays"), 0});
    Generation& next = generations[depth + 1];
    set_arguments(append, 0, count, queue_stride, rays, surfaces, children, counts, next.count, queue_stride, next.rays);
    device.launch_singly("camera", append, blocks);
    next.count += born;
  }

  /// Makes room for the children of a batch in generation `depth`.
  void make_room(uint32_t depth) {
    if (depth < generations.size() && generations[depth].count + 2 * batch_size > queue_size) flush(depth);
  }

  /// Processes all rays that wait in generation `depth` and, as room is needed, in later ones.
  void flush(uint32_t depth) {
    const uint32_t waiting = generations[depth].count;
    for (uint32_t first = 0; first < waiting; first += batch_size) {
      make_room(depth + 1);
      process(depth, context.device.tail(generations[depth].rays, first), std::min(batch_size, waiting - first));
    }
    generations[depth].count = 0;
  }
};

CameraPass::CameraPass(const KernelContext& context, bool first_hits) : state_(new State(context, first_hits)) {}
CameraPass::~CameraPass() = default;

void CameraPass::run(uint32_t replicate, uint32_t first, uint32_t count, uint32_t total, const PhotonMap* map,
                     const std::function<void(double)>& progress) {
  State& s = *state_;
  const RenderSettings& settings = s.context.scene.render;
  const bool independent = settings.sampling == Sampling::independent;
  s.map = map;
  for (uint32_t sample = first; sample < first + count; ++sample) {
    // Low-discrepancy: all samples of a replicate share the shifts of their pixels and go on in one sequence.
    const uint64_t key = mix_bits(mix_bits(settings.seed, replicate), independent ? sample + 1 : 0);
    const uint32_t path_seed = static_cast<uint32_t>(key >> 32);
    const std::array<float, 2> jitter = independent ? std::array<float, 2>{} : r2_point(sample);
    s.light_offsets = {jitter[0], jitter[1], independent ? 0.0f : golden_point(sample)};
    for (s.first_pixel = 0; s.first_pixel < s.pixels; s.first_pixel += batch_size) {
      const uint32_t in_batch = std::min(batch_size, s.pixels - s.first_pixel);
      s.make_room(1);
      set_arguments(s.generate, 0, s.context.device_scene.camera, s.first_pixel, in_batch, queue_stride,
                    uint32_t{total > 1}, path_seed, s.context.data.eye_media, jitter[0], jitter[1],
                    s.generations[0].rays);
      s.context.device.launch("camera", s.generate, s.context.packets(in_batch));
      s.process(0, s.generations[0].rays, in_batch);
      progress((sample - first + static_cast<double>(s.first_pixel + in_batch) / s.pixels) / count);
    }
    // A pixel's rays must stand together, so no generation holds rays of two samples.
    for (uint32_t depth = 1; depth < s.generations.size(); ++depth)
      if (s.generations[depth].count > 0) s.flush(depth);
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

const RayCounts& CameraPass::counts() const { return state_->rays_traced; }

}  // namespace vitrum
