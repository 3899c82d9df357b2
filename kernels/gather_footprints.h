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
  __global const float* entries_of_bucket = map->photons + (ulong)map->buckets[bucket].start * MAP_BLOCK;
  for (uint i = first / BATCH * BATCH; i < last; i += BATCH) {
    __global const float* entries = entries_of_bucket + map_place(i, 0, MAP_FIELDS);
    const BatchFloat dx = load_batch(entries + PHOTON_X * MAP_BLOCK) - p.x;
    const BatchFloat dy = load_batch(entries + PHOTON_Y * MAP_BLOCK) - p.y;
    const BatchFloat dz = load_batch(entries + PHOTON_Z * MAP_BLOCK) - p.z;
    __global const float* u = entries + FOOTPRINT_U * MAP_BLOCK;
    __global const float* v = entries + FOOTPRINT_V * MAP_BLOCK;
    const BatchFloat ux = load_batch(u);
    const BatchFloat uy = load_batch(u + MAP_BLOCK);
    const BatchFloat uz = load_batch(u + 2 * MAP_BLOCK);
    const BatchFloat vx = load_batch(v);
    const BatchFloat vy = load_batch(v + MAP_BLOCK);
    const BatchFloat vz = load_batch(v + 2 * MAP_BLOCK);
    const BatchFloat tent_u = 1.0f - fabs(dx * ux + dy * uy + dz * uz);
    const BatchFloat tent_v = 1.0f - fabs(dx * vx + dy * vy + dz * vz);
    // Those before `first` are beyond all others.
    BatchInt counts = (tent_u > 0.0f) & (tent_v > 0.0f) & (BATCH_LANES + (i - first) < last - first);
    if (!any(counts)) continue;
    // Off its own plane too: nothing else but the cells that list it tells how high a tent is.
    const BatchFloat x = area * (uy * vz - uz * vy);
    const BatchFloat y = area * (uz * vx - ux * vz);
    const BatchFloat z = area * (ux * vy - uy * vx);
    const BatchFloat height = dx * x + dy * y + dz * z;
    const BatchInt packed = JOIN(as_int, BATCH)(load_batch(entries + PHOTON_DIRECTION * MAP_BLOCK));
    const BatchUint flags = JOIN(as_uint, BATCH)(load_batch(entries + FOOTPRINT_FLAGS * MAP_BLOCK));
    counts &= ((flags & ~IN_OTHER_CELL) == level) & came_to_front(packed, n) &
              (distance_off_plane(dx, dy, dz, n) <= max_off_plane) &
              (height * height <= max_off_plane * max_off_plane * (x * x + y * y + z * z));
    add_weighted(entries, counts, tent_u * tent_v, sums);
  }
}

// Irradiance [W/m2] at p on the side of the unit normal n, and the number of `photons` that it is made of.
FUNCTION float3 irradiance_at(const PhotonMap* map, float3 p, float3 n, uint* photons) {
  Sums sums = no_sums();
  for (uint level = 0; level < LEVELS; ++level) add_cell(map, p, n, level, &sums);
  *photons = photons_in(&sums);
  return total_power(&sums);
}

#endif
