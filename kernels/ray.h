// Rays and hits, as every stage sees them. In registers only: nothing here lies in a buffer.
#ifndef VITRUM_RAY_H
#define VITRUM_RAY_H

typedef struct {
  float3 origin;      // [m], the unshifted point that the ray leaves: path lengths are measured from it
  float3 direction;   // unit length
  float t_min;        // [m], hits at t <= t_min belong to the surface that the ray leaves
  float t_max;        // [m], hits at t >= t_max are not looked for
  // The triangle that the ray leaves; all bits set: it leaves none.
  uint shape, primitive;
  uint front;         // 1: to the triangle's front
  float error;        // [m] that the origin may be off the triangle's plane
} Ray;

// A ray that leaves no triangle.
static Ray free_ray(const float3 origin, const float3 direction, const float t_min, const float t_max) {
  Ray ray;
  ray.origin = origin;
  ray.direction = direction;
  ray.t_min = t_min;
  ray.t_max = t_max;
  ray.shape = ray.primitive = 0xffffffffu;
  ray.front = 0;
  ray.error = 0.0f;
  return ray;
}

// Hits are ordered by (t, shape, primitive), so that a picture does not hang on the order of the tree.
typedef struct {
  float t;            // [m], INFINITY: nothing
  uint shape;         // index into the scene's shapes
  uint primitive;     // triangle of a mesh; 0 for exact shapes
  float u, v;         // barycentric weights of corners b and c
  uint front;         // of a triangle: 1: the ray meets its front, where the corners go round anticlockwise
} Hit;

#endif
