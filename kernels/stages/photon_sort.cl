// Stage photon_sort: a stable sort of the photon map into its grid, in two steps: first into buckets of neighbouring
// cells, few enough that the processor follows all of them, then each bucket, which fits its caches, into cells.
// The host adds the counts of the buckets up in between.
#include "photon_map.h"
#include "outcome.h"

// The first run that a block minds: as many as the others, in order.
FUNCTION uint first_run_of(uint block, uint blocks, uint n_runs) { return (uint)((ulong)n_runs * block / blocks); }

FUNCTION float least(float8 v) {
  const float4 a = min(v.lo, v.hi);
  return min(min(a.x, a.y), min(a.z, a.w));
}

// Reads: the runs' photons. Writes: their cells; counts[block * buckets + bucket], the number of photons of each bucket
// in each block of runs; bounds[block], the least and the greatest coordinates {x, y, z, -, x, y, z, -}. A bucket is
// 2^bucket_shift cells.
BODY count_block(const GridData grid, const uint n_runs, const uint run_length, const uint block, const uint blocks,
                 const uint buckets, const uint bucket_shift, __global const PhotonRunData* restrict runs,
                 __global float* restrict photons, __global uint* restrict own, __global float8* restrict bounds) {
  for (uint k = 0; k < buckets; ++k) own[k] = 0;
  float8 low_x = INFINITY, low_y = INFINITY, low_z = INFINITY;
  float8 low_minus_x = INFINITY, low_minus_y = INFINITY, low_minus_z = INFINITY;
  const uint last = first_run_of(block + 1, blocks, n_runs);
  for (uint run = first_run_of(block, blocks, n_runs); run < last; ++run) {
    const uint stored = runs[run].photons[OUTCOME_STORED];
    __global const float* xs = photons + photon_in_run(run_length, run, PHOTON_X);
    __global const float* ys = photons + photon_in_run(run_length, run, PHOTON_Y);
    __global const float* zs = photons + photon_in_run(run_length, run, PHOTON_Z);
    __global float* cells = photons + photon_in_run(run_length, run, PHOTON_CELL);
    for (uint i = 0; i < stored; i += 8) {
      const int8 here = (uint8)(0, 1, 2, 3, 4, 5, 6, 7) + i < stored;
      const float8 x = vload8(0, xs + i);
      const float8 y = vload8(0, ys + i);
      const float8 z = vload8(0, zs + i);
      low_x = (here & (x < low_x)) ? x : low_x;
      low_y = (here & (y < low_y)) ? y : low_y;
      low_z = (here & (z < low_z)) ? z : low_z;
      low_minus_x = (here & (-x < low_minus_x)) ? -x : low_minus_x;
      low_minus_y = (here & (-y < low_minus_y)) ? -y : low_minus_y;
      low_minus_z = (here & (-z < low_minus_z)) ? -z : low_minus_z;
      const uint8 cell = cells_of(grid, x, y, z);
      vstore8(as_float8(cell), 0, cells + i);
      uint bucket[8];
      vstore8(cell >> bucket_shift, 0, bucket);
      const uint n = min(stored - i, 8u);
      for (uint k = 0; k < n; ++k) ++own[bucket[k]];
    }
  }
  *bounds = (float8)(least(low_x), least(low_y), least(low_z), 0.0f, -least(low_minus_x), -least(low_minus_y),
                     -least(low_minus_z), 0.0f);
}

__kernel void sort_count(const GridData grid, const uint n_runs, const uint run_length, const uint blocks,
                         const uint buckets, const uint bucket_shift, __global const PhotonRunData* runs,
                         __global float* photons, __global uint* counts, __global float8* bounds) {
  const uint block = get_global_id(0);
  if (block < blocks)
    count_block(grid, n_runs, run_length, block, blocks, buckets, bucket_shift, runs, photons, counts + block * buckets,
                bounds + block);
}

