// Photons within a fixed radius of a place. Included by gather.h.
#ifndef VITRUM_GATHER_WITHIN_H
#define VITRUM_GATHER_WITHIN_H

// [gather]
// Adds the photons [first, last) of a bucket: Epanechnikov's kernel 2 / (pi r^2) (1 - d^2 / r^2), unbiased for the
// irradiance convolved with it.
FUNCTION void add_photons(__global const float* map, uint stride, uint first, uint last, float3 p, float3 n,
                          float inverse_r2, float max_off_plane, Sums* sums) {
  for (uint i = first; i < last; i += 8) {
    const float8 dx = vload8(0, map + PHOTON_X * stride + i) - p.x;
    const float8 dy = vload8(0, map + PHOTON_Y * stride + i) - p.y;
    const float8 dz = vload8(0, map + PHOTON_Z * stride + i) - p.z;
    const float8 d2 = fma(dx, dx, fma(dy, dy, dz * dz));
    const float8 nearness = 1.0f - d2 * inverse_r2;
    const uint8 lane = (uint8)(0, 1, 2, 3, 4, 5, 6, 7) + i;
    int8 counts = (nearness > 0.0f) & (lane < last);
    if (!any(counts)) continue;
    const int8 packed = as_int8(vload8(0, map + PHOTON_DIRECTION * stride + i));
    counts &= came_to_front(packed, n) & (distance_off_plane(dx, dy, dz, n) <= max_off_plane);
    add_weighted(map, stride, i, counts, nearness, sums);
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
          const BucketData data = map->buckets[bucket];
          add_photons(map->photons + (ulong)data.start * BUCKET_UNIT, data.stride, first, last, p, n, inverse_r2,
                      max_off_plane, &sums);
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
