// Stage photon_store: takes what ended out of a queue of photons: power by outcome is added up, the stored go to the
// photon map, the living, when they have become few, to the next queue. Everything keeps its order.
#include "queue.h"
#include "blocks.h"
#include "outcome.h"
#include "photon_map.h"

// Sums of a block: power by outcome (3 each), power absorbed by media (3), photons by outcome, surfaces that those met.
#define SUM_ABSORBED (OUTCOMES * 3)
#define SUM_PHOTONS (SUM_ABSORBED + 3)
#define SUM_SURFACES (SUM_PHOTONS + OUTCOMES)
#define SUMS (SUM_SURFACES + 1)

// Power as fixed point. 32 bits, which convert fast, hold a photon of 2^7 times the mean power; beside a large light a
// few carry more.
FUNCTION Ulong fixed_point(const Float power, const Mask which, const float per_unit) {
  const Float units = which ? fma(power, (Float)per_unit, (Float)0.5f) : 0.0f;
  return ANY(units >= 4e9f) ? TO_ULONG(units) : TO_ULONG(TO_UINT(units));
}

// Adds power to one outcome's three sums.
FUNCTION void add_power(const Vec3 power, const Mask which, const float per_unit, Ulong* sums) {
  sums[0] += fixed_point(power.x, which, per_unit);
  sums[1] += fixed_point(power.y, which, per_unit);
  sums[2] += fixed_point(power.z, which, per_unit);
}

FUNCTION ulong sum_of_lanes(const Ulong sums) {
  ulong sum = 0;
  for (uint lane = 0; lane < WIDTH; ++lane) sum += LANE(sums, ulong, lane);
  return sum;
}

// Counts what is stored and what is alive in each block, and adds up power by outcome: fixed point, `per_unit` units to
// the watt, so that sums are exact and the order does not matter. The living are added up only where they have just
// been shot. sums: [block][SUMS].
__kernel void photon_tally(const uint count, const uint stride, const float per_unit, __global const float* rays,
                           __global const uint* outcomes, __global const float* absorbed, const uint absorbs,
                           const uint shot, __global uint* counts, __global ulong* sums) {
  const uint block = get_global_id(0);
  const uint first = block * BLOCK;
  if (first >= count) return;
  const uint last = min(first + BLOCK, count);
  Uint stored = 0;
  Uint alive = 0;
  Ulong sum[SUMS];
  for (uint k = 0; k < SUMS; ++k) sum[k] = 0;
  for (uint i = first; i < last; i += WIDTH) {
    const Mask valid = lanes_below(i, last);
    const Uint outcome = valid ? LOAD(outcomes, i) : (Uint)OUTCOME_DONE;
    const Vec3 power = load3(rays, RAY_WEIGHT, stride, i);
    stored += outcome == OUTCOME_STORED ? (Uint)1 : (Uint)0;
    alive += outcome == OUTCOME_ALIVE ? (Uint)1 : (Uint)0;
    for (uint k = shot ? OUTCOME_ALIVE : OUTCOME_ALIVE + 1; k < OUTCOMES; ++k)
      if (ANY(outcome == k)) {
        add_power(power, outcome == k, per_unit, sum + 3 * k);
        sum[SUM_PHOTONS + k] += TO_ULONG(outcome == k ? (Uint)1 : (Uint)0);
      }
    if (absorbs) add_power(load3(absorbed, 0, stride, i), valid, per_unit, sum + SUM_ABSORBED);
    const Mask ended = (outcome != OUTCOME_ALIVE) & (outcome < OUTCOMES);
    sum[SUM_SURFACES] += TO_ULONG(ended ? load_bits(rays, RAY_SLOT, stride, i) : (Uint)0);
  }
  uint n_stored = 0;
  uint n_alive = 0;
  for (uint lane = 0; lane < WIDTH; ++lane) {
    n_stored += LANE(stored, uint, lane);
    n_alive += LANE(alive, uint, lane);
  }
  counts[2 * block] = n_stored;
  counts[2 * block + 1] = n_alive;
  for (uint k = 0; k < SUMS; ++k) sums[block * SUMS + k] = sum_of_lanes(sum[k]);
}

// Adds the blocks' sums up. One work-item for each of the SUMS.
__kernel void photon_totals(const uint blocks, __global const ulong* sums, __global ulong* totals) {
  const uint k = get_global_id(0);
  if (k >= SUMS) return;
  ulong sum = totals[k];
  for (uint block = 0; block < blocks; ++block) sum += sums[block * SUMS + k];
  totals[k] = sum;
}

// Copies the stored photons of each block to the map from `map_base` on; with `move`, the living to `next` from
// `next_base` on. What ended is marked, so that it is counted once.
__kernel void photon_append(const uint count, const uint stride, __global const float* rays, __global uint* outcomes,
                            __global const uint* counts, const uint map_base, __global float8* map, const uint move,
                            const uint next_base, const uint next_stride, __global float* next) {
  const uint block = get_global_id(0);
  const uint first = block * BLOCK;
  if (first >= count) return;
  const uint last = min(first + BLOCK, count);
  uint to_map = map_base + counts[2 * block];
  uint to_next = next_base + counts[2 * block + 1];
  for (uint i = first; i < last; ++i) {
    const uint outcome = outcomes[i];
    if (outcome == OUTCOME_STORED) {
      float8 photon;
      photon.s0 = rays[(RAY_ORIGIN + 0) * stride + i];
      photon.s1 = rays[(RAY_ORIGIN + 1) * stride + i];
      photon.s2 = rays[(RAY_ORIGIN + 2) * stride + i];
      photon.s3 = as_float(packed_direction(rays[(RAY_DIRECTION + 0) * stride + i],
                                            rays[(RAY_DIRECTION + 1) * stride + i],
                                            rays[(RAY_DIRECTION + 2) * stride + i]));
      photon.s4 = rays[(RAY_WEIGHT + 0) * stride + i];
      photon.s5 = rays[(RAY_WEIGHT + 1) * stride + i];
      photon.s6 = rays[(RAY_WEIGHT + 2) * stride + i];
      photon.s7 = 0.0f;
      map[to_map++] = photon;
    }
    if (outcome != OUTCOME_ALIVE) {
      outcomes[i] = OUTCOME_DONE;
    } else if (move) {
      for (uint field = 0; field < RAY_FIELDS; ++field) next[field * next_stride + to_next] = rays[field * stride + i];
      ++to_next;
    }
  }
}

// Moves `count` waiting photons, from `first` on, into a queue of their own. All of them are alive.
__kernel void photon_move(const uint count, const uint from_stride, const uint first, __global const float* from,
                          const uint stride, __global float* rays, __global uint* outcomes) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  for (uint field = 0; field < RAY_FIELDS; ++field) rays[field * stride + i] = from[field * from_stride + first + i];
  outcomes[i] = OUTCOME_ALIVE;
}
