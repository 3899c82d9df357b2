// Pictures on surfaces.
#ifndef VITRUM_TEXTURE_H
#define VITRUM_TEXTURE_H

#include "scene.h"

#if HAS_TEXTURES

// Texel index within [0, n): repeated, or clamped to the border.
FUNCTION Int wrapped(const Int i, const int n, const uint clamped) {
  // After whole turns are taken off, an index is at most one period away.
  if (!clamped) return i < 0 ? i + n : i >= n ? i - n : i;
  return i < 0 ? (Int)0 : i >= n ? (Int)(n - 1) : i;
}

// Reflectance at texture coordinates (u0, v0), v upwards; texel (i, j) has its centre at ((i + 1/2)/w, (j + 1/2)/h).
FUNCTION Vec3 texture_value(const Scene scene, __global const TextureData* texture, const Float u0, const Float v0) {
  const int width = texture->width;
  const int height = texture->height;
  const uint clamped = texture->clamp;
  const Float u = fma((Float)texture->scale[0], u0, (Float)texture->offset[0]);
  const Float v = fma((Float)texture->scale[1], v0, (Float)texture->offset[1]);
  // Whole turns go first, so that no precision is spent on them. A coordinate that is no number reads texel 0.
  const Float turn_u = clamped ? smaller(larger(u, -1.0f), 2.0f) : u - floor(u);
  const Float turn_v = clamped ? smaller(larger(v, -1.0f), 2.0f) : v - floor(v);
  const float shift = texture->bilinear ? 0.5f : 0.0f;
  const Float s = (turn_u == turn_u ? turn_u : 0.0f) * (float)width - shift;
  const Float t = (turn_v == turn_v ? turn_v : 0.0f) * (float)height - shift;
  const Int x = TO_INT(floor(s));
  const Int y = TO_INT(floor(t));
  const Uint column_0 = AS_UINT(wrapped(x, width, clamped));
  const Uint row_0 = texture->first_texel + AS_UINT((height - 1 - wrapped(y, height, clamped)) * width);
  const Uint i00 = 3 * (row_0 + column_0);
  if (!texture->bilinear) return GATHER3(scene.texels, i00);

  const Uint column_1 = AS_UINT(wrapped(x + 1, width, clamped));
  const Uint row_1 = texture->first_texel + AS_UINT((height - 1 - wrapped(y + 1, height, clamped)) * width);
  const Uint i10 = 3 * (row_0 + column_1);
  const Uint i01 = 3 * (row_1 + column_0);
  const Uint i11 = 3 * (row_1 + column_1);
  const Float fs = s - floor(s);
  const Float ft = t - floor(t);
  const Vec3 below = along3(scale3(1.0f - fs, GATHER3(scene.texels, i00)), fs, GATHER3(scene.texels, i10));
  const Vec3 above = along3(scale3(1.0f - fs, GATHER3(scene.texels, i01)), fs, GATHER3(scene.texels, i11));
  return along3(scale3(1.0f - ft, below), ft, above);
}

#endif

#endif
