// kernels/gather.h by itself: the irradiance at each query, six floats for its place and its normal. WIDTH queries a
// work-item.
#include "gather.h"

KERNEL void gather_at(const uint count, __global const float* queries PHOTON_MAP_PARAMETERS,
                      __global float* irradiance) {
  const uint first = get_global_id(0) * WIDTH;
  const uint end = min(count, first + WIDTH);
  if (first >= end) return;
  const PhotonMap map = PHOTON_MAP;
  Vec3 p = make_vec3(0.0f, 0.0f, 0.0f), n = p;
  for (uint i = first; i < end; ++i) {
    set_lane3(&p, i - first, vload3(2 * i, queries));
    set_lane3(&n, i - first, vload3(2 * i + 1, queries));
  }
  ulong gathered = 0, pairs = 0;
  const Mask which = lanes_below(first, end) & within_reach(&map, p);
  const Vec3 found = gathered_irradiance(&map, p, n, which, &gathered, &pairs);
  for (uint i = first; i < end; ++i) vstore3(LANE3(found, i - first), i, irradiance);
}
