// WIDTH rays side by side, and what they meet, as the stages carry them: in registers only.
#ifndef VITRUM_PACKET_H
#define VITRUM_PACKET_H

#include "portability.h"

typedef struct {
  Vec3 origin;                 // [m], the unshifted points that the rays leave: path lengths are measured from them
  Vec3 direction;              // unit length
  Float t_min;                 // [m], exact shapes at t <= t_min belong to the surface that a ray leaves
  Float t_max;                 // [m], hits at t >= t_max are not looked for
} RayPacket;

// As meshes take them: what a ray leaves is known by name, so that its neighbours may come at once.
typedef struct {
  RayPacket rays;              // t_min >= 0
  Uint shape, primitive;       // the triangle that a ray leaves; all bits set: it leaves none
  Uint front;                  // 1: to the triangle's front
  Float error;                 // [m] that the origin may be off the triangle's plane
} MeshRays;

typedef struct {
  Float t;                     // [m], INFINITY: nothing
  Uint shape;                  // index into the scene's shapes
  Uint primitive;              // triangle of a mesh; 0 for exact shapes
  Float u, v;                  // barycentric weights of corners b and c
  Uint front;                  // of a triangle: 1: the ray meets its front, where the corners go round anticlockwise
} HitPacket;

// One of them. Hits are ordered by (t, shape, primitive), so that a picture does not hang on the order of the tree.
typedef struct {
  float t;
  uint shape, primitive;
  float u, v;
  uint front;
} Hit;

FUNCTION Hit hit_of(const HitPacket* hits, const uint lane) {
  Hit hit;
  hit.t = LANE(hits->t, float, lane);
  hit.shape = LANE(hits->shape, uint, lane);
  hit.primitive = LANE(hits->primitive, uint, lane);
  hit.u = LANE(hits->u, float, lane);
  hit.v = LANE(hits->v, float, lane);
  hit.front = LANE(hits->front, uint, lane);
  return hit;
}

FUNCTION void set_hit(HitPacket* hits, const uint lane, const Hit hit) {
  SET_LANE(hits->t, float, lane, hit.t);
  SET_LANE(hits->shape, uint, lane, hit.shape);
  SET_LANE(hits->primitive, uint, lane, hit.primitive);
  SET_LANE(hits->u, float, lane, hit.u);
  SET_LANE(hits->v, float, lane, hit.v);
  SET_LANE(hits->front, uint, lane, hit.front);
}

#endif
