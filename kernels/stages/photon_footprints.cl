// Stage photon_footprints: makes the entries of the photon map from the photons that arrived, and moves them into buckets of
// neighbouring cells (photon_map.h): once to count them, and again when the host has made room (src/render/photon_grid.cpp).
// Reads: runs of photons, where the points of the lattice landed. Writes: counts, and rows.
#include "footprint.h"
#include "outcome.h"

// `places`: by bucket, how many rows there are, or with `rows` where the next one goes.
BODY spread_run(const uint stored, const uint run_length, __global const float* restrict fields,
                __global const float* restrict landings, const LatticeData lattice, const FootprintLimits limits,
                const GridData grid, const uint buckets, __global uint* restrict places, __global float* restrict rows,
                __global PhotonRunData* restrict report) {
  const uint stride = photons_stride(run_length);
  Vec3 low = make_vec3(INFINITY, INFINITY, INFINITY);
  Vec3 high = negate3(low);
  if (!rows)
    for (uint bucket = 0; bucket < buckets; ++bucket) places[bucket] = 0;
  for (uint first = 0; first < stored; first += WIDTH) {
    __global const float* photon = fields + first;
    const Mask here = lanes_below(first, stored);
    const Vec3 place =
        make_vec3(LOAD(photon, PHOTON_X * stride), LOAD(photon, PHOTON_Y * stride), LOAD(photon, PHOTON_Z * stride));
    const Vec3 normal =
        make_vec3(LOAD(photon, ARRIVED_NORMAL * stride), LOAD(photon, (ARRIVED_NORMAL + 1) * stride),
                  LOAD(photon, (ARRIVED_NORMAL + 2) * stride));
    const Uint point = here ? AS_UINT(LOAD(photon, ARRIVED_POINT * stride)) : (Uint)NO_POINT;
    const Float spacing = here ? LOAD(photon, ARRIVED_SPACING * stride) : 1.0f;
    const Footprint f = footprint_of(lattice, landings, limits, point, spacing, place, normal);
    FOR_LANES(lane, here) {
      const uint parts_u = LANE(f.parts_u, uint, lane);
      const uint parts_v = LANE(f.parts_v, uint, lane);
      const float3 centre = LANE3(place, lane);
      const float3 side_u = LANE3(f.side_u, lane) / (float)parts_u;
      const float3 side_v = LANE3(f.side_v, lane) / (float)parts_v;
      const float3 across_u = LANE3(f.across_u, lane);
      const float3 across_v = LANE3(f.across_v, lane);
      const float3 power = (float3)(photon[PHOTON_POWER * stride + lane], photon[(PHOTON_POWER + 1) * stride + lane],
                                    photon[(PHOTON_POWER + 2) * stride + lane]) / LANE(f.area, float, lane);
      // Of a part's tent, and what lies off its plane.
      const float off_plane = FOOTPRINT_OFF_PLANE * 2.0f * limits.largest;
      const float3 reach = fabs(side_u) + fabs(side_v) + off_plane * fabs(LANE3(normal, lane));
      const uint level = LANE(f.level, uint, lane);
      const float inverse_cell = grid.inverse_cell / level_scale(level);
      const float direction = photon[PHOTON_DIRECTION * stride + lane];
      for (uint part = 0; part < parts_u * parts_v; ++part) {
        // From the middle of the footprint, in sides of parts.
        const float i = (float)(part / parts_v) - 0.5f * (float)(parts_u - 1u);
        const float j = (float)(part % parts_v) - 0.5f * (float)(parts_v - 1u);
        const float3 middle = centre + i * side_u + j * side_v;
        const float3 first_corner = middle - reach;
        const float3 last_corner = middle + reach;
        if (!rows) {
          set_lane3(&low, lane, fmin(LANE3(low, lane), first_corner));
          set_lane3(&high, lane, fmax(LANE3(high, lane), last_corner));
        }
        const int x_first = cell_coordinate(first_corner.x, inverse_cell);
        const int y_first = cell_coordinate(first_corner.y, inverse_cell);
        const int z_first = cell_coordinate(first_corner.z, inverse_cell);
        // The grid wraps around, but each cell lists it once.
        const int x_last = min(cell_coordinate(last_corner.x, inverse_cell), x_first + (1 << grid.log2_x) - 1);
        const int y_last = min(cell_coordinate(last_corner.y, inverse_cell), y_first + (1 << grid.log2_y) - 1);
        const int z_last = min(cell_coordinate(last_corner.z, inverse_cell), z_first + (1 << grid.log2_z) - 1);
        const uint own_cell =
            cell_of_level(grid, level, cell_coordinate(middle.x, inverse_cell), cell_coordinate(middle.y, inverse_cell),
                          cell_coordinate(middle.z, inverse_cell));
        for (int iz = z_first; iz <= z_last; ++iz)
          for (int iy = y_first; iy <= y_last; ++iy)
            for (int ix = x_first; ix <= x_last; ++ix) {
              const uint cell = cell_of_level(grid, level, ix, iy, iz);
              const uint place_of_row = places[cell >> grid.bucket_shift]++;
              if (!rows) continue;
              __global float* row = rows + (ulong)FOOTPRINT_ROW * place_of_row;
              vstore3(middle, 0, row + PHOTON_X);
              row[PHOTON_DIRECTION] = direction;
              vstore3(power, 0, row + PHOTON_POWER);
              vstore3(across_u, 0, row + FOOTPRINT_U);
              vstore3(across_v, 0, row + FOOTPRINT_V);
              row[FOOTPRINT_FLAGS] = as_float(cell == own_cell ? level : level | IN_OTHER_CELL);
              row[FOOTPRINT_CELL] = as_float(cell);
            }
      }
    }
  }
  if (rows) return;
  for (uint lane = 0; lane < WIDTH; ++lane) {
    const float3 lane_low = LANE3(low, lane);
    const float3 lane_high = LANE3(high, lane);
    for (uint axis = 0; axis < 3; ++axis) {
      const float l = axis == 0 ? lane_low.x : axis == 1 ? lane_low.y : lane_low.z;
      const float h = axis == 0 ? lane_high.x : axis == 1 ? lane_high.y : lane_high.z;
      report->low[axis] = lane == 0 ? l : min(report->low[axis], l);
      report->high[axis] = lane == 0 ? h : max(report->high[axis], h);
    }
  }
}

// places: [run * buckets + bucket].
KERNEL void count_footprints(const uint n_runs, const uint run_length, const LatticeData lattice,
                             const FootprintLimits limits, const GridData grid, const uint buckets,
                             __global const float* photons, __global const float* landings, __global uint* counts,
                             __global PhotonRunData* reports) {
  const uint run = get_global_id(0);
  if (run < n_runs)
    spread_run(reports[run].photons[OUTCOME_STORED], run_length, photons + photon_in_run(run_length, run, 0, RUN_ROW),
               landings, lattice, limits, grid, buckets, counts + run * buckets, 0, &reports[run]);
}

KERNEL void place_footprints(const uint n_runs, const uint run_length, const LatticeData lattice,
                             const FootprintLimits limits, const GridData grid, const uint buckets,
                             __global const float* photons, __global const float* landings, __global uint* places,
                             __global PhotonRunData* reports, __global float* rows) {
  const uint run = get_global_id(0);
  if (run < n_runs)
    spread_run(reports[run].photons[OUTCOME_STORED], run_length, photons + photon_in_run(run_length, run, 0, RUN_ROW),
               landings, lattice, limits, grid, buckets, places + run * buckets, rows, &reports[run]);
}
