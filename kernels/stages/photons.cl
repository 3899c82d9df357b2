// Stage photons: a pair of light and caster shoots photons, which are followed to their end.
// Reads: the scene, the casters, the sequences. Writes: for each run of photons its stored ones, its PhotonRunData, and how
// many of them are in each bucket of the grid; where patches are drawn, where the points of the lattice landed.
// A work-item minds one run: WIDTH photons at a time, in registers from the light to where they end. The few that go
// other ways than most wait until they fill a packet of their own, so that lanes rarely idle.
#include "emission.h"
#include "footprint.h"
#include "photon_map.h"
#include "photon_step.h"
#include "trace.h"

FUNCTION float least_of_lanes(const Float values) {
  float least = LANE(values, float, 0);
  for (uint lane = 1; lane < WIDTH; ++lane) least = min(least, LANE(values, float, lane));
  return least;
}

FUNCTION void total_of_lanes(const Float sum, const Float rest, __global float* total, __global float* total_rest) {
  float all = 0.0f;
  float lost = 0.0f;
  for (uint lane = 0; lane < WIDTH; ++lane) {
    lost += LANE(rest, float, lane);
    const float corrected = LANE(sum, float, lane) + lost;
    const float next = all + corrected;
    lost = corrected - (next - all);
    all = next;
  }
  *total = all;
  *total_rest = lost;
}

// Photons `first` to `first + WIDTH` of the sequences.
FUNCTION Photons emitted(const Scene scene, __global const LightData* light, __global const CasterData* casters,
                         const uint n_casters, const uint caster, __global const SequenceData* sequences,
                         const float share, const float upstream, const LatticeData lattice, const uint first, Aim* aim,
                         int* aimed) {
  Float u_light = 0.0f;
  Float v_light = 0.0f;
  Uint face = 0;
#if LIGHT_KINDS & ~((1 << LIGHT_POINT) | (1 << LIGHT_DIRECTIONAL))
  u_light = sequence_float(&sequences[3], first);
  v_light = sequence_float(&sequences[4], first);
  face = face_of_light(scene, light, sequence_float(&sequences[5], first));
#endif
  const LightPoint from = point_on_light(scene, light, u_light, v_light, face);
  // From a point, all aim alike.
  if (!*aimed) *aim = aim_at(&casters[caster], from, light->kind == LIGHT_POINT);
  *aimed = light->kind == LIGHT_POINT || light->kind == LIGHT_DIRECTIONAL;

  Float u[2];
  u[0] = sequence_float(&sequences[0], first);
  u[1] = sequence_float(&sequences[1], first);
  Float weight = 1.0f;
#if HAS_PATCHES
  const Uint point = LANES + first;
  if (lattice.columns > 0) weight = lattice_point(lattice, point, u);
#endif
  const Emission emission = emit(light, casters, n_casters, caster, from, aim, u, upstream);
  Photons photons;
  photons.origin = emission.origin;
  photons.direction = emission.direction;
  photons.power = scale3(share * weight, emission.power);
  photons.t_min = light->clearance;
  photons.stack = light->media;
  photons.from = light->shape;
  photons.path = sequence_bits(&sequences[2], first);
  photons.history = 0;
#if HAS_PATCHES
  photons.point = lattice.columns > 0 ? point : (Uint)NO_POINT;
  photons.branch_point = NO_POINT;
  if (lattice.columns > 0) {
    const LatticePlace at = place_on_lattice(lattice, point);
    const Uint odd = (at.column | at.row) & ((1u << BRANCH_LOG2) - 1u);
    const Uint branch = ((at.column >> BRANCH_LOG2) << (lattice.log2_rows - BRANCH_LOG2)) + (at.row >> BRANCH_LOG2);
    photons.branch_point = odd == 0 ? lattice_points(lattice) + branch : (Uint)NO_POINT;
  }
  photons.way = 0;
  photons.spacing = 1.0f;
#endif
  photons.alive = (Mask)-1;
  return photons;
}

// Are place, power and direction finite?
FUNCTION Mask are_numbers(const Photons* photons, const Vec3 arrived) {
  const Vec3 sum = add3(add3(photons->origin, photons->power), arrived);
  return fabs(sum.x + sum.y + sum.z) < INFINITY;
}

#if HAS_PATCHES
// Notes where photons of the lattice arrived, for their neighbours.
FUNCTION void note_landings(const Photons* photons, const Mask which, __global float* landings) {
  FOR_LANES(lane, which & (photons->point != NO_POINT)) {
    const float4 arrival = (float4)(LANE3(photons->origin, lane), as_float(LANE(photons->way, uint, lane)));
    const float4 brought = (float4)(LANE3(photons->power, lane), 0.0f);
    vstore8(joined4(arrival, brought), LANE(photons->point, uint, lane), landings);
  }
}
#endif

