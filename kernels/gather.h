// What the ways to gather photons share: the surface that they are gathered for, and what becomes of their sum.
#ifndef VITRUM_GATHER_H
#define VITRUM_GATHER_H

#include "queue.h"
#include "film.h"
#include "photon_map.h"

// Power of photons, eight at a time.
typedef struct {
  float8 red, green, blue;
} Sums;

FUNCTION float3 receiver_diffuse(__global const float* scatter, uint stride, uint i) {
  return triple_at(scatter, SCATTER_DIFFUSE, stride, i);
}

FUNCTION int is_black(float3 colour) { return colour.x <= 0.0f && colour.y <= 0.0f && colour.z <= 0.0f; }

FUNCTION Sums no_sums(void) {
  Sums sums;
  sums.red = 0.0f;
  sums.green = 0.0f;
  sums.blue = 0.0f;
  return sums;
}

FUNCTION float sum8(float8 v) {
  return ((v.s0 + v.s4) + (v.s1 + v.s5)) + ((v.s2 + v.s6) + (v.s3 + v.s7));
}

// The irradiance sums * per_area, and rho_d / pi of it as radiance.
FUNCTION void add_caustic(const Sums* sums, float per_area, float3 diffuse, __global float* shares, uint stride,
                          uint i) {
  const float3 power = (float3)(sum8(sums->red), sum8(sums->green), sum8(sums->blue));
  const float3 radiance = diffuse * power * (per_area * 0.318309886183790672f);
  shares[(SHARE_BEAUTY + 0) * stride + i] += radiance.x;
  shares[(SHARE_BEAUTY + 1) * stride + i] += radiance.y;
  shares[(SHARE_BEAUTY + 2) * stride + i] += radiance.z;
  shares[(SHARE_CAUSTICS + 0) * stride + i] += radiance.x;
  shares[(SHARE_CAUSTICS + 1) * stride + i] += radiance.y;
  shares[(SHARE_CAUSTICS + 2) * stride + i] += radiance.z;
}

#endif
