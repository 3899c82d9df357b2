// Stage film: adds what rays bring home to the planes of the film.
#include "film.h"
#include "queue.h"
#include "types.h"

// Camera rays of the first generation: ray i is pixel first_pixel + i. Each pixel is one work-item's business.
__kernel void film_add(const uint count, const uint stride, const uint first_pixel, const uint film_stride,
                       __global const float* shares, __global float* film) {
  const uint i = get_global_id(0) * WIDTH;
  if (i >= count) return;
  const Mask valid = lanes_below(i, count);
  for (uint plane = 0; plane < SHARE_FIELDS; ++plane) {
    const Float sum = load1(film, plane, film_stride, first_pixel + i);
    store1(film, plane, film_stride, first_pixel + i, valid ? sum + load1(shares, plane, stride, i) : sum);
  }
}

// Later generations: the rays of a pixel stand together; the first of them adds them all, in their order.
__kernel void film_add_runs(const uint count, const uint stride, const uint film_stride, __global const float* rays,
                            __global const float* shares, __global float* film) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  const uint pixel = as_uint(rays[RAY_SLOT * stride + i]);
  if (i > 0 && as_uint(rays[RAY_SLOT * stride + i - 1]) == pixel) return;
  for (uint plane = 0; plane < SHARE_FIELDS; ++plane) {
    float sum = film[plane * film_stride + pixel];
    for (uint k = i; k < count && as_uint(rays[RAY_SLOT * stride + k]) == pixel; ++k)
      sum += shares[plane * stride + k];
    film[plane * film_stride + pixel] = sum;
  }
}

// What the first surface is: albedo (1 where light goes on, in a mirror or in glass), shading normal, distance.
__kernel void film_add_first_hits(const uint count, const uint stride, const uint first_pixel, const uint film_stride,
                                  __global const MaterialData* materials, __global const float* surfaces,
                                  __global const float* scatter, __global float* film) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  const float t = surfaces[SURFACE_T * stride + i];
  if (!(t < INFINITY)) return;
  const uint kind = materials[as_uint(surfaces[SURFACE_MATERIAL * stride + i])].surface;
  const int goes_on = kind == SURFACE_MIRROR || kind == SURFACE_DIELECTRIC;
  const uint pixel = first_pixel + i;
  for (uint c = 0; c < 3; ++c) {
    const float albedo = goes_on ? 1.0f : scatter[(SCATTER_DIFFUSE + c) * stride + i];
    film[(FILM_ALBEDO + c) * film_stride + pixel] += albedo;
    film[(FILM_NORMAL + c) * film_stride + pixel] += scatter[(SCATTER_NORMAL + c) * stride + i];
  }
  film[FILM_DEPTH * film_stride + pixel] += t;
}
