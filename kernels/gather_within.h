// Photons within a fixed radius of a place. Included by gather.h.
#ifndef VITRUM_GATHER_WITHIN_H
#define VITRUM_GATHER_WITHIN_H

// Whether all photons of a bucket count for a surface, however far they are: the same sums, in the same order, of those
// corners of its boxes where they are greatest, so that rounding does not matter.
FUNCTION int all_on_surface(__global const BucketData* bucket, float3 p, float3 n, float max_off_plane) {
  const float3 low = vload3(0, bucket->low) - p;
  const float3 high = vload3(0, bucket->high) - p;
  const float3 low_direction = vload3(0, bucket->low_direction);
  const float3 high_direction = vload3(0, bucket->high_direction);
  const int3 up = n > 0.0f;
  const float3 before = (up ? high : low) * n;
  const float3 behind = (up ? low : high) * n;
  const float3 along = (up ? high_direction : low_direction) * n;
  return before.x + before.y + before.z <= max_off_plane && behind.x + behind.y + behind.z >= -max_off_plane &&
         along.x + along.y + along.z < 0.0f;
}

// [gather]
// Adds the photons [first, last) of a bucket: Epanechnikov's kernel 2 / (pi r^2) (1 - d^2 / r^2), unbiased for the
// irradiance convolved with it. `sure`: all of them are known to count for the surface, if only they are near.
FUNCTION void add_photons(__global const float* bucket, uint first, uint last, float3 p, float3 n, float inverse_r2,
                          float max_off_plane, const int sure, Sums* sums) {
  for (uint i = first / BATCH * BATCH; i < last; i += BATCH) {
    __global const float* photons = bucket + map_place(i, 0, MAP_FIELDS);
    const BatchFloat dx = load_batch(photons + PHOTON_X * MAP_BLOCK) - p.x;
    const BatchFloat dy = load_batch(photons + PHOTON_Y * MAP_BLOCK) - p.y;
    const BatchFloat dz = load_batch(photons + PHOTON_Z * MAP_BLOCK) - p.z;
    const BatchFloat d2 = fma(dx, dx, fma(dy, dy, dz * dz));
    const BatchFloat nearness = 1.0f - d2 * inverse_r2;
    // Those before `first` are beyond all others.
    BatchInt counts = (nearness > 0.0f) & (BATCH_LANES + (i - first) < last - first);
    if (!sure) {
      const BatchInt packed = JOIN(as_int, BATCH)(load_batch(photons + PHOTON_DIRECTION * MAP_BLOCK));
      counts &= came_to_front(packed, n) & (distance_off_plane(dx, dy, dz, n) <= max_off_plane);
    }
    add_weighted(photons, counts, nearness, sums);
  }
}
// [/gather]

// Irradiance [W/m2] at p on the side of the unit normal n, and the number of `photons` that it is made of.
FUNCTION float3 gathered_irradiance(const PhotonMap* map, float3 p, float3 n, uint* photons) {
  const GridData grid = map->grid;
  const float inverse_r2 = 1.0f / (map->radius * map->radius);
  const float max_off_plane = PLANE_SHARE * map->radius;
  const int x = cell_coordinate(p.x, grid.inverse_cell);
  const int y = cell_coordinate(p.y, grid.inverse_cell);
  const int z = cell_coordinate(p.z, grid.inverse_cell);
  const uint size_x = 1u << grid.log2_x;
  const uint x_first = (uint)(x - 1) & (size_x - 1u);
  Sums sums = no_sums();
  uint asked = 0xffffffffu;  // the bucket that `sure` is of
  int sure = 0;
  for (int dz = first_neighbour(grid.log2_z); dz <= last_neighbour(grid.log2_z); ++dz) {
    for (int dy = first_neighbour(grid.log2_y); dy <= last_neighbour(grid.log2_y); ++dy) {
      // Three cells in a row, in one range unless the grid wraps or a bucket ends between them.
      const uint row = row_of_cells(grid, y + dy, z + dz);
      uint cell = row + x_first;
      for (uint left = 3; left > 0;) {
        const uint bucket = cell >> grid.bucket_shift;
        const uint bucket_end = (bucket + 1) << grid.bucket_shift;
        const uint end = min(cell + left, min(row + size_x, bucket_end));
        __global const uint* first_of = map->first_of_cell + bucket;
        const uint first = first_of[cell];
        const uint last = first_of[end];
        if (first < last) {
          if (bucket != asked) sure = all_on_surface(map->buckets + bucket, p, n, max_off_plane);
          asked = bucket;
          __global const float* of_bucket = photons_of_bucket(map, bucket);
          if (sure) add_photons(of_bucket, first, last, p, n, inverse_r2, max_off_plane, 1, &sums);
          else add_photons(of_bucket, first, last, p, n, inverse_r2, max_off_plane, 0, &sums);
        }
        left -= end - cell;
        cell = end == row + size_x ? row : end;
      }
    }
  }
  *photons = photons_in(&sums);
  return total_power(&sums) * (2.0f * 0.318309886183790672f * inverse_r2);
}

#endif
