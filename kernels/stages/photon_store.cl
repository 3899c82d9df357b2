// Stage photon_store: takes what ended out of a queue of photons: power by outcome is added up, the stored go to the
// photon map, the living, when they have become few, to the next queue. Everything keeps its order.
#include "queue.h"
#include "blocks.h"
#include "outcome.h"
#include "photon_map.h"

#define SUMS (OUTCOMES * 3 + 3)

// Counts what is stored and what is alive in each block, and adds up power by outcome: fixed point, `per_unit` units to
// the watt, so that sums are exact and the order does not matter. The living are added up only where
// they have just been shot. sums: [block][OUTCOMES * 3, then absorbed by media 3].
__kernel void photon_tally(const uint count, const uint stride, const float per_unit, __global const float* rays,
                           __global const uint* outcomes, __global const float* absorbed, const uint absorbs,
                           const uint shot, __global uint* counts, __global ulong* sums) {
  const uint block = get_global_id(0);
  const uint first = block * BLOCK;
  if (first >= count) return;
  const uint last = min(first + BLOCK, count);
  uint stored = 0;
  uint alive = 0;
  ulong sum[SUMS];
  for (uint k = 0; k < SUMS; ++k) sum[k] = 0;
  for (uint i = first; i < last; ++i) {
    const uint outcome = outcomes[i];
    stored += outcome == OUTCOME_STORED;
    alive += outcome == OUTCOME_ALIVE;
    for (uint c = 0; c < 3; ++c) {
      if (outcome < OUTCOMES && (shot || outcome != OUTCOME_ALIVE))
        sum[outcome * 3 + c] += (ulong)fma(rays[(RAY_WEIGHT + c) * stride + i], per_unit, 0.5f);
      if (absorbs) sum[OUTCOMES * 3 + c] += (ulong)fma(absorbed[c * stride + i], per_unit, 0.5f);
    }
  }
  counts[2 * block] = stored;
  counts[2 * block + 1] = alive;
  for (uint k = 0; k < SUMS; ++k) sums[block * SUMS + k] = sum[k];
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
