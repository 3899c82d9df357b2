// Stage camera_generate: one ray for each pixel of a range, all of the same sample index.
// Reads: the camera. Writes: queue rays [0, count), slot = pixel.
#include "queue.h"
#include "sampler.h"
#include "types.h"

// `pixel_jitter`: two sequences started at the sample; jitter 0: the pixel's centre. `path_seed` differs between passes
// and, for independent sampling, between samples.
__kernel void camera_generate(__global const CameraData* camera, const uint first_pixel, const uint count,
                              const uint stride, const uint jitter, const uint path_seed, const uint media,
                              const float jitter_x, const float jitter_y, __global float* rays) {
  const uint i = get_global_id(0) * WIDTH;
  if (i >= count) return;
  const Uint pixel = LANES + (first_pixel + i);
  const Uint row = pixel / camera->width;
  const Uint column = pixel - row * camera->width;
  const Uint path = hash_pair(pixel, (Uint)path_seed);

  // One point of a two-dimensional sequence for all pixels, shifted at random in each (Cranley and Patterson 1976).
  const Float shifted_x = unit_float(hash32(path + 1)) + jitter_x;
  const Float shifted_y = unit_float(hash32(path + 2)) + jitter_y;
  const Float jx = jitter ? shifted_x - floor(shifted_x) : 0.5f;
  const Float jy = jitter ? shifted_y - floor(shifted_y) : 0.5f;
  const Float x = fma(TO_FLOAT(AS_INT(column)) + jx, (Float)camera->step_x, (Float)camera->left);
  const Float y = fma(TO_FLOAT(AS_INT(row)) + jy, (Float)-camera->step_y, (Float)camera->top);
  const Vec3 right = make_vec3(camera->right[0], camera->right[1], camera->right[2]);
  const Vec3 up = make_vec3(camera->up[0], camera->up[1], camera->up[2]);
  const Vec3 forward = make_vec3(camera->forward[0], camera->forward[1], camera->forward[2]);

  store3(rays, RAY_ORIGIN, stride, i, make_vec3(camera->eye[0], camera->eye[1], camera->eye[2]));
  store3(rays, RAY_DIRECTION, stride, i, normalize3(along3(along3(forward, x, right), y, up)));
  store1(rays, RAY_T_MIN, stride, i, 0.0f);
  store3(rays, RAY_WEIGHT, stride, i, make_vec3(1.0f, 1.0f, 1.0f));
  store_bits(rays, RAY_MEDIA, stride, i, media);
  store_bits(rays, RAY_FROM, stride, i, NO_INDEX);
  store_bits(rays, RAY_PATH, stride, i, path);
  store_bits(rays, RAY_SLOT, stride, i, pixel);
}
