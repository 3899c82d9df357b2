// Rays and hits, as every stage sees them. In registers only: nothing here lies in a buffer.
#ifndef VITRUM_RAY_H
#define VITRUM_RAY_H

typedef struct {
  float3 origin;      // [m], the unshifted point that the ray leaves: path lengths are measured from it
  float3 direction;   // unit length
  float t_min;        // [m], hits at t <= t_min belong to the surface that the ray leaves
  float t_max;        // [m], hits at t >= t_max are not looked for
} Ray;

// Hits are ordered by (t, shape, primitive), so that a picture does not hang on the order of the tree.
typedef struct {
  float t;            // [m], INFINITY: nothing
  uint shape;         // index into the scene's shapes
  uint primitive;     // triangle of a mesh; 0 for exact shapes
  float u, v;         // barycentric weights of corners b and c
} Hit;

#endif
