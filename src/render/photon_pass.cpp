#include "render/photon_pass.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

#include "render/photon_grid.hpp"
#include "render/photon_tree.hpp"
#include "render/sequences.hpp"

namespace vitrum {
namespace {

constexpr double seconds_per_launch = 0.1;    // so that progress can be told

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
  Buffer<kernel::SequenceData> sequences;
  cl::Kernel kernel;
  uint32_t runs_per_launch = 64;
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
    sequences = device.allocate<kernel::SequenceData>(PHOTON_DIMENSIONS, "lights");
    kernel = context.kernels.get("photons");
    // A GPU wants many work-items.
    map.run_length = device.info().is_cpu ? 1024 : 64;
  }

  /// Makes room for all that a pass of `runs` runs stores, unsorted and then sorted in the same place.
  void make_room(uint64_t runs) {
    Device& device = context.device;
    const uint64_t room = std::max<uint64_t>(kernel::photon_in_run(map.run_length, static_cast<uint32_t>(runs), 0),
                                             uint64_t{PHOTON_FIELDS} * padded(runs * map.run_length + 8));
    if (map.photons.size() < room) map.photons = device.allocate<float>(room, "photon map");
    if (map.runs.size() < runs) map.runs = device.allocate<kernel::PhotonRunData>(runs, "photon map");
  }

  /// Shoots photons [first, first + count) of a pair and books what became of them. Their runs follow those before.
  void shoot(const Pair& pair, uint32_t number, uint32_t replicate, uint64_t first, uint32_t count, double share) {
    Device& device = context.device;
    const kernel::LightData& light = context.data.lights[pair.light];
    const auto dimensions = photon_sequences(context.scene.photons.sampling, context.scene.render.seed, replicate,
                                             number, first, light.kind > LIGHT_DIRECTIONAL);
    device.write(sequences, std::vector<kernel::SequenceData>(dimensions.begin(), dimensions.end()));
    const uint32_t runs = (count + map.run_length - 1) / map.run_length;
    const uint32_t first_run = static_cast<uint32_t>(map.stored_by_run.size());
    const unsigned next = context.device_scene.set_arguments(kernel);
    set_arguments(kernel, next, light.kind == LIGHT_DIRECTIONAL ? casters_of_directional : context.device_scene.casters,
                  static_cast<uint32_t>(context.data.casters.size()), sequences, pair.light, pair.caster,
                  static_cast<float>(share), pair.upstream, count, map.run_length, first_run,
                  static_cast<uint32_t>(context.scene.photons.max_depth), map.photons, map.runs);
    device.launch_singly("photons", kernel, runs);
    for (const kernel::PhotonRunData& run : device.read(map.runs, first_run, runs)) book(run);
  }

  void book(const kernel::PhotonRunData& run) {
    auto watts = [&run](uint32_t outcome) { return to_spectrum(run.power[outcome]) + to_spectrum(run.power_rest[outcome]); };
    balance.shot += watts(OUTCOME_ALIVE);
    balance.stored += watts(OUTCOME_STORED);
    balance.absorbed += watts(OUTCOME_ABSORBED);
    balance.direct += watts(OUTCOME_DIRECT);
    balance.lost += watts(OUTCOME_LOST);
    balance.cut += watts(OUTCOME_CUT);
    balance.not_aimed -= watts(OUTCOME_ALIVE);
    balance.photons_shot += run.photons[OUTCOME_ALIVE];
    balance.photons_stored += run.photons[OUTCOME_STORED];
    balance.photons_absorbed += run.photons[OUTCOME_ABSORBED];
    balance.photons_direct += run.photons[OUTCOME_DIRECT];
    balance.photons_lost += run.photons[OUTCOME_LOST];
    balance.photons_cut += run.photons[OUTCOME_CUT];
    balance.surfaces_met += run.surfaces;
    map.stored_by_run.push_back(run.photons[OUTCOME_STORED]);
    map.count += run.photons[OUTCOME_STORED];
  }
};

PhotonPass::PhotonPass(const KernelContext& context, uint64_t largest_pass)
    : state_(new State(context, largest_pass)) {}
PhotonPass::~PhotonPass() = default;

