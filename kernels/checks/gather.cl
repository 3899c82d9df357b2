// kernels/gather.h by itself: the irradiance at each query, six floats for its place and its normal.
#include "gather.h"

__kernel void gather_at(const uint count, __global const float* queries PHOTON_MAP_PARAMETERS,
                        __global float* irradiance) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  const PhotonMap map = PHOTON_MAP;
  const float3 p = vload3(2 * i, queries);
  const int reached = ANY(within_reach(&map, make_vec3(p.x, p.y, p.z)));
  uint photons;
  vstore3(reached ? gathered_irradiance(&map, p, vload3(2 * i + 1, queries), &photons) : (float3)(0.0f), i, irradiance);
}
