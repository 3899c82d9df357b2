// Reading and writing the queues of queue_fields.h, a packet of WIDTH entries at a time.
#ifndef VITRUM_QUEUE_H
#define VITRUM_QUEUE_H

#include "portability.h"
#include "queue_fields.h"
#include "ray.h"

typedef struct {
  Vec3 origin, direction;
  Float t_min, t_max;
} RayPacket;

FUNCTION Float load1(__global const float* array, uint field, uint stride, uint i) {
  return LOAD(array, field * stride + i);
}

FUNCTION Vec3 load3(__global const float* array, uint field, uint stride, uint i) {
  return make_vec3(load1(array, field, stride, i), load1(array, field + 1, stride, i),
                   load1(array, field + 2, stride, i));
}

FUNCTION Uint load_bits(__global const float* array, uint field, uint stride, uint i) {
  return AS_UINT(load1(array, field, stride, i));
}

FUNCTION void store1(__global float* array, uint field, uint stride, uint i, Float value) {
  STORE(array, field * stride + i, value);
}

FUNCTION void store3(__global float* array, uint field, uint stride, uint i, Vec3 value) {
  store1(array, field, stride, i, value.x);
  store1(array, field + 1, stride, i, value.y);
  store1(array, field + 2, stride, i, value.z);
}

FUNCTION void store_bits(__global float* array, uint field, uint stride, uint i, Uint value) {
  store1(array, field, stride, i, AS_FLOAT(value));
}

FUNCTION RayPacket load_rays(__global const float* rays, uint stride, uint i) {
  RayPacket packet;
  packet.origin = load3(rays, RAY_ORIGIN, stride, i);
  packet.direction = load3(rays, RAY_DIRECTION, stride, i);
  packet.t_min = load1(rays, RAY_T_MIN, stride, i);
  packet.t_max = INFINITY;
  return packet;
}

#ifdef __OPENCL_VERSION__
// Three fields of one entry, for what is not done in packets.
FUNCTION float3 triple_at(__global const float* array, uint field, uint stride, uint i) {
  return (float3)(array[field * stride + i], array[(field + 1) * stride + i], array[(field + 2) * stride + i]);
}

// One ray of a packet, for the tree.
FUNCTION Ray lane_ray(const RayPacket packet, uint lane) {
  Ray ray;
  ray.origin = (float3)(LANE(packet.origin.x, float, lane), LANE(packet.origin.y, float, lane),
                        LANE(packet.origin.z, float, lane));
  ray.direction = (float3)(LANE(packet.direction.x, float, lane), LANE(packet.direction.y, float, lane),
                           LANE(packet.direction.z, float, lane));
  ray.t_min = LANE(packet.t_min, float, lane);
  ray.t_max = LANE(packet.t_max, float, lane);
  return ray;
}
#endif

// The lanes that hold one of the `count` entries.
FUNCTION Mask lanes_below(uint i, uint count) { return LANES + i < count; }

#endif