// Adds the lanes of `which` to the run's photons, of which there are `stored`. `fields`: the run's piece of the buffer.
FUNCTION void store_photons(const Photons* photons, const SurfacePacket* surface, const Vec3 arrived, const Mask which,
                            const GridData grid, const uint run_length, const uint stored, __global float* fields) {
  Float values[RUN_FIELDS];
  values[PHOTON_X] = photons->origin.x;
  values[PHOTON_Y] = photons->origin.y;
  values[PHOTON_Z] = photons->origin.z;
  values[PHOTON_DIRECTION] = AS_FLOAT(packed_direction(arrived));
  values[PHOTON_POWER + 0] = photons->power.x;
  values[PHOTON_POWER + 1] = photons->power.y;
  values[PHOTON_POWER + 2] = photons->power.z;
#if HAS_PATCHES
  const Vec3 normal = select3(surface->entering, surface->geometric_normal, negate3(surface->geometric_normal));
  values[ARRIVED_POINT] = AS_FLOAT(photons->point);
  values[ARRIVED_NORMAL + 0] = normal.x;
  values[ARRIVED_NORMAL + 1] = normal.y;
  values[ARRIVED_NORMAL + 2] = normal.z;
  values[ARRIVED_SPACING] = photons->spacing;
#endif
  values[RUN_CELL] = AS_FLOAT(cells_of(grid, photons->origin));
  __global float* to = fields + stored;
  const uint stride = photons_stride(run_length);
#if PACKS_LANES
  for (uint field = 0; field < RUN_FIELDS; ++field) pack_lanes(which, values[field], to + field * stride);
#else
  FOR_LANES(lane, which) {
    for (uint field = 0; field < RUN_FIELDS; ++field) to[field * stride] = LANE(values[field], float, lane);
    ++to;
  }
#endif
}

