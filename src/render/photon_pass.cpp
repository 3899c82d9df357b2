#include "render/photon_pass.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "render/patch_view.hpp"
#include "render/photon_grid.hpp"
#include "render/photon_tree.hpp"
#include "render/sequences.hpp"

namespace vitrum {
namespace {

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

/// Photons of a lattice that the device has room for.
uint64_t most_on_lattice(const Device& device) {
  return std::min(device.info().max_allocation / (4 * ARRIVED_ROW * sizeof(float)), largest_lattice);
}

}  // namespace

struct PhotonPass::State {
  KernelContext context;
  uint64_t room = 0;            // photons of a pass
  std::vector<Pair> pairs;
  double flux = 0.0;            // of all pairs
  Buffer<kernel::CasterData> casters_of_directional;  // none of them unbounded
  Buffer<kernel::SequenceData> sequences;
  cl::Kernel kernel;
  PhotonRuns runs;
  uint32_t most_runs = 0;       // of a launch
  PhotonBalance balance;
  PhotonGrid grid;
  PhotonMap tree;               // instead of the grid where the k nearest are gathered

  explicit State(const KernelContext& c) : context(c), grid(c) {
    Device& device = context.device;
    const SceneData& data = context.data;
    std::vector<kernel::CasterData> bounded = data.casters;
    for (kernel::CasterData& caster : bounded)
      if (std::isinf(caster.radius)) caster.radius = static_cast<float>(data.radius);
    casters_of_directional = device.upload(bounded, "lights");
    for (uint32_t l = 0; l < data.lights.size(); ++l)
      for (uint32_t k = 0; k < data.casters.size(); ++k) {
        const bool directional = data.lights[l].kind == LIGHT_DIRECTIONAL;
        const double pair_flux = aimed_flux(data, data.lights[l], directional ? bounded[k] : data.casters[k]);
        const double upstream =
            2.0 * data.radius + glm::distance(data.centre, to_spectrum(bounded[k].centre)) + bounded[k].radius;
        if (!(pair_flux > 0.0)) continue;
        pairs.push_back({l, k, static_cast<float>(upstream), pair_flux});
        flux += pair_flux;
      }
    sequences = device.allocate<kernel::SequenceData>(PHOTON_DIMENSIONS, "lights");
    kernel = context.kernels.get("photons");
    // A GPU wants many work-items.
    runs.length = device.info().is_cpu ? 1024 : 64;
    runs.row = context.features.patches ? ARRIVED_ROW : PHOTON_ROW;
  }

  /// Makes room for passes of `count` photons.
  void reserve(uint64_t count) {
    if (count <= room) return;
    room = count;
    Device& device = context.device;
    // A lattice wants all of its photons at once.
    const bool lattices = context.features.patches;
    const uint64_t on_lattice = std::min(room, most_on_lattice(device));
    const uint64_t at_once = std::max<uint64_t>({lattices ? on_lattice : 0, context.launches.photons, pilot_size(room)});
    const auto needed = static_cast<uint32_t>((at_once + runs.length - 1) / runs.length);
    if (runs.landings.size() == 0 || lattices)
      runs.landings = device.allocate<float>(lattices ? LANDING_ROW * (on_lattice + on_lattice / 2) : 1, "photons in flight");
    if (needed <= most_runs) return;
    most_runs = needed;
    runs.photons = device.allocate<float>(kernel::photon_in_run(runs.length, most_runs, 0, runs.row), "photons in flight");
    runs.on_device = device.allocate<kernel::PhotonRunData>(most_runs, "photons in flight");
  }

  /// A pair's share of `count` photons.
  uint64_t share(const Pair& pair, uint64_t count) const {
    return static_cast<uint64_t>(std::llround(pair.flux / flux * static_cast<double>(count)));
  }

  /// The lattice of about `n` photons of a pair in a pass; none for lights with an area, independent photons, or so few that
  /// all would be at its edge.
  kernel::LatticeData lattice_of(uint32_t number, uint64_t pass, uint32_t replicate, uint64_t n) const {
    if (!context.features.patches || n < 64 || context.scene.photons.sampling == Sampling::independent ||
        context.data.lights[pairs[number].light].kind > LIGHT_DIRECTIONAL)
      return {};
    const auto log2_rows = static_cast<uint32_t>(std::lround(0.5 * std::log2(static_cast<double>(n))));
    // Of each replicate by itself, and from pass to pass evenly.
    const uint64_t key = mix_bits(mix_bits(context.scene.render.seed, replicate), number);
    const std::array<float, 2> step = r2_point(pass);
    const auto shift = [&](uint32_t axis) {
      const float start = static_cast<float>(mix_bits(key, axis) >> 40) * 0x1p-24f;
      return start + step[axis] - std::floor(start + step[axis]);
    };
    return {static_cast<uint32_t>(n >> log2_rows), log2_rows, shift(0), shift(1)};
  }

