// The photon map as a grid. Included by gather.h.
#ifndef VITRUM_GATHER_GRID_H
#define VITRUM_GATHER_GRID_H

typedef struct {
  uint count;
  GridData grid;
  float radius;                // [m]
  float4 low, high;            // corners of a box around all photons [m]
  __global const uint* first_of_cell;
  __global const BucketData* buckets;
  __global const float* photons;
} PhotonMap;

#define PHOTON_MAP_PARAMETERS                                                                                        \
  , const uint n_photons, const GridData grid, const float radius, const float4 low, const float4 high,              \
      __global const uint *first_of_cell, __global const BucketData *photon_buckets, __global const float *map_photons
#define PHOTON_MAP { n_photons, grid, radius, low, high, first_of_cell, photon_buckets, map_photons }

// Where there may be photons at all.
FUNCTION Mask within_reach(const PhotonMap* map, const Vec3 p) {
  return (p.x >= map->low.x - map->radius) & (p.y >= map->low.y - map->radius) & (p.z >= map->low.z - map->radius) &
         (p.x <= map->high.x + map->radius) & (p.y <= map->high.y + map->radius) & (p.z <= map->high.z + map->radius);
}

// Adds eight photons of a bucket from `i` on, those that count, each by its weight.
FUNCTION void add_weighted(__global const float* map, uint stride, uint i, int8 counts, float8 weight, Sums* sums) {
  sums->minus_count += counts;
  const float8 counted = counts ? weight : 0.0f;
  // What lies behind the last photon may be no number, which a weight of 0 would not take out.
  const float8 red = vload8(0, map + (PHOTON_POWER + 0) * stride + i);
  const float8 green = vload8(0, map + (PHOTON_POWER + 1) * stride + i);
  const float8 blue = vload8(0, map + (PHOTON_POWER + 2) * stride + i);
  sums->red = fma(counted, counts ? red : 0.0f, sums->red);
  sums->green = fma(counted, counts ? green : 0.0f, sums->green);
  sums->blue = fma(counted, counts ? blue : 0.0f, sums->blue);
}

#endif