// Moves each photon into its bucket. places[block * buckets + bucket]: where the next one goes.
BODY move_block(const uint n_runs, const uint run_length, const uint block, const uint blocks, const uint bucket_shift,
                __global const PhotonRunData* restrict runs, __global const float* restrict photons,
                __global uint* restrict own, __global float8* restrict bucketed) {
  const uint last = first_run_of(block + 1, blocks, n_runs);
  for (uint run = first_run_of(block, blocks, n_runs); run < last; ++run) {
    const uint stored = runs[run].photons[OUTCOME_STORED];
    __global const float* fields = photons + photon_in_run(run_length, run, 0);
    const uint stride = run_length + RUN_MARGIN;
    for (uint i = 0; i < stored; ++i) {
      const float8 photon = (float8)(fields[i], fields[stride + i], fields[2 * stride + i], fields[3 * stride + i],
                                     fields[4 * stride + i], fields[5 * stride + i], fields[6 * stride + i],
                                     fields[7 * stride + i]);
      bucketed[own[as_uint(photon.s7) >> bucket_shift]++] = photon;
    }
  }
}

__kernel void sort_into_buckets(const uint n_runs, const uint run_length, const uint blocks, const uint buckets,
                                const uint bucket_shift, __global const PhotonRunData* runs,
                                __global const float* photons, __global uint* places, __global float8* bucketed) {
  const uint block = get_global_id(0);
  if (block < blocks)
    move_block(n_runs, run_length, block, blocks, bucket_shift, runs, photons, places + block * buckets, bucketed);
}

// Sorts each bucket into its cells, from rows to columns. first_of_bucket has one more entry than there are buckets.
// Writes: first_of_cell, where each cell starts, and one more, the number of photons; map. next_of_cell: room for the
// cells. The map has room for whole groups of eight.
BODY sort_bucket(const uint bucket, const uint buckets, const uint bucket_shift,
                 __global const uint* restrict first_of_bucket, __global const float8* restrict bucketed,
                 __global uint* restrict next_of_cell, __global uint* restrict first_of_cell, const uint stride,
                 __global float* restrict map) {
  const uint cells = 1u << bucket_shift;
  const uint first_cell = bucket << bucket_shift;
  const uint first = first_of_bucket[bucket];
  const uint last = first_of_bucket[bucket + 1];
  for (uint cell = first_cell; cell < first_cell + cells; ++cell) next_of_cell[cell] = 0;
  for (uint i = first; i < last; ++i) ++next_of_cell[as_uint(bucketed[i].s7)];
  uint next = first;
  for (uint cell = first_cell; cell < first_cell + cells; ++cell) {
    const uint n = next_of_cell[cell];
    next_of_cell[cell] = first_of_cell[cell] = next;
    next += n;
  }
  if (bucket == buckets - 1) first_of_cell[first_cell + cells] = next;

  // Each place's photon, kept where its x will be: then the map is written in order.
  __global float* order = map + PHOTON_X * stride;
  for (uint i = first; i < last; ++i) order[next_of_cell[as_uint(bucketed[i].s7)]++] = as_float(i);
  for (uint i = first; i < last; ++i) {
    const float8 photon = bucketed[as_uint(order[i])];
    map[PHOTON_X * stride + i] = photon.s0;
    map[PHOTON_Y * stride + i] = photon.s1;
    map[PHOTON_Z * stride + i] = photon.s2;
    map[PHOTON_DIRECTION * stride + i] = photon.s3;
    map[(PHOTON_POWER + 0) * stride + i] = photon.s4;
    map[(PHOTON_POWER + 1) * stride + i] = photon.s5;
    map[(PHOTON_POWER + 2) * stride + i] = photon.s6;
  }
}

__kernel void sort_into_cells(const uint buckets, const uint bucket_shift, __global const uint* first_of_bucket,
                              __global const float8* bucketed, __global uint* next_of_cell,
                              __global uint* first_of_cell, const uint stride, __global float* map) {
  const uint bucket = get_global_id(0);
  if (bucket < buckets)
    sort_bucket(bucket, buckets, bucket_shift, first_of_bucket, bucketed, next_of_cell, first_of_cell, stride, map);
}
