#include "render/photon_pass.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "render/photon_grid.hpp"
#include "render/photon_tree.hpp"
#include "render/sequences.hpp"

namespace vitrum {
namespace {

constexpr uint32_t chunk_size = 1u << 16;     // photons in flight: their state fits a CPU's caches
const uint32_t chunk_stride = padded(chunk_size);
const uint32_t survivors_stride = padded(2 * chunk_size);
// Sums of kernels/stages/photon_store.cl: power by outcome and absorbed by media (3 each), photons by outcome, surfaces.
constexpr uint32_t sum_photons = OUTCOMES * 3 + 3;
constexpr uint32_t sum_surfaces = sum_photons + OUTCOMES;
constexpr uint32_t sums_per_block = sum_surfaces + 1;
constexpr double units_per_photon = 0x1p25;   // of fixed-point power, for a photon of mean power

Spectrum to_spectrum(const float* values) { return {values[0], values[1], values[2]}; }

/// Power that a light sends out in all [W]; infinite for a directional light.
Spectrum total_power(const SceneData& data, const kernel::LightData& light) {
  using std::numbers::pi;
  if (light.kind == LIGHT_POINT) return 4.0 * pi * to_spectrum(light.emitted);
  if (light.kind == LIGHT_DIRECTIONAL) return Spectrum(std::numeric_limits<double>::infinity());
  if (light.kind != LIGHT_MESH) return pi * static_cast<double>(light.area) * to_spectrum(light.emitted);
  Spectrum power(0.0);
  for (uint32_t i = 0; i < light.face_count; ++i) {
    const kernel::LightFace& face = data.faces[light.first_face + i];
    const kernel::TriangleData& t = data.triangles[face.triangle];
    auto corner = [&](int k) {
      const float* p = &data.positions[3 * t.position[k]];
      return glm::dvec3(p[0], p[1], p[2]);
    };
    power += 0.5 * pi * glm::length(glm::cross(corner(1) - corner(0), corner(2) - corner(0))) * to_spectrum(face.radiance);
  }
  return power;
}

/// A light and a caster that it can reach, with its share of the photons.
struct Pair {
  uint32_t light, caster;
  float upstream;               // how far before the caster a directional light's photons start [m]
  double flux;                  // about [W]: shares are made by it
};

/// Power that the light sends towards the caster's bound, to share photons out by: exact for point and directional
/// lights, seen from the middle of the light for others.
double aimed_flux(const SceneData& data, const kernel::LightData& light, const kernel::CasterData& caster) {
  using std::numbers::pi;
  const Spectrum emitted = to_spectrum(light.emitted);
  const double r = caster.radius;
  if (light.kind == LIGHT_DIRECTIONAL) return pi * r * r * (emitted.x + emitted.y + emitted.z);
  const Spectrum all = total_power(data, light);
  const double power = all.x + all.y + all.z;
  glm::dvec3 place = to_spectrum(light.position);
  if (light.kind == LIGHT_QUAD) place += 0.5 * (to_spectrum(light.u) + to_spectrum(light.v));
  if (light.kind == LIGHT_MESH) return power;
  const double d = glm::distance(place, to_spectrum(caster.centre));
  if (!(d > r)) return power;
  const double fraction = 0.5 * (1.0 - std::sqrt(1.0 - r * r / (d * d)));
  return power * fraction * (light.kind == LIGHT_POINT ? 1.0 : 2.0);
}

}  // namespace

struct PhotonPass::State {
  KernelContext context;
  uint64_t capacity;
  std::vector<Pair> pairs;
  Buffer<kernel::CasterData> casters_of_directional;  // none of them unbounded
  Buffer<float> chunk, survivors, surfaces, absorbed;
  Buffer<uint32_t> outcomes, counts, totals;
  Buffer<uint64_t> sums, sum_totals;
  Buffer<kernel::SequenceData> sequences;
  cl::Kernel emit, trace_exact, trace_mesh, interact, tally, scan, total, append, move_back;
  uint32_t waiting = 0;         // survivors
  double watts_per_unit = 0.0;
  PhotonMap map;
  PhotonBalance balance;
  std::unique_ptr<PhotonGrid> grid;  // unless the k nearest are gathered

