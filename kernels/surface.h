// What lies where rays have hit: place, normals, material, reflectance.
#ifndef VITRUM_SURFACE_H
#define VITRUM_SURFACE_H

#include "packet.h"
#include "scene.h"
#include "texture.h"

// Rounding of a point put back on its surface, relative to the largest coordinate at hand: 12 roundings of 2^-24 in the
// worst case of a barycentric sum and a projection, doubled for the next ray's own intersection.
#define SURFACE_ROUNDING 1.4e-6f

// A ray leaves a mesh after error / cosine [m], the cosine to the facet's normal, and at grazing angles no later than this.
#define LEAST_COSINE 0.03f

typedef struct {
  Float t;                     // [m], INFINITY: nothing is met
  Vec3 position;               // [m], put back on the surface
  Vec3 geometric_normal;       // unit length, outwards
#if HAS_MESH
  Vec3 shading_normal;         // unit length, on the same side
#endif
  Uint material;
  Uint from;                   // exact shape, for the rays that leave; NO_INDEX on a mesh
#if HAS_TEXTURES
  Float u, v;                  // texture coordinates; NaN: none
#endif
#if HAS_CONTACTS
  Uint contacts;               // borders in contact behind this one (contacts.h)
#endif
  Float error;                 // [m]: bound of the distance between the position and the true surface
} SurfacePacket;

FUNCTION Vec3 shading_normal(const SurfacePacket* surface) {
#if HAS_MESH
  return surface->shading_normal;
#else
  return surface->geometric_normal;
#endif
}

// Does the material scatter light, if only in places?
FUNCTION int is_diffuse(__global const MaterialData* material) {
  return material->texture != NO_INDEX || material->diffuse[0] > 0.0f || material->diffuse[1] > 0.0f ||
         material->diffuse[2] > 0.0f;
}

// rho_d of lanes that share a material: the texel where there is a texture and the place has coordinates.
FUNCTION Vec3 diffuse_reflectance(const Scene scene, __global const MaterialData* material,
                                  const SurfacePacket* surface) {
  const Vec3 rho_d = uniform3(material->diffuse);
#if HAS_TEXTURES
  if (material->texture != NO_INDEX) {
    const Vec3 texel = texture_value(scene, &scene.textures[material->texture], surface->u, surface->v);
    return select3(surface->u == surface->u, material->texture_replaces ? texel : multiply3(texel, rho_d), rho_d);
  }
#endif
  return rho_d;
}

// Where hits of a ray that leaves along `direction` begin. On an exact shape the shape itself is told by `from`, so
// the bound serves its neighbours only; on a mesh the ray must get clear of the facet and of those that share its edge.
FUNCTION Float leaving_t_min(const SurfacePacket* surface, const Vec3 direction) {
#if HAS_MESH
  const Float cosine = fabs(dot3(direction, surface->geometric_normal));
  return surface->from == NO_INDEX ? surface->error / larger(cosine, LEAST_COSINE) : surface->error;
#else
  return surface->error;
#endif
}

#endif