// Photons [first, last) of the sequences, a run. `fields`: its piece of the buffer; `counts`: its photons by bucket.
BODY follow_run(const Scene scene, __global const LightData* light, __global const CasterData* casters,
                const uint n_casters, const uint caster, __global const SequenceData* sequences, const float share,
                const float upstream, const LatticeData lattice, const uint first, const uint last, const uint run_length,
                const uint max_depth, const GridData grid, const uint buckets, __global float* restrict landings,
                __global float* restrict fields, __global uint* restrict counts,
                __global PhotonRunData* restrict report) {
  Tally power[TALLIES];
  Uint ended[TALLIES];
  for (uint k = 0; k < TALLIES; ++k) {
    power[k].sum = power[k].rest = make_vec3(0.0f, 0.0f, 0.0f);
    ended[k] = 0;
  }
  const uint n_branch_points = branch_points(lattice);
  uint surfaces = 0;
  uint stored = 0;
  uint n_branched = 0;
  uint rejected = 0;
  Vec3 low = make_vec3(INFINITY, INFINITY, INFINITY);
  Vec3 high = negate3(low);
  // Those outside of all media and those inside wait apart, since they meet different surfaces.
  Waiting waiting[2];
  waiting[0].count = waiting[1].count = 0;
#ifdef CLEAR_DEAD_LANES
  // A packet that is not full takes its dead lanes from behind those that wait.
  for (uint queue = 0; queue < 2; ++queue)
    for (uint field = 0; field < WAITING_FIELDS; ++field)
      for (uint k = 0; k < WAITING_ROOM; ++k) waiting[queue].fields[field][k] = 0.0f;
#endif
  Aim aim;
  int aimed = 0;
  uint next = first;
  while (next < last || waiting[0].count > 0 || waiting[1].count > 0) {
    Photons photons;
    const uint fuller = waiting[1].count >= waiting[0].count;
    if (waiting[fuller].count >= WIDTH || next >= last) {
      photons = take_waiting(&waiting[fuller]);
    } else {
      photons = emitted(scene, light, casters, n_casters, caster, sequences, share, upstream, lattice, next, &aim, &aimed);
      photons.alive = lanes_below(next, last);
#if HAS_PATCHES
      // A way that no photon has, until it arrives; its place is read, but counts for nothing.
      FOR_LANES(lane, photons.alive & (photons.point != NO_POINT)) {
        vstore8((float8)(0.0f), LANE(photons.point, uint, lane), landings);
      }
      FOR_LANES(lane, photons.alive & (photons.branch_point != NO_POINT)) {
        const uint branch = LANE(photons.branch_point, uint, lane);
        vstore8((float8)(0.0f), branch, landings);
        vstore8((float8)(0.0f), branch + n_branch_points, landings);
      }
#endif
      add_power(&power[OUTCOME_ALIVE], photons.alive, photons.power);
      next += WIDTH;
    }
    uint n_alive;
    // While many are alike, they go on together.
    do {
      RayPacket packet;
      packet.origin = photons.origin;
      packet.direction = photons.direction;
      packet.t_min = photons.t_min;
      packet.t_max = INFINITY;
      const SurfacePacket surface = trace(scene, packet, photons.from, photons.alive, 0, &photons.stack);
      const Vec3 arrived = photons.direction;
      surfaces += lanes_set(photons.alive);
      const Uint outcome = interact(scene, &surface, max_depth, waiting, n_branch_points, &photons, &n_branched,
                                    &power[OUTCOME_ABSORBED], &power[TALLY_SPLIT]);
      for (uint k = OUTCOME_ALIVE + 1; k < OUTCOMES; ++k) {
        Mask here = outcome == k;
        if (!ANY(here)) continue;
        if (k == OUTCOME_STORED) {
          const Mask sound = here & are_numbers(&photons, arrived);
          rejected += lanes_set(here & (sound == 0));
          here = sound;
        }
        add_power(&power[k], here, photons.power);
        ended[k] += here ? (Uint)1 : (Uint)0;
        if (k == OUTCOME_STORED) {
#if HAS_PATCHES
          note_landings(&photons, here, landings);
#endif
          store_photons(&photons, &surface, arrived, here, grid, run_length, stored, fields);
          stored += lanes_set(here);
          low = smaller3(select3(here, photons.origin, low), low);
          high = larger3(select3(here, photons.origin, high), high);
        }
      }
      // The fewer step aside, and all of them when few are left.
      Mask inside = photons.alive & (photons.stack != 0);
      Mask outside = photons.alive & (photons.stack == 0);
      const uint n_inside = lanes_set(inside);
      const uint n_outside = lanes_set(outside);
      n_alive = max(n_inside, n_outside);
      if (n_alive > WIDTH / 2) {
        photons.alive = n_inside >= n_outside ? inside : outside;
        inside = n_inside >= n_outside ? (Mask)0 : inside;
        outside = n_inside >= n_outside ? outside : (Mask)0;
      }
      wait_in(&waiting[0], &photons, outside);
      wait_in(&waiting[1], &photons, inside);
    } while (n_alive > WIDTH / 2);
  }

#if defined(CLEAR_DEAD_LANES) && HAS_PATCHES
  // Those who read the run take whole packets.
  for (uint lane = 0; lane < WIDTH; ++lane)
    for (uint field = 0; field < RUN_FIELDS; ++field) fields[field * photons_stride(run_length) + stored + lane] = 0.0f;
#endif
  for (uint k = 0; k < TALLIES; ++k) {
    total_of_lanes(power[k].sum.x, power[k].rest.x, &report->power[k][0], &report->power_rest[k][0]);
    total_of_lanes(power[k].sum.y, power[k].rest.y, &report->power[k][1], &report->power_rest[k][1]);
    total_of_lanes(power[k].sum.z, power[k].rest.z, &report->power[k][2], &report->power_rest[k][2]);
    uint photons_ended = 0;
    for (uint lane = 0; lane < WIDTH; ++lane) photons_ended += LANE(ended[k], uint, lane);
    report->photons[k] = photons_ended;
  }
  report->photons[OUTCOME_ALIVE] = last - first;
  report->photons[TALLY_SPLIT] = n_branched;
  report->surfaces = surfaces;
  report->rejected = rejected;
  report->low[0] = least_of_lanes(low.x);
  report->low[1] = least_of_lanes(low.y);
  report->low[2] = least_of_lanes(low.z);
  report->high[0] = -least_of_lanes(-high.x);
  report->high[1] = -least_of_lanes(-high.y);
  report->high[2] = -least_of_lanes(-high.z);

#if CAUSTICS != CAUSTICS_FOOTPRINTS
  for (uint bucket = 0; bucket < buckets; ++bucket) counts[bucket] = 0;
  __global const float* cells = fields + RUN_CELL * photons_stride(run_length);
  for (uint i = 0; i < stored; ++i) ++counts[as_uint(cells[i]) >> grid.bucket_shift];
#endif
}

// The first `count` photons of the sequences, `run_length` to a run. `share`: of the pair's power for each photon;
// `upstream`: see emission.h. landings: where patches are drawn, room for each point of the lattice.
KERNEL void photons(SCENE_PARAMETERS, __global const CasterData* casters, const uint n_casters,
                    __global const SequenceData* sequences, const uint light_index, const uint caster,
                    const float share, const float upstream, const LatticeData lattice, const uint count,
                    const uint run_length, const uint max_depth, const GridData grid, const uint buckets,
                    __global float* landings, __global float* photons, __global uint* counts,
                    __global PhotonRunData* reports) {
  const uint run = get_global_id(0);
  const uint first = run * run_length;
  if (first >= count) return;
  const Scene scene = SCENE;
  follow_run(scene, &scene.lights[light_index], casters, n_casters, caster, sequences, share, upstream, lattice, first,
             min(first + run_length, count), run_length, max_depth, grid, buckets, landings,
             photons + photon_in_run(run_length, run, 0, RUN_ROW), counts + run * buckets, &reports[run]);
}
