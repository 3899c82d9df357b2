// WIDTH rays side by side, as the stages carry them: in registers only.
#ifndef VITRUM_PACKET_H
#define VITRUM_PACKET_H

#include "portability.h"
#include "ray.h"

typedef struct {
  Vec3 origin;                 // [m], the unshifted points that the rays leave: path lengths are measured from them
  Vec3 direction;              // unit length
  Float t_min;                 // [m], exact shapes at t <= t_min belong to the surface that a ray leaves
  Float t_max;                 // [m], hits at t >= t_max are not looked for
} RayPacket;

#endif
