// Stage gather: the caustic's irradiance on the surfaces that scatter, from the photons within a fixed radius.
// Reads: surfaces, scatter [0, count), the sorted photon map. Adds to: shares (beauty and caustics).
// The SIMD is inside the ray: eight photons at a time.
#include "gather.h"

// [gather]
// Adds the photons [first, last): Epanechnikov's kernel 2 / (pi r^2) (1 - d^2 / r^2), unbiased for the irradiance
// convolved with it.
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
    const float8 weight = counts ? nearness : 0.0f;
    // What lies behind the last photon may be no number, which a weight of 0 would not take out.
    const float8 red = vload8(0, map + (PHOTON_POWER + 0) * stride + i);
    const float8 green = vload8(0, map + (PHOTON_POWER + 1) * stride + i);
    const float8 blue = vload8(0, map + (PHOTON_POWER + 2) * stride + i);
    sums->red = fma(weight, counts ? red : 0.0f, sums->red);
    sums->green = fma(weight, counts ? green : 0.0f, sums->green);
    sums->blue = fma(weight, counts ? blue : 0.0f, sums->blue);
  }
}
// [/gather]

// `low`, `high`: corners of a box around all photons.
__kernel void gather(const uint count, const uint stride, const GridData grid, const float radius, const float4 low,
                     const float4 high, const uint map_stride, __global const uint* first_of_cell,
                     __global const float* map, __global const float* surfaces, __global const float* scatter,
                     __global float* shares) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  const float3 diffuse = receiver_diffuse(scatter, stride, i);
  if (is_black(diffuse)) return;
  const float3 p = triple_at(surfaces, SURFACE_POSITION, stride, i);
  if (p.x < low.x - radius || p.y < low.y - radius || p.z < low.z - radius || p.x > high.x + radius ||
      p.y > high.y + radius || p.z > high.z + radius)
    return;
  const float3 n = triple_at(scatter, SCATTER_NORMAL, stride, i);

  const float inverse_r2 = 1.0f / (radius * radius);
  const int x = cell_coordinate(p.x, grid.inverse_cell);
  const int y = cell_coordinate(p.y, grid.inverse_cell);
  const int z = cell_coordinate(p.z, grid.inverse_cell);
  const uint size_x = 1u << grid.log2_x;
  const uint x_first = (uint)(x - 1) & (size_x - 1u);
  Sums sums = no_sums();
  for (int dz = first_neighbour(grid.log2_z); dz <= last_neighbour(grid.log2_z); ++dz) {
    for (int dy = first_neighbour(grid.log2_y); dy <= last_neighbour(grid.log2_y); ++dy) {
      __global const uint* row = first_of_cell + row_of_cells(grid, y + dy, z + dz);
      // Three cells in a row, in one range unless the grid wraps between them.
      const uint straight = min(x_first + 3u, size_x);
      add_photons(map, map_stride, row[x_first], row[straight], p, n, inverse_r2, PLANE_SHARE * radius, &sums);
      if (x_first + 3u > size_x)
        add_photons(map, map_stride, row[0], row[x_first + 3u - size_x], p, n, inverse_r2, PLANE_SHARE * radius, &sums);
    }
  }
  add_caustic(&sums, 2.0f * 0.318309886183790672f * inverse_r2, diffuse, shares, stride, i);
}
