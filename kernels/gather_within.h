// Photons within a fixed radius of places: which cells to look at, WIDTH places at a time; then, place by place, the
// photons in them, a batch at a time. Included by gather.h.
#ifndef VITRUM_GATHER_WITHIN_H
#define VITRUM_GATHER_WITHIN_H

// Whether all photons of a bucket count for a surface, however far they are: the same sums, in the same order, of those
// corners of its boxes where they are greatest, so that rounding does not matter.
FUNCTION Mask all_on_surface(const PhotonMap* map, const Uint bucket, const Vec3 p, const Vec3 n,
                             const float max_off_plane) {
  const Vec3 low = subtract3(FIELD3(map->buckets, low, bucket), p);
  const Vec3 high = subtract3(FIELD3(map->buckets, high, bucket), p);
  const Vec3 low_direction = FIELD3(map->buckets, low_direction, bucket);
  const Vec3 high_direction = FIELD3(map->buckets, high_direction, bucket);
  const Mask up_x = n.x > 0.0f;
  const Mask up_y = n.y > 0.0f;
  const Mask up_z = n.z > 0.0f;
  const Vec3 before = multiply3(make_vec3(up_x ? high.x : low.x, up_y ? high.y : low.y, up_z ? high.z : low.z), n);
  const Vec3 behind = multiply3(make_vec3(up_x ? low.x : high.x, up_y ? low.y : high.y, up_z ? low.z : high.z), n);
  const Vec3 along = multiply3(make_vec3(up_x ? high_direction.x : low_direction.x,
                                         up_y ? high_direction.y : low_direction.y,
                                         up_z ? high_direction.z : low_direction.z), n);
  return (before.x + before.y + before.z <= max_off_plane) & (behind.x + behind.y + behind.z >= -max_off_plane) &
         (along.x + along.y + along.z < 0.0f);
}

// Photons [first, last) of a bucket that starts at MAP_BLOCK * start.
typedef struct {
  uint start, first, last;
  uint sure;                   // all of them count for the surface, if only they are near
} PhotonRange;
// Nine rows of cells, each in two ranges at worst.
#define MAX_PHOTON_RANGES 18
#define MAX_CELLS_OF_ROW (1u << LEAST_LOG2_BUCKET)

// The photons in the cells around places, as ranges, and how many these are.
typedef struct {
  uint count[WIDTH];
  PhotonRange ranges[WIDTH][MAX_PHOTON_RANGES];
} Neighbourhoods;

// How far it is [cells] to the row of cells that is `step` beside that of a place, which is at `coordinate` [cells], at
// least. Of two rows in all, the other one is on both sides.
FUNCTION Float gap_to_row(const Float coordinate, const int step, const uint log2) {
  if (step == 0) return 0.0f;
  const Float above = coordinate - floor(coordinate);
  const Float gap = log2 == 1 ? smaller(above, 1.0f - above) : step < 0 ? above : 1.0f - above;
  return larger(gap - 0x1p-22f * fabs(coordinate), (Float)0.0f);
}

