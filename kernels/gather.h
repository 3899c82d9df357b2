// The caustic's irradiance at a place, from the photon map: from the photons within a fixed radius or those whose
// footprints cover it (a grid), or from the k nearest (a tree). The SIMD is inside the ray: eight photons at a time.
#ifndef VITRUM_GATHER_H
#define VITRUM_GATHER_H

#include "photon_map.h"
#include "switches.h"

// Photons and their power, eight at a time.
typedef struct {
  float8 red, green, blue;
  int8 minus_count;
} Sums;

FUNCTION Sums no_sums(void) {
  Sums sums;
  sums.red = 0.0f;
  sums.green = 0.0f;
  sums.blue = 0.0f;
  sums.minus_count = 0;
  return sums;
}

FUNCTION float sum8(float8 v) {
  return ((v.s0 + v.s4) + (v.s1 + v.s5)) + ((v.s2 + v.s6) + (v.s3 + v.s7));
}

FUNCTION uint photons_in(const Sums* sums) {
  const int4 halves = sums->minus_count.lo + sums->minus_count.hi;
  return (uint)-(halves.s0 + halves.s1 + halves.s2 + halves.s3);
}

FUNCTION float3 total_power(const Sums* sums) { return (float3)(sum8(sums->red), sum8(sums->green), sum8(sums->blue)); }

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

// A kernel lists `PHOTON_MAP_PARAMETERS` and starts with `const PhotonMap map = PHOTON_MAP;`. The host sets the arguments
// in the same order (src/render/photon_pass.cpp).

#endif