  State(const KernelContext& c, uint64_t largest) : context(c), capacity(largest) {
    if (!context.features.nearest_photons) grid = std::make_unique<PhotonGrid>(context);
    Device& device = context.device;
    const SceneData& data = context.data;
    std::vector<kernel::CasterData> bounded = data.casters;
    for (kernel::CasterData& caster : bounded)
      if (std::isinf(caster.radius)) caster.radius = static_cast<float>(data.radius);
    casters_of_directional = device.upload(bounded, "lights");
    for (uint32_t l = 0; l < data.lights.size(); ++l)
      for (uint32_t k = 0; k < data.casters.size(); ++k) {
        const bool directional = data.lights[l].kind == LIGHT_DIRECTIONAL;
        const double flux = aimed_flux(data, data.lights[l], directional ? bounded[k] : data.casters[k]);
        const double upstream =
            2.0 * data.radius + glm::distance(data.centre, to_spectrum(bounded[k].centre)) + bounded[k].radius;
        if (flux > 0.0) pairs.push_back({l, k, static_cast<float>(upstream), flux});
      }

    chunk = device.allocate<float>(size_t{RAY_FIELDS} * chunk_stride, "photons in flight");
    survivors = device.allocate<float>(size_t{RAY_FIELDS} * survivors_stride, "photons in flight");
    surfaces = device.allocate<float>(context.features.mesh ? size_t{SURFACE_FIELDS} * chunk_stride : 1, "photons in flight");
    absorbed = device.allocate<float>(context.features.absorption ? size_t{3} * chunk_stride : 1, "photons in flight");
    outcomes = device.allocate<uint32_t>(chunk_stride, "photons in flight");
    counts = device.allocate<uint32_t>(2 * chunk_size / block_size, "photons in flight");
    totals = device.allocate<uint32_t>(2, "photons in flight");
    sums = device.allocate<uint64_t>(size_t{sums_per_block} * chunk_size / block_size, "photons in flight");
    sum_totals = device.allocate<uint64_t>(sums_per_block, "photons in flight");
    sequences = device.allocate<kernel::SequenceData>(PHOTON_DIMENSIONS, "photons in flight");

    const Programs& programs = context.programs;
    emit = programs.kernel("photon_emit", "photon_emit");
    trace_exact = programs.kernel("trace", "trace_exact");
    if (context.features.mesh) trace_mesh = programs.kernel("trace", "trace_mesh");
    interact = programs.kernel("photon_interact", "photon_interact");
    tally = programs.kernel("photon_store", "photon_tally");
    scan = programs.kernel("photon_store", "scan_blocks");
    total = programs.kernel("photon_store", "photon_totals");
    append = programs.kernel("photon_store", "photon_append");
    move_back = programs.kernel("photon_store", "photon_move");
  }

  /// Emits `count` photons of a pair into the chunk, from its sequence's photon `first` on.
  void emit_chunk(const Pair& pair, uint32_t number, uint32_t replicate, uint64_t first, uint32_t count, double share) {
    Device& device = context.device;
    const kernel::LightData& light = context.data.lights[pair.light];
    const auto dimensions = photon_sequences(context.scene.photons.sampling, context.scene.render.seed, replicate,
                                             number, first, light.kind > LIGHT_DIRECTIONAL);
    device.write(sequences, std::vector<kernel::SequenceData>(dimensions.begin(), dimensions.end()));
    const unsigned next = context.device_scene.set_arguments(emit);
    set_arguments(emit, next,
                  light.kind == LIGHT_DIRECTIONAL ? casters_of_directional : context.device_scene.casters,
                  static_cast<uint32_t>(context.data.casters.size()), sequences, pair.light, pair.caster,
                  static_cast<float>(share), pair.upstream, count, chunk_stride, chunk, outcomes);
    device.launch("emit", emit, context.packets(count));
  }

  /// Counts photons and adds up their power by outcome; that of the living only where they have just been `shot`.
  void add_up(const Buffer<float>& rays, uint32_t count, bool shot) {
    Device& device = context.device;
    const uint32_t blocks = (count + block_size - 1) / block_size;
    const uint32_t absorbs = context.features.absorption && !shot;
    set_arguments(tally, 0, count, chunk_stride, static_cast<float>(1.0 / watts_per_unit), rays, outcomes, absorbed, absorbs,
                  uint32_t{shot}, counts, sums);
    device.launch_singly("store", tally, blocks);
    set_arguments(scan, 0, blocks, uint32_t{2}, counts, totals);
    device.launch_singly("store", scan, 1);
    set_arguments(total, 0, blocks, sums, sum_totals);
    device.launch_singly("store", total, sums_per_block);
  }

  /// Follows `count` photons in `rays` until few are left, which join the survivors.
  void follow(const Buffer<float>& rays, uint32_t count) {
    Device& device = context.device;
    const uint32_t blocks = (count + block_size - 1) / block_size;
    const uint32_t max_depth = static_cast<uint32_t>(context.scene.photons.max_depth);
    for (uint32_t alive = count; alive > 0;) {
      if (context.features.mesh) {
        set_arguments(trace_exact, context.device_scene.set_arguments(trace_exact), count, chunk_stride, rays, surfaces);
        device.launch("trace", trace_exact, context.packets(count));
        set_arguments(trace_mesh, context.device_scene.set_arguments(trace_mesh), count, chunk_stride, rays, surfaces);
        device.launch("trace", trace_mesh, count);
      }
      set_arguments(interact, context.device_scene.set_arguments(interact), count, chunk_stride, max_depth, surfaces, rays,
                    outcomes, absorbed);
      device.launch("trace", interact, context.packets(count));
      add_up(rays, count, false);
      const std::vector<uint32_t> n = device.read(totals, 0, 2);
      alive = n[1];
      // The living stay in their places while they are many; a few would leave most lanes idle.
      const uint32_t move = alive < count / 2;
      set_arguments(append, 0, count, chunk_stride, rays, outcomes, counts, map.count, map.photons, move, waiting,
                    survivors_stride, survivors);
      device.launch_singly("store", append, blocks);
      map.count += n[0];
      if (move) {
        waiting += alive;
        return;
      }
    }
  }

