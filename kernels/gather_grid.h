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

// Adds a batch of photons, those that count, each by its weight.
FUNCTION void add_weighted(__global const float* photons, const BatchInt counts, const BatchFloat weight, Sums* sums) {
  sums->minus_count += counts;
  const BatchFloat red = fma(weight, load_batch(photons + (PHOTON_POWER + 0) * MAP_BLOCK), sums->red);
  const BatchFloat green = fma(weight, load_batch(photons + (PHOTON_POWER + 1) * MAP_BLOCK), sums->green);
  const BatchFloat blue = fma(weight, load_batch(photons + (PHOTON_POWER + 2) * MAP_BLOCK), sums->blue);
  sums->red = counts ? red : sums->red;
  sums->green = counts ? green : sums->green;
  sums->blue = counts ? blue : sums->blue;
}

#endif
