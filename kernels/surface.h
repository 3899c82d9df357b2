// What lies where a ray has hit: place, normals, material, reflectance.
#ifndef VITRUM_SURFACE_H
#define VITRUM_SURFACE_H

#include "queue.h"
#include "scene.h"
#include "texture.h"

// Rounding of a point put back on its surface, relative to the largest coordinate at hand: 12 roundings of 2^-24 in the
// worst case of a barycentric sum and a projection, doubled for the next ray's own intersection.
#define SURFACE_ROUNDING 1.4e-6f

typedef struct {
  Float t;                     // [m], INFINITY: nothing
  Vec3 position, geometric_normal, shading_normal;
  Uint material, from;
#if HAS_CONTACTS
  Uint contacts;
#endif
  Float error;
} SurfacePacket;

FUNCTION SurfacePacket load_surfaces(__global const float* surfaces, uint stride, uint i) {
  SurfacePacket s;
  s.t = load1(surfaces, SURFACE_T, stride, i);
  s.position = load3(surfaces, SURFACE_POSITION, stride, i);
  s.geometric_normal = load3(surfaces, SURFACE_NORMAL, stride, i);
#if HAS_MESH
  s.shading_normal = load3(surfaces, SURFACE_SHADING, stride, i);
#else
  s.shading_normal = s.geometric_normal;
#endif
  s.material = load_bits(surfaces, SURFACE_MATERIAL, stride, i);
  s.error = load1(surfaces, SURFACE_ERROR, stride, i);
  s.from = load_bits(surfaces, SURFACE_FROM, stride, i);
#if HAS_CONTACTS
  s.contacts = load_bits(surfaces, SURFACE_CONTACTS, stride, i);
#endif
  return s;
}

// rho_d of lanes that share a material: the texel where there is a texture and the place has coordinates (no NaN).
FUNCTION Vec3 diffuse_reflectance(const Scene scene, __global const MaterialData* material,
                                  __global const float* surfaces, uint stride, uint i) {
  const Vec3 rho_d = uniform3(material->diffuse);
#if HAS_TEXTURES
  if (material->texture != NO_INDEX) {
    const Float u = load1(surfaces, SURFACE_U, stride, i);
    const Vec3 texel =
        texture_value(scene, &scene.textures[material->texture], u, load1(surfaces, SURFACE_V, stride, i));
    return select3(u == u, material->texture_replaces ? texel : multiply3(texel, rho_d), rho_d);
  }
#endif
  return rho_d;
}

// Where hits of a ray that leaves along `direction` begin. On an exact shape the shape itself is told by `from`, so
// the bound serves its neighbours only; on a mesh the ray must get clear of the facet and of those that share its edge.
FUNCTION Float leaving_t_min(const SurfacePacket surface, const Vec3 direction) {
  const Float cosine = magnitude(dot3(direction, surface.geometric_normal));
  return surface.from == NO_INDEX ? surface.error / larger(cosine, LEAST_COSINE) : surface.error;
}

#endif
