// Photons whose footprints cover a place. Included by gather.h. Each cell of the grid lists all that reach into it, so one
// cell of each level is all there is to look at.
#ifndef VITRUM_GATHER_FOOTPRINTS_H
#define VITRUM_GATHER_FOOTPRINTS_H

// Adds the entries of a level that are listed in the cell about p.
FUNCTION void add_cell(const PhotonMap* map, float3 p, float3 n, uint level, Sums* sums) {
  const GridData grid = map->grid;
  const float max_off_plane = FOOTPRINT_OFF_PLANE * map->radius;
  const float area = map->radius * map->radius;  // so that no square overflows
  const float inverse_cell = grid.inverse_cell / level_scale(level);
  const uint cell = cell_of_level(grid, level, cell_coordinate(p.x, inverse_cell), cell_coordinate(p.y, inverse_cell),
                                  cell_coordinate(p.z, inverse_cell));
  const uint bucket = cell >> grid.bucket_shift;
  const uint first = map->first_of_cell[bucket + cell];
  const uint last = map->first_of_cell[bucket + cell + 1];
  const BucketData data = map->buckets[bucket];
  const uint stride = data.stride;
  __global const float* entries = map->photons + (ulong)data.start * BUCKET_UNIT;
  for (uint i = first; i < last; i += 8) {
    const float8 dx = vload8(0, entries + PHOTON_X * stride + i) - p.x;
    const float8 dy = vload8(0, entries + PHOTON_Y * stride + i) - p.y;
    const float8 dz = vload8(0, entries + PHOTON_Z * stride + i) - p.z;
    __global const float* u = entries + FOOTPRINT_U * stride + i;
    __global const float* v = entries + FOOTPRINT_V * stride + i;
    const float8 ux = vload8(0, u);
    const float8 uy = vload8(0, u + stride);
    const float8 uz = vload8(0, u + 2 * stride);
    const float8 vx = vload8(0, v);
    const float8 vy = vload8(0, v + stride);
    const float8 vz = vload8(0, v + 2 * stride);
    const float8 tent_u = 1.0f - fabs(dx * ux + dy * uy + dz * uz);
    const float8 tent_v = 1.0f - fabs(dx * vx + dy * vy + dz * vz);
    const uint8 lane = (uint8)(0, 1, 2, 3, 4, 5, 6, 7) + i;
    int8 counts = (tent_u > 0.0f) & (tent_v > 0.0f) & (lane < last);
    if (!any(counts)) continue;
    // Off its own plane too: nothing else but the cells that list it tells how high a tent is.
    const float8 x = area * (uy * vz - uz * vy);
    const float8 y = area * (uz * vx - ux * vz);
    const float8 z = area * (ux * vy - uy * vx);
    const float8 height = dx * x + dy * y + dz * z;
    const uint8 packed = as_uint8(vload8(0, entries + PHOTON_DIRECTION * stride + i));
    const uint8 flags = as_uint8(vload8(0, entries + FOOTPRINT_FLAGS * stride + i));
    counts &= ((flags & ~IN_OTHER_CELL) == level) & came_to_front(as_int8(packed), n) &
              (distance_off_plane(dx, dy, dz, n) <= max_off_plane) &
              (height * height <= max_off_plane * max_off_plane * (x * x + y * y + z * z));
    add_weighted(entries, stride, i, counts, tent_u * tent_v, sums);
  }
}

// Irradiance [W/m2] at p on the side of the unit normal n, and the number of `photons` that it is made of.
FUNCTION float3 gathered_irradiance(const PhotonMap* map, float3 p, float3 n, uint* photons) {
  Sums sums = no_sums();
  for (uint level = 0; level < LEVELS; ++level) add_cell(map, p, n, level, &sums);
  *photons = photons_in(&sums);
  return total_power(&sums);
}

#endif