  /// Shoots photons [first, first + count) of pair `number`, each with the fraction `power` of its power, and leaves
  /// them in `runs`, in cells of `cells`. They are on `lattice` if it has columns.
  void shoot(uint32_t number, uint32_t replicate, uint64_t first, uint32_t count, double power,
             const kernel::GridData& cells, uint32_t buckets, const kernel::LatticeData& lattice) {
    Device& device = context.device;
    const Pair& pair = pairs[number];
    const kernel::LightData& light = context.data.lights[pair.light];
    const auto dimensions = photon_sequences(context.scene.photons.sampling, context.scene.render.seed, replicate,
                                             number, first, light.kind > LIGHT_DIRECTIONAL);
    device.write(sequences, std::vector<kernel::SequenceData>(dimensions.begin(), dimensions.end()));
    const uint32_t n_runs = (count + runs.length - 1) / runs.length;
    const size_t n_counts = size_t{most_runs} * buckets;
    if (runs.counts.size() < n_counts) runs.counts = device.allocate<uint32_t>(n_counts, "photons in flight");
    const unsigned next = context.device_scene.set_arguments(kernel);
    set_arguments(kernel, next, light.kind == LIGHT_DIRECTIONAL ? casters_of_directional : context.device_scene.casters,
                  static_cast<uint32_t>(context.data.casters.size()), sequences, pair.light, pair.caster,
                  static_cast<float>(power), pair.upstream, lattice, count, runs.length,
                  static_cast<uint32_t>(context.scene.photons.max_depth), cells, buckets, runs.landings, runs.photons,
                  runs.counts, runs.on_device);
    device.launch_singly("photons", kernel, n_runs);
    runs.reports = device.read(runs.on_device, 0, n_runs);
  }

  /// Chooses the grid for a pass by a few photons of each pair, which are not counted.
  void start_grid(const PhotonPassPlan& plan) {
    const uint64_t count = plan.count, pilot = pilot_size(count);
    std::vector<std::vector<glm::vec3>> places;
    std::vector<double> stored;                 // of each pair in the pass
    for (uint32_t p = 0; p < pairs.size(); ++p) {
      const uint64_t n = std::max<uint64_t>(1, share(pairs[p], count));
      const uint32_t shot = static_cast<uint32_t>(std::min(n, pilot));
      shoot(p, plan.replicate, 0, shot, 1.0 / static_cast<double>(n), {}, 1, {});
      places.emplace_back();
      for (const cl_float8& photon : photons_of_runs()) places.back().push_back({photon.s[0], photon.s[1], photon.s[2]});
      // Their order hangs on the device's width, which the radius must not: a random one, by where they are.
      const auto rank = [](const glm::vec3& place) {
        const auto bits = [](float x) { return uint64_t{std::bit_cast<uint32_t>(x)}; };
        return mix_bits(mix_bits(bits(place.x), bits(place.y)), bits(place.z));
      };
      std::sort(places.back().begin(), places.back().end(),
                [&rank](const glm::vec3& a, const glm::vec3& b) { return rank(a) < rank(b); });
      stored.push_back(static_cast<double>(places.back().size()) / shot * static_cast<double>(n));
    }
    // As many of each pair's as is its share of what is stored.
    const double expected = std::accumulate(stored.begin(), stored.end(), 0.0);
    std::vector<glm::vec3> sample;
    for (size_t p = 0; p < pairs.size() && expected > 0.0; ++p) {
      const auto wanted = static_cast<size_t>(std::llround(static_cast<double>(pilot) * stored[p] / expected));
      const size_t taken = std::min(wanted, places[p].size());
      sample.insert(sample.end(), places[p].begin(), places[p].begin() + static_cast<std::ptrdiff_t>(taken));
    }
    grid.start(sample, static_cast<uint64_t>(expected), plan);
  }

