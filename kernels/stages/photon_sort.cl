// Stage photon_sort: a stable counting sort of the photon map into its grid.
// Each work-item minds one of `blocks` equal ranges of photons; offsets[cell * blocks + block].
#include "queue.h"
#include "photon_map.h"

// Reads: photons. Writes: offsets = the number of photons of each cell in each block. offsets starts at 0.
__kernel void sort_count(const GridData grid, const uint count, const uint blocks, __global const float8* photons,
                         __global uint* offsets) {
  const uint block = get_global_id(0);
  if (block >= blocks) return;
  const uint last = (uint)((ulong)count * (block + 1) / blocks);
  for (uint i = (uint)((ulong)count * block / blocks); i < last; ++i) {
    const float8 photon = photons[i];
    ++offsets[cell_of(grid, photon.s0, photon.s1, photon.s2) * blocks + block];
  }
}

// Turns counts into places in three steps: the sum of each of `parts` ranges of cells, what comes before each range,
// then the places within. first[cell] is where a cell starts, first[cells] the number of photons.
__kernel void sort_sum(const uint cells, const uint blocks, const uint parts, __global const uint* offsets,
                       __global uint* sums) {
  const uint part = get_global_id(0);
  if (part >= parts) return;
  const uint last = (uint)((ulong)cells * (part + 1) / parts) * blocks;
  uint sum = 0;
  for (uint i = (uint)((ulong)cells * part / parts) * blocks; i < last; ++i) sum += offsets[i];
  sums[part] = sum;
}

__kernel void sort_place(const uint cells, const uint blocks, const uint parts, __global const uint* sums,
                         __global uint* offsets, __global uint* first) {
  const uint part = get_global_id(0);
  if (part >= parts) return;
  uint place = 0;
  for (uint p = 0; p < part; ++p) place += sums[p];
  const uint last = (uint)((ulong)cells * (part + 1) / parts);
  for (uint cell = (uint)((ulong)cells * part / parts); cell < last; ++cell) {
    first[cell] = place;
    for (uint block = 0; block < blocks; ++block) {
      const uint n = offsets[cell * blocks + block];
      offsets[cell * blocks + block] = place;
      place += n;
    }
  }
  if (part == parts - 1) first[cells] = place;
}

// Moves each photon to its place. One cache line a photon; the structure of arrays is made afterwards, in order.
__kernel void sort_scatter(const GridData grid, const uint count, const uint blocks, __global const float8* photons,
                           __global uint* offsets, __global float8* sorted) {
  const uint block = get_global_id(0);
  if (block >= blocks) return;
  const uint last = (uint)((ulong)count * (block + 1) / blocks);
  for (uint i = (uint)((ulong)count * block / blocks); i < last; ++i) {
    const float8 photon = photons[i];
    sorted[offsets[cell_of(grid, photon.s0, photon.s1, photon.s2) * blocks + block]++] = photon;
  }
}

// Eight photons to a work-item, from rows to columns. `map` has room for whole groups of eight.
__kernel void sort_transpose(const uint count, const uint stride, __global const float8* sorted, __global float* map) {
  const uint i = 8 * get_global_id(0);
  if (i >= count) return;
  float rows[64];
  for (uint k = 0; k < 8; ++k) vstore8(sorted[min(i + k, count - 1)], k, rows);
  for (uint field = 0; field < PHOTON_FIELDS; ++field) {
    const float8 column = (float8)(rows[field], rows[8 + field], rows[16 + field], rows[24 + field], rows[32 + field],
                                   rows[40 + field], rows[48 + field], rows[56 + field]);
    vstore8(column, 0, map + field * stride + i);
  }
}

// The least and the greatest coordinates of each block's photons; w means nothing.
__kernel void sort_bounds(const uint count, const uint blocks, __global const float8* photons,
                          __global float8* bounds) {
  const uint block = get_global_id(0);
  if (block >= blocks) return;
  const uint last = (uint)((ulong)count * (block + 1) / blocks);
  float4 low = INFINITY;
  float4 high = -INFINITY;
  for (uint i = (uint)((ulong)count * block / blocks); i < last; ++i) {
    const float4 place = photons[i].lo;
    low = place < low ? place : low;
    high = place > high ? place : high;
  }
  bounds[block] = (float8)(low, high);
}
