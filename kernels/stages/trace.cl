// Stage trace: the first surface that each ray of a queue meets. Camera rays and photons alike.
// Reads: the scene's shapes, queue rays [0, count). Writes: surfaces [0, count).
#include "contacts.h"
#include "trace_exact.h"
#if HAS_MESH
#include "tree.h"
#endif

// Exact shapes, WIDTH rays at a time.
__kernel void trace_exact(SCENE_PARAMETERS, const uint count, const uint stride, __global const float* rays,
                          __global float* surfaces) {
  const uint i = get_global_id(0) * WIDTH;
  if (i >= count) return;
  const Scene scene = SCENE;
  Float u, v;
  const SurfacePacket surface =
      trace_exact_shapes(scene, load_rays(rays, stride, i), load_bits(rays, RAY_FROM, stride, i), &u, &v);
  store1(surfaces, SURFACE_T, stride, i, surface.t);
  store3(surfaces, SURFACE_POSITION, stride, i, surface.position);
  store3(surfaces, SURFACE_NORMAL, stride, i, surface.geometric_normal);
#if HAS_MESH
  store3(surfaces, SURFACE_SHADING, stride, i, surface.shading_normal);
#endif
  store_bits(surfaces, SURFACE_MATERIAL, stride, i, surface.material);
  store1(surfaces, SURFACE_ERROR, stride, i, surface.error);
  store_bits(surfaces, SURFACE_FROM, stride, i, surface.from);
#if HAS_CONTACTS
  store_bits(surfaces, SURFACE_CONTACTS, stride, i, surface.contacts);
#endif
#if HAS_TEXTURES
  store1(surfaces, SURFACE_U, stride, i, u);
  store1(surfaces, SURFACE_V, stride, i, v);
#endif
}

#if HAS_MESH

FUNCTION __global const TriangleData* triangle_of(const Scene scene, const Hit hit) {
  const uint mesh = hit.shape - (scene.n_spheres + scene.n_flats);
  return &scene.triangles[scene.meshes[mesh].first_triangle + hit.primitive];
}

FUNCTION float3 triangle_normal(const Scene scene, __global const TriangleData* triangle) {
  const float3 a = vload3(triangle->position[0], scene.positions);
  return normalize(cross(vload3(triangle->position[1], scene.positions) - a,
                         vload3(triangle->position[2], scene.positions) - a));
}

// Writes what a triangle is at the place of a hit.
FUNCTION void store_mesh_surface(const Scene scene, const Ray ray, const Hit hit, uint stride, uint i,
                                 __global float* surfaces) {
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
  const float3 largest = fmax(fmax(fabs(a), fabs(b)), fmax(fabs(c), fabs(ray.origin)));
  surfaces[SURFACE_T * stride + i] = hit.t;
  surfaces[(SURFACE_POSITION + 0) * stride + i] = position.x;
  surfaces[(SURFACE_POSITION + 1) * stride + i] = position.y;
  surfaces[(SURFACE_POSITION + 2) * stride + i] = position.z;
  surfaces[(SURFACE_NORMAL + 0) * stride + i] = geometric.x;
  surfaces[(SURFACE_NORMAL + 1) * stride + i] = geometric.y;
  surfaces[(SURFACE_NORMAL + 2) * stride + i] = geometric.z;
  surfaces[(SURFACE_SHADING + 0) * stride + i] = shading.x;
  surfaces[(SURFACE_SHADING + 1) * stride + i] = shading.y;
  surfaces[(SURFACE_SHADING + 2) * stride + i] = shading.z;
  surfaces[SURFACE_MATERIAL * stride + i] = as_float(triangle->material);
  surfaces[SURFACE_ERROR * stride + i] = SURFACE_ROUNDING * fmax(largest.x, fmax(largest.y, largest.z));
  surfaces[SURFACE_FROM * stride + i] = as_float(NO_INDEX);
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
  surfaces[SURFACE_U * stride + i] = u;
  surfaces[SURFACE_V * stride + i] = v;
#endif
}

