// Work in blocks: each work-item minds BLOCK entries one after the other, so that what it counts and copies keeps its
// order. Needs no atomics and no barriers, and gives the same result whatever the number of threads.
#ifndef VITRUM_BLOCKS_H
#define VITRUM_BLOCKS_H

#define BLOCK 256u

FUNCTION uint bits_at(__global const float* array, uint field, uint stride, uint i) {
  return as_uint(array[field * stride + i]);
}

// Replaces the counts of `columns` columns by what comes before each block; totals[column] is the sum. One work-item.
__kernel void scan_blocks(const uint blocks, const uint columns, __global uint* counts, __global uint* totals) {
  if (get_global_id(0) != 0) return;
  for (uint column = 0; column < columns; ++column) {
    uint sum = 0;
    for (uint block = 0; block < blocks; ++block) {
      const uint n = counts[block * columns + column];
      counts[block * columns + column] = sum;
      sum += n;
    }
    totals[column] = sum;
  }
}

#endif
