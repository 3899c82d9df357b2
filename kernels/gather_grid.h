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

#endif