// Meshes, one ray to a work-item: replaces what trace_exact found where a triangle comes before it.
__kernel void trace_mesh(SCENE_PARAMETERS, const uint count, const uint stride, __global const float* rays,
                         __global float* surfaces) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  const Scene scene = SCENE;
  Ray ray;
  ray.origin = triple_at(rays, RAY_ORIGIN, stride, i);
  ray.direction = triple_at(rays, RAY_DIRECTION, stride, i);
  ray.t_min = rays[RAY_T_MIN * stride + i];
  ray.t_max = INFINITY;
  Hit hit;
  hit.t = surfaces[SURFACE_T * stride + i];
  hit.shape = as_uint(surfaces[SURFACE_FROM * stride + i]);
  hit.primitive = 0;
#if HAS_CONTACTS
  const float t_exact = hit.t;
  const int exact_is_opaque =
      scene.materials[as_uint(surfaces[SURFACE_MATERIAL * stride + i])].surface != SURFACE_DIELECTRIC;
#endif
  const int found = tree_closest(&ray, scene.nodes, scene.leaves, &hit);
#if HAS_CONTACTS
  if (hit.shape == NO_INDEX) return;
  if (found && scene.materials[triangle_of(scene, hit)->material].surface != SURFACE_DIELECTRIC) {
    store_mesh_surface(scene, ray, hit, stride, i, surfaces);
    return;
  }
  if (!found && exact_is_opaque) return;

  // The first surface is transparent: what lies within its rounding belongs to the same event.
  if (found) {
    const float3 size = fmax(fabs(fma((float3)(hit.t), ray.direction, ray.origin)), fabs(ray.origin));
    const float cosine = fabs(dot(ray.direction, triangle_normal(scene, triangle_of(scene, hit))));
    const float band = SURFACE_ROUNDING * fmax(size.x, fmax(size.y, size.z)) / fmax(cosine, LEAST_COSINE);
    if (exact_is_opaque && t_exact <= hit.t + band) return;
    store_mesh_surface(scene, ray, hit, stride, i, surfaces);
  }
  const float first_cosine = fabs(dot(ray.direction, triple_at(surfaces, SURFACE_NORMAL, stride, i)));
  const float band = surfaces[SURFACE_ERROR * stride + i] / fmax(first_cosine, LEAST_COSINE);
  Hit near[TREE_MAX_HITS];
  const uint n = tree_hits_within(&ray, scene.nodes, scene.leaves, hit.t, hit.t + band, near);
  uint contacts = 0;
  uint places = 0;
  uint seen_shape[MAX_CONTACTS + 1];
  uint seen_entering[MAX_CONTACTS + 1];
  uint seen = 1;
  seen_shape[0] = hit.shape;
  seen_entering[0] = dot(ray.direction, triple_at(surfaces, SURFACE_NORMAL, stride, i)) < 0.0f;
  for (uint k = 0; k < n; ++k) {
    if (near[k].t <= ray.t_min) continue;
    __global const TriangleData* triangle = triangle_of(scene, near[k]);
    if (scene.materials[triangle->material].surface != SURFACE_DIELECTRIC) {
      store_mesh_surface(scene, ray, near[k], stride, i, surfaces);
      return;
    }
    // Triangles that share an edge are one border.
    const uint entering = dot(ray.direction, triangle_normal(scene, triangle)) < 0.0f;
    int known = 0;
    for (uint s = 0; s < seen; ++s) known |= seen_shape[s] == near[k].shape && seen_entering[s] == entering;
    if (known || places == MAX_CONTACTS) continue;
    seen_shape[seen] = near[k].shape;
    seen_entering[seen++] = entering;
    contacts |= packed_contact(scene.materials[triangle->material].medium, entering, places++);
  }
  surfaces[SURFACE_CONTACTS * stride + i] = as_float(contacts);
#else
  if (found) store_mesh_surface(scene, ray, hit, stride, i, surfaces);
#endif
}
#endif
