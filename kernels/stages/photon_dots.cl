// Stage photon_dots: the photon map as white dots, seen from the scene's camera with nothing in the way.
// Reads: unsorted photons. Writes: dots, one float a pixel, 1 where a photon falls. All writers write the same.
#include "photon_map.h"
#include "queue.h"
#include "types.h"

__kernel void photon_dots(const uint count, __global const float8* photons, __global const CameraData* camera,
                          __global float* dots) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  const float8 photon = photons[i];
  const float3 d = (float3)(photon.s0 - camera->eye[0], photon.s1 - camera->eye[1], photon.s2 - camera->eye[2]);
  const float z = d.x * camera->forward[0] + d.y * camera->forward[1] + d.z * camera->forward[2];
  if (!(z > 0.0f)) return;
  const float x = (d.x * camera->right[0] + d.y * camera->right[1] + d.z * camera->right[2]) / z;
  const float y = (d.x * camera->up[0] + d.y * camera->up[1] + d.z * camera->up[2]) / z;
  const float column = floor((x - camera->left) / camera->step_x);
  const float row = floor((camera->top - y) / camera->step_y);
  if (column < 0.0f || row < 0.0f || column >= (float)camera->width || row >= (float)camera->height) return;
  dots[(uint)row * camera->width + (uint)column] = 1.0f;
}
