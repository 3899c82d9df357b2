// Stage camera_queue: gathers the rays that go on into the next queue, in the order in which they came, so that nothing
// depends on timing. Each work-item minds one block of entries: count, add up over the blocks, then copy.
#include "film.h"
#include "queue.h"
#include "blocks.h"
#include "types.h"

// Counts the children of each block. Reads: children [0, count). Writes: counts[block].
__kernel void camera_count(const uint count, const uint stride, __global const float* children,
                           __global uint* counts) {
  const uint block = get_global_id(0);
  const uint first = block * BLOCK;
  if (first >= count) return;
  const uint last = min(first + BLOCK, count);
  uint n = 0;
  for (uint i = first; i < last; ++i) {
    const uint which = bits_at(children, CHILD_WHICH, stride, i);
    n += (which & 1u) + (which >> 1);
  }
  counts[block] = n;
}

// Appends the children of each block to the next queue from `base` on.
__kernel void camera_append(const uint count, const uint stride, __global const float* rays,
                            __global const float* surfaces, __global const float* children,
                            __global const uint* counts, const uint base, const uint next_stride,
                            __global float* next) {
  const uint block = get_global_id(0);
  const uint first = block * BLOCK;
  if (first >= count) return;
  const uint last = min(first + BLOCK, count);
  uint to = base + counts[block];
  for (uint i = first; i < last; ++i) {
    const uint which = bits_at(children, CHILD_WHICH, stride, i);
    if (which == 0) continue;
    const uint path = bits_at(rays, RAY_PATH, stride, i);
    const uint from = bits_at(surfaces, SURFACE_FROM, stride, i);
    const float error = surfaces[SURFACE_ERROR * stride + i];
    for (uint side = 0; side < 2; ++side) {
      if ((which >> side & 1u) == 0) continue;
      const uint direction = side == 0 ? CHILD_REFLECTED : CHILD_REFRACTED;
      const uint weight = side == 0 ? CHILD_WEIGHT_REFLECTED : CHILD_WEIGHT_REFRACTED;
      const uint stack = side == 0 ? CHILD_STACK_REFLECTED : CHILD_STACK_REFRACTED;
      float cosine = 0.0f;
      for (uint axis = 0; axis < 3; ++axis) {
        const float d = children[(direction + axis) * stride + i];
        next[(RAY_ORIGIN + axis) * next_stride + to] = surfaces[(SURFACE_POSITION + axis) * stride + i];
        next[(RAY_DIRECTION + axis) * next_stride + to] = d;
        next[(RAY_WEIGHT + axis) * next_stride + to] = children[(weight + axis) * stride + i];
        cosine = fma(d, surfaces[(SURFACE_NORMAL + axis) * stride + i], cosine);
      }
      next[RAY_T_MIN * next_stride + to] = from == NO_INDEX ? error / fmax(fabs(cosine), LEAST_COSINE) : error;
      next[RAY_MEDIA * next_stride + to] = children[stack * stride + i];
      next[RAY_FROM * next_stride + to] = as_float(from);
      // A number of its own for each branch of the path (Wellons' finaliser would do; a multiplication is enough here,
      // since every use hashes it again).
      next[RAY_PATH * next_stride + to] = as_float(path * 0x9e3779b1u + 0x7f4a7c15u + side);
      next[RAY_SLOT * next_stride + to] = rays[RAY_SLOT * stride + i];
      ++to;
    }
  }
}