  /// What the last launch stored.
  std::vector<cl_float8> photons_of_runs() const {
    const uint32_t n_runs = static_cast<uint32_t>(runs.reports.size());
    const std::vector<float> fields =
        context.device.read(runs.photons, 0, kernel::photon_in_run(runs.length, n_runs, 0, runs.row));
    std::vector<cl_float8> photons;
    for (uint32_t run = 0; run < n_runs; ++run)
      for (uint32_t i = 0; i < runs.reports[run].photons[OUTCOME_STORED]; ++i) {
        cl_float8 photon{};
        for (uint32_t field = 0; field < PHOTON_FIELDS; ++field)
          photon.s[field] = fields[kernel::photon_in_run(runs.length, run, field, runs.row) + i];
        photons.push_back(photon);
      }
    return photons;
  }

  /// Emits the photons of a pass, those of lights and casters that have one on lattices or not, pair by pair. After each launch
  /// `take()` finds them in `runs`.
  template <typename Take>
  void emit(const PhotonPassPlan& plan, bool on_lattices, const Take& take) {
    const uint32_t buckets = context.features.nearest_photons ? 1 : grid.buckets();
    for (uint32_t p = 0; p < pairs.size(); ++p) {
      const uint64_t wanted = std::max<uint64_t>(1, share(pairs[p], plan.count));
      const uint64_t n_before = plan.before == 0 ? 0 : share(pairs[p], plan.before);
      // As many lattices of one size as memory wants.
      const uint64_t most = most_on_lattice(context.device), lattices = (wanted + most - 1) / most;
      const auto lattice = [&](uint64_t k) {
        if (!on_lattices) return kernel::LatticeData{};
        return lattice_of(p, plan.pass * lattices + k, plan.replicate, wanted / lattices);
      };
      runs.lattice = lattice(0);
      const uint64_t on_lattice = uint64_t{runs.lattice.columns} << runs.lattice.log2_rows;
      const uint64_t n = on_lattice > 0 ? lattices * on_lattice : wanted;
      const uint64_t most_in_launch = on_lattice > 0 ? on_lattice : context.launches.photons;
      for (uint64_t first = 0; first < n;) {
        if (on_lattice > 0) runs.lattice = lattice(first / on_lattice);
        const uint32_t in_launch = static_cast<uint32_t>(std::min<uint64_t>(most_in_launch, n - first));
        shoot(p, plan.replicate, n_before + first, in_launch, 1.0 / static_cast<double>(n), grid.grid(), buckets, runs.lattice);
        take();
        first += in_launch;
      }
    }
  }

  /// A pass; `maps`: into the map. Returns false if the view could not take it.
  bool run(const PhotonPassPlan& plan, PatchView* view, bool maps, const std::function<void(double)>& progress) {
    const bool nearest = context.features.nearest_photons, footprints = context.features.footprints;
    if (!nearest) start_grid(plan);
    for (const kernel::LightData& light : context.data.lights) balance.not_aimed += total_power(context.data, light);
    // What is gathered within a radius wants photons of its own, of equal power: of those on lattices the few that branch off
    // have much of it. They are then those that are told of.
    const bool twice = view && maps && !footprints;
    uint64_t emitted = 0;
    const auto tell = [&] {
      for (const kernel::PhotonRunData& run : runs.reports) emitted += run.photons[OUTCOME_ALIVE];
      progress(static_cast<double>(emitted) / static_cast<double>(plan.count * (twice ? 2 : 1)));
    };
    bool is_whole = true;
    if (view || footprints) {
      if (view) view->start();
      emit(plan, true, [&] {
        for (const kernel::PhotonRunData& run : runs.reports)
          if (twice) balance.surfaces_met += run.surfaces;
          else book(run);
        if (view) is_whole &= view->add(runs, grid.footprint_limits());
        if (maps && footprints) grid.add(runs);
        tell();
      });
    }
    if (maps && !footprints) {
      std::vector<cl_float8> photons;  // for the tree
      emit(plan, false, [&] {
        for (const kernel::PhotonRunData& run : runs.reports) book(run);
        if (nearest) {
          const std::vector<cl_float8> stored = photons_of_runs();
          photons.insert(photons.end(), stored.begin(), stored.end());
        } else {
          grid.add(runs);
        }
        tell();
      });
      if (nearest) fill_photon_tree(context.device, tree, photons, context.scene.photons.max_radius);
    }
    if (maps && !nearest) grid.finish();
    return is_whole;
  }

