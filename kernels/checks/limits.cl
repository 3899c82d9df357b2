// What a device can do at best, for `vitrum bench limits`: arithmetic that waits for nothing, and memory read in a row.
#include "portability.h"

// 24 WIDTH `steps` operations by each work-item, in twelve chains: as many as hide what one takes, and fit the registers.
__kernel void multiply_and_add(const uint count, const uint steps, __global float* results) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  const Float scale = 0.999f + 1e-6f * (float)i;
  Float a0 = 1.0f, a1 = 2.0f, a2 = 3.0f, a3 = 4.0f, a4 = 5.0f, a5 = 6.0f;
  Float b0 = 1.5f, b1 = 2.5f, b2 = 3.5f, b3 = 4.5f, b4 = 5.5f, b5 = 6.5f;
  for (uint step = 0; step < steps; ++step) {
    a0 = fma(a0, scale, 0.5f);
    a1 = fma(a1, scale, 0.5f);
    a2 = fma(a2, scale, 0.5f);
    a3 = fma(a3, scale, 0.5f);
    a4 = fma(a4, scale, 0.5f);
    a5 = fma(a5, scale, 0.5f);
    b0 = fma(b0, scale, 0.5f);
    b1 = fma(b1, scale, 0.5f);
    b2 = fma(b2, scale, 0.5f);
    b3 = fma(b3, scale, 0.5f);
    b4 = fma(b4, scale, 0.5f);
    b5 = fma(b5, scale, 0.5f);
  }
  STORE(results, i * WIDTH, a0 + a1 + a2 + a3 + a4 + a5 + b0 + b1 + b2 + b3 + b4 + b5);
}

// Each work-item reads `floats` in a row, a multiple of 64, `times` over.
__kernel void read_memory(const uint count, const uint floats, const uint times, __global const float* values,
                          __global float* results) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  __global const float* own = values + (ulong)i * floats;
  float16 a = 0.0f, b = 0.0f, c = 0.0f, d = 0.0f;
  for (uint time = 0; time < times; ++time)
    for (uint k = 0; k < floats; k += 64) {
      a += vload16(0, own + k);
      b += vload16(0, own + k + 16);
      c += vload16(0, own + k + 32);
      d += vload16(0, own + k + 48);
    }
  vstore16(a + b + c + d, i, results);
}

// Each copies as many.
__kernel void copy_memory(const uint count, const uint floats, __global const float* from, __global float* to) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  for (ulong k = (ulong)i * floats; k < (ulong)(i + 1) * floats; k += 16) vstore16(vload16(0, from + k), 0, to + k);
}