  /// Takes the last of the survivors, a chunk of them at most, and follows them.
  void follow_survivors() {
    const uint32_t taken = std::min(waiting, chunk_size);
    waiting -= taken;
    // They are moved to the chunk, since more may join the survivors meanwhile.
    set_arguments(move_back, 0, taken, survivors_stride, waiting, survivors, chunk_stride, chunk, outcomes);
    context.device.launch("store", move_back, taken);
    follow(chunk, taken);
  }
};

PhotonPass::PhotonPass(const KernelContext& context, uint64_t largest_pass)
    : state_(new State(context, largest_pass)) {}
PhotonPass::~PhotonPass() = default;

uint64_t PhotonPass::capacity(const Device& device) {
  // The largest array is that of the unsorted photons; half of the memory may go to the map.
  const uint64_t by_allocation = device.info().max_allocation / sizeof(cl_float8);
  const uint64_t by_memory = device.info().memory / 2 / (2 * sizeof(cl_float8) + PHOTON_FIELDS * sizeof(float));
  return std::min<uint64_t>(std::min(by_allocation, by_memory), 1u << 30);
}

void PhotonPass::run(uint32_t replicate, uint64_t before, uint64_t count,
                     const std::function<void(double)>& progress) {
  State& s = *state_;
  Device& device = s.context.device;
  assert(count <= s.capacity);
  s.map.count = 0;
  s.waiting = 0;
  // No more photons are stored than are emitted; a chunk's worth of room is left for rounding up shares.
  const uint64_t room = count + s.pairs.size();
  if (s.map.photons.size() < room) s.map.photons = device.allocate<cl_float8>(room, "photon map");

  double flux = 0.0;
  for (const Pair& pair : s.pairs) flux += pair.flux;
  // Photons carry about flux / count; those that carry more are counted all the same, by more units.
  s.watts_per_unit = std::max(flux / static_cast<double>(std::max<uint64_t>(count, 1)), 1e-30) / units_per_photon;
  device.fill_zero(s.sum_totals);

  uint64_t emitted = 0;
  for (uint32_t p = 0; p < s.pairs.size(); ++p) {
    const Pair& pair = s.pairs[p];
    const double fraction = pair.flux / flux;
    const uint64_t n = std::max<uint64_t>(1, static_cast<uint64_t>(std::llround(fraction * static_cast<double>(count))));
    const uint64_t n_before = before == 0 ? 0 : static_cast<uint64_t>(std::llround(fraction * static_cast<double>(before)));
    for (uint64_t first = 0; first < n; first += chunk_size) {
      const uint32_t in_chunk = static_cast<uint32_t>(std::min<uint64_t>(chunk_size, n - first));
      s.emit_chunk(pair, p, replicate, n_before + first, in_chunk, 1.0 / static_cast<double>(n));
      s.add_up(s.chunk, in_chunk, true);
      s.follow(s.chunk, in_chunk);
      while (s.waiting >= chunk_size) s.follow_survivors();
      emitted += in_chunk;
      progress(static_cast<double>(emitted) / static_cast<double>(count));
    }
  }
  while (s.waiting > 0) s.follow_survivors();

  const std::vector<uint64_t> sums = device.read(s.sum_totals, 0, sums_per_block);
  auto watts = [&](uint32_t outcome) {
    return s.watts_per_unit * Spectrum(static_cast<double>(sums[3 * outcome]), static_cast<double>(sums[3 * outcome + 1]),
                                       static_cast<double>(sums[3 * outcome + 2]));
  };
  s.balance.stored += watts(OUTCOME_STORED);
  s.balance.absorbed += watts(OUTCOME_ABSORBED) + watts(OUTCOMES);
  s.balance.direct += watts(OUTCOME_DIRECT);
  s.balance.lost += watts(OUTCOME_LOST);
  s.balance.cut += watts(OUTCOME_CUT);
  s.balance.shot += watts(OUTCOME_ALIVE);
  for (const kernel::LightData& light : s.context.data.lights)
    s.balance.not_aimed += total_power(s.context.data, light);
  s.balance.not_aimed -= watts(OUTCOME_ALIVE);
  s.balance.photons_shot += emitted;
  s.balance.photons_stored += sums[sum_photons + OUTCOME_STORED];
  s.balance.photons_absorbed += sums[sum_photons + OUTCOME_ABSORBED];
  s.balance.photons_direct += sums[sum_photons + OUTCOME_DIRECT];
  s.balance.photons_lost += sums[sum_photons + OUTCOME_LOST];
  s.balance.photons_cut += sums[sum_photons + OUTCOME_CUT];
  s.balance.surfaces_met += sums[sum_surfaces];
  if (s.grid)
    s.grid->sort(s.map);
  else
    fill_photon_tree(device, s.map, s.context.scene.photons.max_radius);
}

const PhotonMap& PhotonPass::map() const { return state_->map; }
const PhotonBalance& PhotonPass::balance() const { return state_->balance; }

}  // namespace vitrum