uint64_t PhotonPass::capacity(const Device& device) {
  // The largest array is that of the unsorted photons; half of the memory may go to the map.
  const uint64_t by_allocation = device.info().max_allocation / sizeof(cl_float8);
  const uint64_t by_memory = device.info().memory / 2 / (2 * sizeof(cl_float8));
  return std::min<uint64_t>(std::min(by_allocation, by_memory) / 16 * 15, 1u << 30);
}

void PhotonPass::run(uint32_t replicate, uint64_t before, uint64_t count,
                     const std::function<void(double)>& progress) {
  State& s = *state_;
  assert(count <= s.capacity);
  s.map.count = 0;
  s.map.stride = 0;
  s.map.stored_by_run.clear();

  double flux = 0.0;
  for (const Pair& pair : s.pairs) flux += pair.flux;
  const auto share_of = [flux](const Pair& pair, uint64_t photons) {
    return static_cast<uint64_t>(std::llround(pair.flux / flux * static_cast<double>(photons)));
  };
  uint64_t runs = 0;
  for (const Pair& pair : s.pairs) runs += std::max<uint64_t>(1, share_of(pair, count)) / s.map.run_length + 1;
  s.make_room(runs);

  for (const kernel::LightData& light : s.context.data.lights)
    s.balance.not_aimed += total_power(s.context.data, light);
  uint64_t emitted = 0;
  for (uint32_t p = 0; p < s.pairs.size(); ++p) {
    const Pair& pair = s.pairs[p];
    const uint64_t n = std::max<uint64_t>(1, share_of(pair, count));
    const uint64_t n_before = before == 0 ? 0 : share_of(pair, before);
    for (uint64_t first = 0; first < n;) {
      const auto start = std::chrono::steady_clock::now();
      const uint32_t in_launch =
          static_cast<uint32_t>(std::min<uint64_t>(uint64_t{s.runs_per_launch} * s.map.run_length, n - first));
      s.shoot(pair, p, replicate, n_before + first, in_launch, 1.0 / static_cast<double>(n));
      first += in_launch;
      emitted += in_launch;
      progress(static_cast<double>(emitted) / static_cast<double>(count));
      // What a launch holds changes nothing but its time.
      const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      if (2.0 * seconds < seconds_per_launch)
        s.runs_per_launch = std::min(2 * s.runs_per_launch, 1u << 14);
      else if (seconds > 2.0 * seconds_per_launch)
        s.runs_per_launch = std::max(s.runs_per_launch / 2, 8u);
    }
  }
  if (s.grid)
    s.grid->sort(s.map);
  else
    fill_photon_tree(s.context.device, s.map, s.context.scene.photons.max_radius);
}

const PhotonMap& PhotonPass::map() const { return state_->map; }
const PhotonBalance& PhotonPass::balance() const { return state_->balance; }

std::vector<cl_float8> read_photons(Device& device, const PhotonMap& map) {
  std::vector<cl_float8> photons;
  const auto append = [&](size_t first, size_t stride, size_t count) {
    const size_t before = photons.size();
    photons.resize(before + count, cl_float8{});
    for (size_t field = 0; field < PHOTON_FIELDS; ++field) {
      const std::vector<float> values = device.read(map.photons, first + field * stride, count);
      for (size_t i = 0; i < count; ++i) photons[before + i].s[field] = values[i];
    }
  };
  if (map.stride > 0) {
    append(0, map.stride, map.count);
  } else {
    for (uint32_t run = 0; run < map.stored_by_run.size(); ++run)
      append(kernel::photon_in_run(map.run_length, run, 0), map.run_length + RUN_MARGIN, map.stored_by_run[run]);
  }
  return photons;
}

unsigned set_map_arguments(cl::Kernel& kernel, unsigned first, const PhotonMap& map, const Scene& scene) {
  if (scene.photons.estimate == PhotonEstimate::nearest) {
    set_arguments(kernel, first, map.count, static_cast<uint32_t>(scene.photons.nearest), map.radius, map.tree, map.nodes,
                  map.leaves);
    return first + 6;
  }
  const cl_float4 low = {{map.low[0], map.low[1], map.low[2], 0}};
  const cl_float4 high = {{map.high[0], map.high[1], map.high[2], 0}};
  set_arguments(kernel, first, map.count, map.grid, map.radius, low, high, map.stride, map.first_of_cell, map.photons);
  return first + 8;
}

}  // namespace vitrum
