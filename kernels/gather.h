// The caustic's irradiance at places, from the photon map: from the photons within a fixed radius or those whose
// footprints cover it (a grid), or from the k nearest (a tree). Photons are looked at place by place, a batch of them
// at a time.
#ifndef VITRUM_GATHER_H
#define VITRUM_GATHER_H

#include "photon_map.h"
#include "switches.h"

// Leaves of the tree have 8 photons; blocks of the grid are twice as long, for processors whose vectors are.
#if WIDTH == 16 && CAUSTICS != CAUSTICS_NEAREST
#define BATCH 16
#define BATCH_LANES ((uint16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15))
#else
#define BATCH 8
#define BATCH_LANES ((uint8)(0, 1, 2, 3, 4, 5, 6, 7))
#endif
typedef JOIN(float, BATCH) BatchFloat;
typedef JOIN(int, BATCH) BatchInt;
typedef JOIN(uint, BATCH) BatchUint;
FUNCTION BatchFloat load_batch(__global const float* from) { return JOIN(vload, BATCH)(0, from); }

// Photons and their power, a batch at a time.
typedef struct {
  BatchFloat red, green, blue;
  BatchInt minus_count;
} Sums;

FUNCTION Sums no_sums(void) {
  Sums sums;
  sums.red = 0.0f;
  sums.green = 0.0f;
  sums.blue = 0.0f;
  sums.minus_count = 0;
  return sums;
}

FUNCTION float sum_of_batch(const BatchFloat v) {
#if BATCH == 16
  const float8 half_sum = v.lo + upper8(v);
#else
  const float8 half_sum = v;
#endif
  const float4 fours = half_sum.lo + half_sum.hi;
  return (fours.x + fours.y) + (fours.z + fours.w);
}

FUNCTION uint photons_in(const Sums* sums) {
#if BATCH == 16
  const int8 half_sum = sums->minus_count.lo + as_int8(upper8(as_float16(sums->minus_count)));
#else
  const int8 half_sum = sums->minus_count;
#endif
  const int4 fours = half_sum.lo + half_sum.hi;
  return (uint)-((fours.x + fours.y) + (fours.z + fours.w));
}

FUNCTION float3 total_power(const Sums* sums) {
  return (float3)(sum_of_batch(sums->red), sum_of_batch(sums->green), sum_of_batch(sums->blue));
}

FUNCTION BatchInt came_to_front(const BatchInt packed, float3 n) {
  const BatchFloat along = JOIN(convert_float, BATCH)(DIRECTION_X(packed)) * n.x +
                           JOIN(convert_float, BATCH)(DIRECTION_Y(packed)) * n.y +
                           JOIN(convert_float, BATCH)(DIRECTION_Z(packed)) * n.z;
  return along < 0.0f;
}

FUNCTION BatchFloat distance_off_plane(const BatchFloat dx, const BatchFloat dy, const BatchFloat dz, float3 n) {
  return fabs(dx * n.x + dy * n.y + dz * n.z);
}

#if CAUSTICS == CAUSTICS_NONE
typedef struct {
  uint count;                  // 0
} PhotonMap;
#define PHOTON_MAP_PARAMETERS
#define PHOTON_MAP { 0 }
#elif CAUSTICS == CAUSTICS_NEAREST
#include "gather_nearest.h"
#else
#include "gather_grid.h"
#if CAUSTICS == CAUSTICS_FOOTPRINTS
#include "gather_footprints.h"
#else
#include "gather_within.h"
#endif
#endif

#if CAUSTICS == CAUSTICS_NEAREST || CAUSTICS == CAUSTICS_FOOTPRINTS  // place by place
// Irradiance [W/m2] at places p on the side of unit normals n, in the lanes of `which`; adds the number of photons that
// it is made of to *gathered, and of pairs of them, each twice, to *pairs.
FUNCTION Vec3 gathered_irradiance(const PhotonMap* map, const Vec3 p, const Vec3 n, const Mask which, ulong* gathered,
                                  ulong* pairs) {
  Vec3 irradiance = make_vec3(0.0f, 0.0f, 0.0f);
  FOR_LANES(lane, which) {
    uint photons;
    set_lane3(&irradiance, lane, irradiance_at(map, LANE3(p, lane), LANE3(n, lane), &photons));
    *gathered += photons;
    *pairs += photons * (photons - (ulong)1);
  }
  return irradiance;
}
#endif

// A kernel lists `PHOTON_MAP_PARAMETERS` and starts with `const PhotonMap map = PHOTON_MAP;`. The host sets the
// arguments in the same order (src/render/photon_pass.cpp).

#endif
