// Stage trace: the first surface that each ray of a queue meets. Camera rays and photons alike.
// Reads: the scene's shapes, queue rays [0, count). Writes: surfaces [0, count).
#include "exact.h"
#include "surface.h"
#if HAS_MESH
#include "tree.h"
#endif

// Exact shapes, WIDTH rays at a time. They are numbered spheres first, then flats.
__kernel void trace_exact(SCENE_PARAMETERS, const uint count, const uint stride, __global const float* rays,
                          __global float* surfaces) {
  const uint i = get_global_id(0) * WIDTH;
  if (i >= count) return;
  const Scene scene = SCENE;
  const RayPacket packet = load_rays(rays, stride, i);
  const Uint from = load_bits(rays, RAY_FROM, stride, i);

  Float t = INFINITY;
  Uint shape = NO_INDEX;
  Float u = 0.0f;
  Float v = 0.0f;
  for (uint s = 0; s < scene.n_spheres; ++s) {
    const Float t_sphere = sphere_distance(&scene.spheres[s], packet, from == s);
    const Mask closer = t_sphere < t;
    t = closer ? t_sphere : t;
    shape = closer ? s : shape;
  }
  for (uint f = 0; f < scene.n_flats; ++f) {
    const FlatHit flat = flat_hit(&scene.flats[f], packet, from == scene.n_spheres + f);
    const Mask closer = flat.t < t;
    t = closer ? flat.t : t;
    shape = closer ? scene.n_spheres + f : shape;
    u = closer ? flat.u : u;
    v = closer ? flat.v : v;
  }

  // The place is put back on the surface, which takes the rounding of t off it.
  const Vec3 reached = along3(packet.origin, shape == NO_INDEX ? 0.0f : t, packet.direction);
  Vec3 position = reached;
  Vec3 normal = make_vec3(0.0f, 1.0f, 0.0f);
  Uint material = 0;
  Float extent = 0.0f;
  Float tex_u = 0.0f;
  Float tex_v = 0.0f;
  for (uint s = 0; s < scene.n_spheres; ++s) {
    const Mask here = shape == s;
    if (!ANY(here)) continue;
    const Vec3 centre = uniform3(scene.spheres[s].centre);
    const float radius = scene.spheres[s].radius;
    const Vec3 n = normalize3(subtract3(reached, centre));
    normal = select3(here, n, normal);
    position = select3(here, along3(centre, radius, n), position);
    material = here ? scene.spheres[s].material : material;
    extent = here ? radius : extent;
#if HAS_TEXTURES
    // Longitude from -x over +z, latitude from the south pole.
    tex_u = here ? fma(atan2(-n.z, n.x), (Float)0.15915494309189534f, (Float)0.5f) : tex_u;
    tex_v = here ? fma(asin(clamp(n.y, (Float)-1.0f, (Float)1.0f)), (Float)0.3183098861837907f, (Float)0.5f) : tex_v;
#endif
  }
  for (uint f = 0; f < scene.n_flats; ++f) {
    __global const FlatData* flat = &scene.flats[f];
    const Mask here = shape == scene.n_spheres + f;
    if (!ANY(here)) continue;
    const Vec3 n = uniform3(flat->normal);
    normal = select3(here, n, normal);
    position = select3(here, along3(reached, -dot3(n, subtract3(reached, uniform3(flat->point))), n), position);
    material = here ? flat->material : material;
    tex_u = here ? fma(u, (Float)flat->texcoord[2], fma(v, (Float)flat->texcoord[4], (Float)flat->texcoord[0])) : tex_u;
    tex_v = here ? fma(u, (Float)flat->texcoord[3], fma(v, (Float)flat->texcoord[5], (Float)flat->texcoord[1])) : tex_v;
  }

  store1(surfaces, SURFACE_T, stride, i, t);
  store3(surfaces, SURFACE_POSITION, stride, i, position);
  store3(surfaces, SURFACE_NORMAL, stride, i, normal);
#if HAS_MESH
  store3(surfaces, SURFACE_SHADING, stride, i, normal);
#endif
  store_bits(surfaces, SURFACE_MATERIAL, stride, i, material);
  store1(surfaces, SURFACE_ERROR, stride, i,
         SURFACE_ROUNDING * larger(extent, larger(largest3(position), largest3(packet.origin))));
  store_bits(surfaces, SURFACE_FROM, stride, i, shape);
#if HAS_TEXTURES
  store1(surfaces, SURFACE_U, stride, i, tex_u);
  store1(surfaces, SURFACE_V, stride, i, tex_v);
#endif
}

#if HAS_MESH
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
  if (!tree_closest(&ray, scene.nodes, scene.leaves, &hit)) return;

  const uint mesh = hit.shape - (scene.n_spheres + scene.n_flats);
  __global const TriangleData* triangle = &scene.triangles[scene.meshes[mesh].first_triangle + hit.primitive];
  const float3 a = vload3(triangle->position[0], scene.positions);
  const float3 b = vload3(triangle->position[1], scene.positions);
  const float3 c = vload3(triangle->position[2], scene.positions);
  const float w = 1.0f - hit.u - hit.v;
  const float3 position = fma((float3)(w), a, fma((float3)(hit.u), b, hit.v * c));
  const float3 geometric = normalize(cross(b - a, c - a));
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
#endif