  void book(const kernel::PhotonRunData& run) {
    auto watts = [&run](uint32_t outcome) { return to_spectrum(run.power[outcome]) + to_spectrum(run.power_rest[outcome]); };
    balance.shot += watts(OUTCOME_ALIVE);
    balance.stored += watts(OUTCOME_STORED);
    balance.absorbed += watts(OUTCOME_ABSORBED);
    balance.direct += watts(OUTCOME_DIRECT);
    balance.lost += watts(OUTCOME_LOST);
    balance.cut += watts(OUTCOME_CUT);
    balance.split += watts(TALLY_SPLIT);
    balance.not_aimed -= watts(OUTCOME_ALIVE);
    balance.photons_shot += run.photons[OUTCOME_ALIVE];
    balance.photons_stored += run.photons[OUTCOME_STORED];
    balance.photons_absorbed += run.photons[OUTCOME_ABSORBED];
    balance.photons_direct += run.photons[OUTCOME_DIRECT];
    balance.photons_lost += run.photons[OUTCOME_LOST];
    balance.photons_cut += run.photons[OUTCOME_CUT];
    balance.photons_branched += run.photons[TALLY_SPLIT];
    balance.photons_rejected += run.rejected;
    balance.surfaces_met += run.surfaces;
  }
};

PhotonPass::PhotonPass(const KernelContext& context) : state_(new State(context)) {}
PhotonPass::~PhotonPass() = default;

uint64_t PhotonPass::capacity(const Device& device, const Features& features) {
  // Of footprints a pass has one lattice, since smaller ones are what more photons are for.
  if (features.footprints) return most_on_lattice(device);
  // A photon takes a row of one array, with some to spare; half of the memory may go to it. Offsets in it fit 32 bits.
  constexpr double row = largest_row_share * PHOTON_ROW * sizeof(float);
  const double bytes = static_cast<double>(std::min(device.info().max_allocation, device.info().memory / 2));
  return std::min<uint64_t>(static_cast<uint64_t>(bytes / row), 1u << 28);
}

void PhotonPass::run(const PhotonPassPlan& plan, PatchView* view, bool wants_map,
                     const std::function<void(double)>& progress) {
  State& s = *state_;
  s.reserve(plan.count);
  const PhotonBalance before = s.balance;
  const bool maps = wants_map || !view || !view->is_all();
  if (s.run(plan, view, maps, progress)) return;
  view->give_up();
  if (maps) return;
  s.balance = before;
  s.run(plan, nullptr, true, progress);
}

const PhotonMap& PhotonPass::map() const {
  return state_->context.features.nearest_photons ? state_->tree : state_->grid.map();
}
const PhotonBalance& PhotonPass::balance() const { return state_->balance; }

std::vector<cl_float8> read_photons(Device& device, const PhotonMap& map) {
  std::vector<cl_float8> photons;
  // `stride`: between the fields of a photon.
  const auto append = [&photons, &map](const float* fields, size_t stride) {
    cl_float8 photon{};
    for (size_t field = 0; field < PHOTON_FIELDS; ++field) photon.s[field] = fields[field * stride];
    if (map.fields == FOOTPRINT_FIELDS) {
      if (std::bit_cast<uint32_t>(fields[FOOTPRINT_FLAGS * stride]) & IN_OTHER_CELL) return;
      const auto vector = [&](size_t field) {
        return glm::vec3(fields[field * stride], fields[(field + 1) * stride], fields[(field + 2) * stride]);
      };
      const float area = 1.0f / glm::length(glm::cross(vector(FOOTPRINT_U), vector(FOOTPRINT_V)));
      for (size_t channel = 0; channel < 3; ++channel) photon.s[PHOTON_POWER + channel] *= area;
    }
    photons.push_back(photon);
  };
  if (map.leaves.size() > 0) {
    const std::vector<float> leaves = device.read(map.leaves, 0, map.leaves.size());
    for (size_t i = 0; i < map.count; ++i) append(&leaves[i / 8 * PHOTON_FIELDS * 8 + i % 8], 8);
  } else {
    const std::vector<kernel::BucketData> buckets = device.read(map.buckets, 0, map.bucket_counts.size());
    for (size_t b = 0; b < buckets.size(); ++b) {
      const uint32_t count = map.bucket_counts[b];
      const std::vector<float> fields =
          device.read(map.photons, size_t{buckets[b].start} * MAP_BLOCK, kernel::map_floats(count, map.fields));
      for (uint32_t i = 0; i < count; ++i) append(&fields[kernel::map_place(i, 0, map.fields)], MAP_BLOCK);
    }
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
  set_arguments(kernel, first, map.count, map.grid, map.radius, low, high, map.first_of_cell, map.buckets, map.photons);
  return first + 8;
}

}  // namespace vitrum
