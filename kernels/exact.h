// Exact shapes: where rays meet spheres and flat shapes.
#ifndef VITRUM_EXACT_H
#define VITRUM_EXACT_H

#include "packet.h"
#include "scene.h"

// Distance to the first point of the sphere beyond t_min, INFINITY if there is none. `leaving`: the ray starts on this
// very sphere; then the only other point is known without cancellation, and the start itself is never met again.
// Haines et al., "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems, 2019: the centre's distance
// from the ray as a vector.
FUNCTION Float sphere_distance(__global const SphereData* sphere, const RayPacket rays, const Mask leaving) {
  const Vec3 to_centre = subtract3(uniform3(sphere->centre), rays.origin);
  const Float along = dot3(to_centre, rays.direction);
  const Float t_other = along > 0.0f ? 2.0f * along : INFINITY;
  // Rays inside of a ball mostly come in company.
  if (!ANY(leaving == 0)) return t_other;
  const Vec3 across = along3(to_centre, -along, rays.direction);
  const Float room = fma((Float)sphere->radius, (Float)sphere->radius, -dot3(across, across));
  const Float half_chord = sqrt(room > 0.0f ? room : 0.0f);
  const Float t_near = along - half_chord;
  const Float t_far = along + half_chord;
  const Float t_first = t_near > rays.t_min ? t_near : t_far > rays.t_min ? t_far : INFINITY;
  return leaving ? t_other : room >= 0.0f ? t_first : INFINITY;
}

typedef struct {
  Float t;                     // INFINITY: missed
  Float u, v;                  // in the shape's own coordinates
} FlatHit;

// Where rays meet the flat shape beyond t_min. A ray that leaves the shape never meets it again. u and v only where they
// are wanted or decide.
FUNCTION FlatHit flat_hit(__global const FlatData* flat, const RayPacket rays, const Mask leaving, const int with_uv) {
  const Vec3 normal = uniform3(flat->normal);
  const Vec3 from_point = subtract3(rays.origin, uniform3(flat->point));
  FlatHit hit;
  // A ray in the plane gives NaN or infinity, which compare false below.
  hit.t = -dot3(normal, from_point) / dot3(normal, rays.direction);
  hit.u = 0.0f;
  hit.v = 0.0f;
  if (with_uv || flat->kind != FLAT_PLANE) {
    const Vec3 p = along3(from_point, hit.t, rays.direction);
    hit.u = dot3(p, uniform3(flat->u_axis));
    hit.v = dot3(p, uniform3(flat->v_axis));
  }
  Mask met = (hit.t > rays.t_min) & (hit.t < INFINITY) & (leaving == 0);
  if (flat->kind == FLAT_TRIANGLE) met &= (hit.u >= 0.0f) & (hit.v >= 0.0f) & (hit.u + hit.v <= 1.0f);
  if (flat->kind == FLAT_PARALLELOGRAM) met &= (hit.u >= 0.0f) & (hit.v >= 0.0f) & (hit.u <= 1.0f) & (hit.v <= 1.0f);
  if (flat->kind == FLAT_DISC) met &= fma(hit.u, hit.u, hit.v * hit.v) <= 1.0f;
  hit.t = met ? hit.t : INFINITY;
  return hit;
}

// Is there an exact shape, of whatever material, in (t_min, t_max)? Glass too: shadow rays take it as opaque, its light
// is the photons' business. `from` is the exact shape that the ray leaves, or NO_INDEX.
FUNCTION Mask exact_any_hit(const Scene scene, const RayPacket rays, const Uint from) {
  Mask met = 0;
  for (uint i = 0; i < scene.n_spheres; ++i) met |= sphere_distance(&scene.spheres[i], rays, from == i) < rays.t_max;
  for (uint i = 0; i < scene.n_flats; ++i)
    met |= flat_hit(&scene.flats[i], rays, from == scene.n_spheres + i, 0).t < rays.t_max;
  return met;
}

#endif
