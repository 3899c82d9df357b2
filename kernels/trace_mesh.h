// The first triangle that a ray meets, and what lies there.
#ifndef VITRUM_TRACE_MESH_H
#define VITRUM_TRACE_MESH_H

#include "contacts.h"
#include "media.h"
#include "mesh.h"
#include "tree.h"

// Bound of the distance [m] between a place that is computed on the triangle and its plane.
FUNCTION float triangle_error(const float3 a, const float3 b, const float3 c) {
  const float3 largest = fmax(fmax(fabs(a), fabs(b)), fabs(c));
  return SURFACE_ROUNDING * fmax(largest.x, fmax(largest.y, largest.z));
}

// Puts what a triangle is at the place of a hit into one lane.
FUNCTION void set_mesh_surface(const Scene scene, const Hit hit, uint lane, SurfacePacket* surface) {
  __global const TriangleData* triangle = &scene.triangles[hit.primitive];
  const float3 a = corner_of(scene, triangle, 0);
  const float3 b = corner_of(scene, triangle, 1);
  const float3 c = corner_of(scene, triangle, 2);
  const float w = 1.0f - hit.u - hit.v;
  // Near its plane however far the ray has come.
  const float3 position = fma((float3)(hit.v), c - a, fma((float3)(hit.u), b - a, a));
  const float3 geometric = triangle_normal(scene, triangle);
  float3 shading = geometric;
  if (triangle->normal[0] != NO_INDEX) {
    const float3 n = fma((float3)(w), vload3(triangle->normal[0], scene.normals),
                         fma((float3)(hit.u), vload3(triangle->normal[1], scene.normals),
                             hit.v * vload3(triangle->normal[2], scene.normals)));
    if (lane_dot3(n, geometric) > 1e-6f) shading = lane_normalize3(n);
  }
  SET_LANE(surface->t, float, lane, hit.t);
  set_lane3(&surface->position, lane, position);
  set_lane3(&surface->geometric_normal, lane, geometric);
  set_lane3(&surface->shading_normal, lane, shading);
  SET_LANE(surface->material, uint, lane, triangle->material);
  SET_LANE(surface->error, float, lane, triangle_error(a, b, c));
  SET_LANE(surface->entering, int, lane, hit.front ? -1 : 0);
  SET_LANE(surface->from, uint, lane, FROM_MESH | hit.primitive);
#if HAS_TEXTURES
  float u = NAN;
  float v = NAN;
  if (triangle->texcoord[0] != NO_INDEX) {
    const float2 uv = w * vload2(triangle->texcoord[0], scene.texcoords) +
                      hit.u * vload2(triangle->texcoord[1], scene.texcoords) +
                      hit.v * vload2(triangle->texcoord[2], scene.texcoords);
    u = uv.x;
    v = uv.y;
  }
  SET_LANE(surface->u, float, lane, u);
  SET_LANE(surface->v, float, lane, v);
#endif
}

#if HAS_CONTACTS

// How far off each other [m] two surfaces may be found that a ray from `origin` meets at one place, which is within `error`
// of the first: by what the triangle test makes of the way from there (tree.h).
FUNCTION float contact_error(const float error, const float3 origin) {
  const float3 size = fabs(origin);
  return error + SURFACE_ROUNDING * fmax(size.x, fmax(size.y, size.z));
}

// What lies within the rounding of the transparent surface in `lane` belongs to the same event: replaces it by an opaque
// surface, or notes the further borders.
FUNCTION void find_contacts(const Scene scene, const Ray* ray, const Hit first, uint lane, SurfacePacket* surface) {
  const float3 position = LANE3(surface->position, lane);
  const float error = contact_error(LANE(surface->error, float, lane), ray->origin);
  const float cosine = fabs(lane_dot3(ray->direction, LANE3(surface->geometric_normal, lane)));
  Hit near[TREE_MAX_BORDERS];
  const uint n =
      tree_borders_within(ray, scene.nodes, scene.leaves, first.t, first.t + error / cosine, position, error, near);
  const uint first_entering = LANE(surface->entering, int, lane) != 0;
  uint contacts = 0;
  uint places = 0;
  for (uint k = 0; k < n; ++k) {
    __global const TriangleData* triangle = &scene.triangles[near[k].primitive];
    if (scene.materials[triangle->material].surface != SURFACE_DIELECTRIC) {
      set_mesh_surface(scene, near[k], lane, surface);
      return;
    }
    const uint entering = near[k].front;
    if (near[k].shape == first.shape && entering == first_entering) continue;
    if (places < MAX_CONTACTS)
      contacts |= packed_contact(scene.materials[triangle->material].medium, entering, places++);
  }
  SET_LANE(surface->contacts, uint, lane, contacts);
}