FUNCTION void find_photons(const PhotonMap* map, const Vec3 p, const Vec3 n, const float max_off_plane,
                           const Mask which, Neighbourhoods* around) {
  const GridData grid = map->grid;
  const Uint iy = cell_coordinates(p.y, grid.inverse_cell);
  const Uint iz = cell_coordinates(p.z, grid.inverse_cell);
  const uint size_x = 1u << grid.log2_x;
  const Uint most = (Uint)(min(size_x, MAX_CELLS_OF_ROW));  // oclgrind 21.10 knows no min of vector and scalar
  Uint asked = (Uint)0xffffffffu;  // the buckets that `sure` is of
  Mask sure = 0;
  for (uint lane = 0; lane < WIDTH; ++lane) around->count[lane] = 0;
  for (int dz = first_neighbour(grid.log2_z); dz <= last_neighbour(grid.log2_z); ++dz) {
    const Float gap_z = gap_to_row(p.z * grid.inverse_cell, dz, grid.log2_z);
    for (int dy = first_neighbour(grid.log2_y); dy <= last_neighbour(grid.log2_y); ++dy) {
      // The cells of the row that the radius reaches, in one range unless the grid wraps or a bucket ends between them.
      // Rounding keeps the order of places, and cells are a thousandth wider than the radius.
      const Float gap_y = gap_to_row(p.y * grid.inverse_cell, dy, grid.log2_y);
      const Float reach2 = 1.0f - gap_y * gap_y - gap_z * gap_z;
      const Mask reaches = which & (reach2 > 0.0f);
      if (!ANY(reaches)) continue;
      const Float reach = sqrt(larger(reach2, (Float)0.0f)) / grid.inverse_cell;
      const Uint x_first = cell_coordinates(p.x - reach, grid.inverse_cell_x);
      const Uint x_last = cell_coordinates(p.x + reach, grid.inverse_cell_x);
      const Uint row = ROW_OF_CELLS(grid, iy + (uint)dy, iz + (uint)dz);
      const Uint row_end = row + size_x;
      Uint cell = row + (x_first & (size_x - 1u));
      Uint left = min(x_last - x_first + 1u, most);
      left = reaches ? left : (Uint)0;
      while (ANY(left > 0u)) {
        const Uint bucket = cell >> grid.bucket_shift;
        const Uint bucket_end = (bucket + 1u) << grid.bucket_shift;
        const Uint end = min(cell + left, min(row_end, bucket_end));
        const Uint first = GATHER(Uint, map->first_of_cell, bucket + cell);
        const Uint last = GATHER(Uint, map->first_of_cell, bucket + end);
        const Mask filled = (left > 0u) & (first < last);
        if (ANY(filled)) {
          if (ANY(filled & (bucket != asked))) {
            sure = all_on_surface(map, bucket, p, n, max_off_plane);
            asked = bucket;
          }
          const Uint start = FIELD(Uint, uint, map->buckets, start, bucket);
          FOR_LANES(lane, filled) {
            PhotonRange* range = &around->ranges[lane][around->count[lane]++];
            range->start = LANE(start, uint, lane);
            range->first = LANE(first, uint, lane);
            range->last = LANE(last, uint, lane);
            range->sure = LANE(sure, int, lane) != 0;
          }
        }
        left -= end - cell;
        cell = end == row_end ? row : end;
      }
    }
  }
}

// [gather]
// Adds photons of a range: Epanechnikov's kernel 2 / (pi r^2) (1 - d^2 / r^2), unbiased for the irradiance convolved
// with it.
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

// Irradiance [W/m2] at places p on the side of unit normals n, in the lanes of `which`; adds the number of photons that
// it is made of to *gathered, and of pairs of them, each twice, to *pairs.
FUNCTION Vec3 gathered_irradiance(const PhotonMap* map, const Vec3 p, const Vec3 n, const Mask which, ulong* gathered,
                                  ulong* pairs) {
  const float inverse_r2 = 1.0f / (map->radius * map->radius);
  const float max_off_plane = PLANE_SHARE * map->radius;
  Neighbourhoods around;
  find_photons(map, p, n, max_off_plane, which, &around);
  Vec3 irradiance = make_vec3(0.0f, 0.0f, 0.0f);
  FOR_LANES(lane, which) {
    const float3 place = LANE3(p, lane);
    const float3 normal = LANE3(n, lane);
    Sums sums = no_sums();
    for (uint k = 0; k < around.count[lane]; ++k) {
      const PhotonRange r = around.ranges[lane][k];
      __global const float* bucket = map->photons + (ulong)r.start * MAP_BLOCK;
      if (r.sure) add_photons(bucket, r.first, r.last, place, normal, inverse_r2, max_off_plane, 1, &sums);
      else add_photons(bucket, r.first, r.last, place, normal, inverse_r2, max_off_plane, 0, &sums);
    }
    const ulong photons = photons_in(&sums);
    *gathered += photons;
    *pairs += photons * (photons - 1);
    set_lane3(&irradiance, lane, total_power(&sums) * (2.0f * 0.318309886183790672f * inverse_r2));
  }
  return irradiance;
}

#endif
