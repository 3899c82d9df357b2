// Numbers in [0,1) that follow from (seed, sequence, index, dimension) alone.
//
// Dimensions
//   photons  0, 1  direction within the cone (point, area) or place on the disc (directional)
//            2     choices between reflection and refraction along the path
//            3, 4  place on an area light;  5  face of a mesh light
//   camera   0, 1  place in the pixel;  the place on light l after d surfaces on path h: a hash of (pixel, h, l)
//
// Low-discrepancy: Kronecker's sequence, u_d(i) = frac(shift_d + i alpha_d) in 64-bit fixed point, alpha from the
// generalised golden ratio (Roberts 2018: R2, R4); each replicate has its own random shift.
#ifndef VITRUM_SAMPLER_H
#define VITRUM_SAMPLER_H

#include "portability.h"
#include "sequence.h"

// 32-bit finaliser with full avalanche (Wellons, "hash-prospector", lowbias32).
FUNCTION Uint hash32(Uint x) {
  x ^= x >> 16;
  x *= 0x21f0aaadu;
  x ^= x >> 15;
  x *= 0x735a2d97u;
  x ^= x >> 15;
  return x;
}

FUNCTION Uint hash_pair(Uint a, Uint b) { return hash32(a ^ (hash32(b) + 0x9e3779b9u + (a << 6) + (a >> 2))); }

// The top 24 bits as a float in [0, 1).
FUNCTION Float unit_float(Uint bits) { return TO_FLOAT(AS_INT(bits >> 8)) * 5.9604644775390625e-8f; }

// Numbers `first` to `first + WIDTH` of a sequence.
FUNCTION Uint sequence_bits(__global const SequenceData* sequence, const uint first) {
  const ulong start = sequence->start;
  const ulong alpha = sequence->alpha;
  if (alpha == 0) return hash_pair((Uint)(uint)(start >> 32), hash_pair((Uint)(uint)start, LANES + first));
  return TO_UINT((start + first * alpha + TO_ULONG(LANES) * alpha) >> 32);
}

FUNCTION Float sequence_float(__global const SequenceData* sequence, const uint first) {
  return unit_float(sequence_bits(sequence, first));
}

// sin and cos of 2 pi u for u in [0,1), within 2 ulp of 1, the same on every device.
FUNCTION void sin_cos_turn(Float u, Float* sine, Float* cosine) {
  const Float quarter = floor(fma((Float)4.0f, u, (Float)0.5f));
  const Float x = fma((Float)-0.25f, quarter, u) * 6.28318530717958647692f;  // in [-pi/4, pi/4]
  const Float x2 = x * x;
  Float s = fma(x2, (Float)-1.9515295891e-4f, (Float)8.3321608736e-3f);
  s = x * fma(x2, fma(x2, s, (Float)-1.6666654611e-1f), (Float)1.0f);
  Float c = fma(x2, (Float)2.443315711809948e-5f, (Float)-1.388731625493765e-3f);
  c = fma(x2, fma(x2, fma(x2, c, (Float)4.166664568298827e-2f), (Float)-0.5f), (Float)1.0f);
  const Int k = TO_INT(quarter);
  const Mask odd = (k & 1) != 0;
  const Float s0 = odd ? c : s;
  const Float c0 = odd ? s : c;
  *sine = (k & 2) != 0 ? -s0 : s0;
  *cosine = ((k + 1) & 2) != 0 ? -c0 : c0;
}

#endif
