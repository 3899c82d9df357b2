// Stage photon_sort: a stable sort of the photon map into its grid, in two steps: runs into buckets of neighbouring
// cells, few enough that the processor follows all of them, then each bucket, which fits its caches, into cells. With
// footprints, stage photon_footprints does the first.
// Runs, buckets and cells: photon_map.h. What goes where is added up by the host (src/render/photon_grid.cpp).
#include "outcome.h"
#include "photon_map.h"

#if CAUSTICS != CAUSTICS_FOOTPRINTS

// places: for each bucket, the row of the run's next photon.
BODY move_run(const uint stored, const uint run_length, const uint bucket_shift, __global const float* restrict fields,
              __global uint* restrict places, __global float8* restrict rows) {
  const uint stride = photons_stride(run_length);
  __global const float* cells = fields + RUN_CELL * stride;
  const uint ahead = 32;
  for (uint i = 0; i < stored; ++i) {
    // The caches wait for a line in every other bucket.
    if (i + ahead < stored) PREFETCH_TO_WRITE(rows + places[as_uint(cells[i + ahead]) >> bucket_shift]);
    const float8 photon = (float8)(fields[i], fields[stride + i], fields[2 * stride + i], fields[3 * stride + i],
                                   fields[4 * stride + i], fields[5 * stride + i], fields[6 * stride + i],
                                   fields[RUN_CELL * stride + i]);
    rows[places[as_uint(photon.s7) >> bucket_shift]++] = photon;
  }
}

// Moves the photons of each run into their buckets, as rows. places: [run * buckets + bucket].
KERNEL void sort_into_buckets(const uint n_runs, const uint run_length, const uint buckets, const uint bucket_shift,
                              __global const PhotonRunData* reports, __global const float* photons,
                              __global uint* places, __global float8* rows) {
  const uint run = get_global_id(0);
  if (run < n_runs)
    move_run(reports[run].photons[OUTCOME_STORED], run_length, bucket_shift,
             photons + photon_in_run(run_length, run, 0, RUN_ROW), places + run * buckets, rows);
}

#endif

#if CAUSTICS != CAUSTICS_FOOTPRINTS
// The boxes around the `floats` of a bucket's blocks.
FUNCTION void find_bounds(__global const float* blocks, const uint floats, __global BucketData* bucket) {
  float8 low[3], high[3];
  int8 low_direction[3], high_direction[3];
  for (uint axis = 0; axis < 3; ++axis) {
    low[axis] = INFINITY;
    high[axis] = -INFINITY;
    low_direction[axis] = INT_MAX;
    high_direction[axis] = INT_MIN;
  }
  for (uint i = 0; i < floats; i += MAP_BLOCK * MAP_FIELDS)
    for (uint half_block = i; half_block < i + MAP_BLOCK; half_block += 8) {
      const int8 packed = as_int8(vload8(0, blocks + half_block + PHOTON_DIRECTION * MAP_BLOCK));
      const int8 directions[3] = {DIRECTION_X(packed), DIRECTION_Y(packed), DIRECTION_Z(packed)};
      for (uint axis = 0; axis < 3; ++axis) {
        const float8 place = vload8(0, blocks + half_block + (PHOTON_X + axis) * MAP_BLOCK);
        low[axis] = place < low[axis] ? place : low[axis];
        high[axis] = place > high[axis] ? place : high[axis];
        low_direction[axis] = min(low_direction[axis], directions[axis]);
        high_direction[axis] = max(high_direction[axis], directions[axis]);
      }
    }
  for (uint axis = 0; axis < 3; ++axis) {
    bucket->low[axis] = least8(low[axis]);
    bucket->high[axis] = -least8(-high[axis]);
    bucket->low_direction[axis] = least8(convert_float8(low_direction[axis]));
    bucket->high_direction[axis] = -least8(-convert_float8(high_direction[axis]));
  }
}
#endif

// Sorts a bucket of `count` photons from rows to blocks, by way of `blocks`, which has room for all of it. `first`: of
// its cells; next: room for as many numbers as there are cells.
BODY sort_bucket(const uint first_cell, const uint cells, const uint count, __global float* restrict rows,
                 __global float* restrict blocks, __global uint* restrict next, __global uint* restrict first,
                 __global BucketData* bucket) {
  for (uint cell = 0; cell < cells; ++cell) next[cell] = 0;
  for (uint i = 0; i < count; ++i) ++next[as_uint(rows[MAP_ROW * i + MAP_CELL]) - first_cell];
  uint sum = 0;
  for (uint cell = 0; cell < cells; ++cell) {
    const uint n = next[cell];
    next[cell] = first[cell] = sum;
    sum += n;
  }
  first[cells] = sum;
  // Which row comes to each place is kept where its x will be; then places are filled in order.
  for (uint i = 0; i < count; ++i)
    blocks[map_place(next[as_uint(rows[MAP_ROW * i + MAP_CELL]) - first_cell]++, PHOTON_X, MAP_FIELDS)] = as_float(i);
  for (uint i = 0; i < count; ++i) {
    __global float* photon = blocks + map_place(i, 0, MAP_FIELDS);
    __global const float* row = rows + MAP_ROW * as_uint(photon[PHOTON_X * MAP_BLOCK]);
    // Its x is the last to be read and the first to be lost.
    for (uint field = MAP_FIELDS; field-- > 0;) photon[field * MAP_BLOCK] = row[field];
  }
  // Whoever reads whole blocks finds numbers behind the last, and none that boxes do not have.
  for (uint i = count; i % MAP_BLOCK != 0; ++i)
    for (uint field = 0; field < MAP_FIELDS; ++field)
      blocks[map_place(i, field, MAP_FIELDS)] = blocks[map_place(count - 1u, field, MAP_FIELDS)];
  const uint floats = map_floats(count, MAP_FIELDS);
#if CAUSTICS != CAUSTICS_FOOTPRINTS
  find_bounds(blocks, floats, bucket);
#endif
  for (uint i = 0; i < floats; i += 16) vstore16(vload16(0, blocks + i), 0, rows + i);
}

// Sorts all buckets. Work-item w takes those listed at [first_task[w], first_task[w + 1]), one after the other, and has
// scratch from float MAP_BLOCK * first_scratch[w] on.
KERNEL void sort_into_cells(const uint workers, const uint bucket_shift, __global const uint* tasks,
                            __global const uint* first_task, __global const uint* first_scratch,
                            __global const uint* counts, __global BucketData* buckets, __global float* scratch,
                            __global uint* next_of_cell, __global uint* first_of_cell, __global float* map) {
  const uint worker = get_global_id(0);
  if (worker >= workers) return;
  for (uint task = first_task[worker]; task < first_task[worker + 1]; ++task) {
    const uint bucket = tasks[task];
    const uint first_cell = bucket << bucket_shift;
    sort_bucket(first_cell, 1u << bucket_shift, counts[bucket], map + (ulong)buckets[bucket].start * MAP_BLOCK,
                scratch + (ulong)first_scratch[worker] * MAP_BLOCK, next_of_cell + first_cell,
                first_of_cell + first_cell + bucket, buckets + bucket);
  }
}
