// The first triangle that a ray meets, and what lies there.
#ifndef VITRUM_TRACE_MESH_H
#define VITRUM_TRACE_MESH_H

#include "contacts.h"
#include "surface.h"
#include "tree.h"

FUNCTION __global const TriangleData* triangle_of(const Scene scene, const Hit hit) {
  const uint mesh = hit.shape - (scene.n_spheres + scene.n_flats);
  return &scene.triangles[scene.meshes[mesh].first_triangle + hit.primitive];
}

FUNCTION float3 triangle_normal(const Scene scene, __global const TriangleData* triangle) {
  const float3 a = vload3(triangle->position[0], scene.positions);
  return normalize(cross(vload3(triangle->position[1], scene.positions) - a,
                         vload3(triangle->position[2], scene.positions) - a));
}

// Puts what a triangle is at the place of a hit into one lane.
FUNCTION void set_mesh_surface(const Scene scene, const Ray* ray, const Hit hit, uint lane, SurfacePacket* surface) {
  __global const TriangleData* triangle = triangle_of(scene, hit);
  const float3 a = vload3(triangle->position[0], scene.positions);
  const float3 b = vload3(triangle->position[1], scene.positions);
  const float3 c = vload3(triangle->position[2], scene.positions);
  const float w = 1.0f - hit.u - hit.v;
  const float3 position = fma((float3)(w), a, fma((float3)(hit.u), b, hit.v * c));
  const float3 geometric = triangle_normal(scene, triangle);
  float3 shading = geometric;
  if (triangle->normal[0] != NO_INDEX) {
    const float3 n = fma((float3)(w), vload3(triangle->normal[0], scene.normals),
                         fma((float3)(hit.u), vload3(triangle->normal[1], scene.normals),
                             hit.v * vload3(triangle->normal[2], scene.normals)));
    if (dot(n, geometric) > 1e-6f) shading = normalize(n);
  }
  const float3 largest = fmax(fmax(fabs(a), fabs(b)), fmax(fabs(c), fabs(ray->origin)));
  SET_LANE(surface->t, float, lane, hit.t);
  set_lane3(&surface->position, lane, position);
  set_lane3(&surface->geometric_normal, lane, geometric);
  set_lane3(&surface->shading_normal, lane, shading);
  SET_LANE(surface->material, uint, lane, triangle->material);
  SET_LANE(surface->error, float, lane, SURFACE_ROUNDING * fmax(largest.x, fmax(largest.y, largest.z)));
  SET_LANE(surface->from, uint, lane, NO_INDEX);
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

// What lies within the rounding of the transparent surface in `lane` belongs to the same event: replaces it by an opaque
// surface, or notes the further borders.
FUNCTION void find_contacts(const Scene scene, const Ray* ray, const Hit first, uint lane, SurfacePacket* surface) {
  const float3 normal = LANE3(surface->geometric_normal, lane);
  const float along = dot(ray->direction, normal);
  const float band = LANE(surface->error, float, lane) / fmax(fabs(along), LEAST_COSINE);
  Hit near[TREE_MAX_HITS];
  const uint n = tree_hits_within(ray, scene.nodes, scene.leaves, first.t, first.t + band, near);
  uint contacts = 0;
  uint places = 0;
  uint seen_shape[MAX_CONTACTS + 1];
  uint seen_entering[MAX_CONTACTS + 1];
  uint seen = 1;
  seen_shape[0] = first.shape;
  seen_entering[0] = along < 0.0f;
  for (uint k = 0; k < n; ++k) {
    if (near[k].t <= ray->t_min) continue;
    __global const TriangleData* triangle = triangle_of(scene, near[k]);
    if (scene.materials[triangle->material].surface != SURFACE_DIELECTRIC) {
      set_mesh_surface(scene, ray, near[k], lane, surface);
      return;
    }
    // Triangles that share an edge are one border.
    const uint entering = dot(ray->direction, triangle_normal(scene, triangle)) < 0.0f;
    int known = 0;
    for (uint s = 0; s < seen; ++s) known |= seen_shape[s] == near[k].shape && seen_entering[s] == entering;
    if (known || places == MAX_CONTACTS) continue;
    seen_shape[seen] = near[k].shape;
    seen_entering[seen++] = entering;
    contacts |= packed_contact(scene.materials[triangle->material].medium, entering, places++);
  }
  SET_LANE(surface->contacts, uint, lane, contacts);
}

#endif

// Replaces the exact shape in `lane` by a triangle that comes before it.
FUNCTION void trace_mesh(const Scene scene, const Ray* ray, uint lane, SurfacePacket* surface) {
  Hit hit;
  hit.t = LANE(surface->t, float, lane);
  hit.shape = LANE(surface->from, uint, lane);
  hit.primitive = 0;
#if HAS_CONTACTS
  const float t_exact = hit.t;
  const int exact_is_opaque =
      scene.materials[LANE(surface->material, uint, lane)].surface != SURFACE_DIELECTRIC;
#endif
  const int found = tree_closest(ray, scene.nodes, scene.leaves, &hit);
#if HAS_CONTACTS
  if (hit.shape == NO_INDEX || (!found && exact_is_opaque)) return;
  const int opaque = found && scene.materials[triangle_of(scene, hit)->material].surface != SURFACE_DIELECTRIC;
  if (found && !opaque && exact_is_opaque) {
    // An opaque exact shape in contact with the glass wins.
    const float3 size = fmax(fabs(fma((float3)(hit.t), ray->direction, ray->origin)), fabs(ray->origin));
    const float cosine = fabs(dot(ray->direction, triangle_normal(scene, triangle_of(scene, hit))));
    const float band = SURFACE_ROUNDING * fmax(size.x, fmax(size.y, size.z)) / fmax(cosine, LEAST_COSINE);
    if (t_exact <= hit.t + band) return;
  }
  if (found) set_mesh_surface(scene, ray, hit, lane, surface);
  if (!opaque) find_contacts(scene, ray, hit, lane, surface);
#else
  if (found) set_mesh_surface(scene, ray, hit, lane, surface);
#endif
}

#endif