#endif

#if HAS_DIELECTRIC

// A ray that has gone into a closed mesh meets its back next, one that has gone out of it its front or nothing. Rounding
// near edges can make it otherwise, in one of two ways.
FUNCTION int is_astray(const Ray* ray, const Hit hit) {
  return hit.t < INFINITY ? hit.shape == ray->shape && hit.front != ray->front : !ray->front;
}

// One: rounding has put the start below the plane of the very triangle that the ray leaves, or back along a ray that grazes
// it, by as much as the ray takes to rise from the plane. There it may still be beyond an edge, and meet a neighbour from
// the side that it came from, or the one again that it met before. It has crossed this surface already.
FUNCTION int is_crossed_already(const Scene scene, const Ray* ray, const Hit hit) {
  if (hit.shape != ray->shape || !(hit.front || ray->front)) return 0;
  const float3 normal = triangle_normal(scene, &scene.triangles[ray->primitive]);
  return hit.t * fabs(lane_dot3(ray->direction, normal)) <= ray->error;
}

// The other: a ray that grazes an edge has slipped past it. It went in, but from where rounding has put it the mesh lies
// behind, or the reverse. Then the stack of media is mended: the ray is on the other side.
FUNCTION uint mended_media(const Scene scene, const Ray* ray, const uint media) {
  const uint medium = scene.materials[scene.triangles[ray->primitive].material].medium;
  return ray->front ? entered(scene, media, medium) : left(media, medium);
}

#endif

// Replaces the exact shape in `lane` by a triangle that comes before it.
FUNCTION void trace_mesh(const Scene scene, const RayPacket* packet, const uint from, uint lane, SurfacePacket* surface,
                         Uint* media) {
  Ray ray = mesh_ray(scene, packet, from, lane);
  Hit exact;
  exact.t = LANE(surface->t, float, lane);
  exact.shape = LANE(surface->from, uint, lane);
  exact.primitive = 0;
#if HAS_CONTACTS
  const int exact_is_opaque =
      scene.materials[LANE(surface->material, uint, lane)].surface != SURFACE_DIELECTRIC;
#endif
  Hit hit = exact;
  int found = tree_closest(&ray, scene.nodes, scene.leaves, &hit);
#if HAS_DIELECTRIC
  if (ray.shape != NO_INDEX && scene.bodies[ray.shape - (scene.n_spheres + scene.n_flats)].closed) {
    while (hit.t < INFINITY && is_crossed_already(scene, &ray, hit)) {
      ray.t_min = hit.t;
      hit = exact;
      found = tree_closest(&ray, scene.nodes, scene.leaves, &hit);
    }
    if (is_astray(&ray, hit)) SET_LANE(*media, uint, lane, mended_media(scene, &ray, LANE(*media, uint, lane)));
  }
#endif
#if HAS_CONTACTS
  int dielectric = !exact_is_opaque;
  if (found) {
    __global const TriangleData* triangle = &scene.triangles[hit.primitive];
    dielectric = scene.materials[triangle->material].surface == SURFACE_DIELECTRIC;
    const float error = contact_error(triangle_error(corner_of(scene, triangle, 0), corner_of(scene, triangle, 1),
                                                     corner_of(scene, triangle, 2)), ray.origin);
    // An opaque exact shape in contact with the glass wins.
    const float gap = (exact.t - hit.t) * fabs(lane_dot3(ray.direction, LANE3(surface->geometric_normal, lane)));
    if (dielectric && exact_is_opaque && gap <= error) return;
    set_mesh_surface(scene, hit, lane, surface);
  }
  if (dielectric && hit.shape != NO_INDEX) find_contacts(scene, &ray, hit, lane, surface);
#else
  if (found) set_mesh_surface(scene, hit, lane, surface);
#endif
}

#endif
