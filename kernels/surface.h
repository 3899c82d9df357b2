// What lies where rays have hit: place, normals, material, reflectance.
#ifndef VITRUM_SURFACE_H
#define VITRUM_SURFACE_H

#include "packet.h"
#include "scene.h"
#include "texture.h"

// Rounding of a point put back on its surface, relative to the largest coordinate m at hand. On a triangle, with
// u = 2^-24: b - a and c - a are off by 2 u m, the two fma by u m each, so a coordinate by 4 u m and the point by
// sqrt(3) times as much. On an exact shape: 12 u m by a division or root, a product and a sum. Twice that, for what the
// next ray's own intersection loses.
#define SURFACE_ROUNDING 1.4e-6f

// What a ray leaves, in one number: an exact shape's index, or a triangle's among those of all meshes and the side to
// which it leaves, or NO_INDEX.
#define FROM_MESH 0x80000000u
#define FROM_FRONT 0x40000000u
#define FROM_TRIANGLE 0x3fffffffu

typedef struct {
  Float t;                     // [m], INFINITY: nothing is met
  Vec3 position;               // [m], put back on the surface
  Vec3 geometric_normal;       // unit length, outwards
#if HAS_MESH
  Vec3 shading_normal;         // unit length, on the same side
#endif
  Uint material;
  Mask entering;               // the front is met
  Uint from;                   // what the surface is, for the rays that leave it; without FROM_FRONT
#if HAS_TEXTURES
  Float u, v;                  // texture coordinates; NaN: none
#endif
#if HAS_CONTACTS
  Uint contacts;               // borders in contact behind this one (contacts.h)
#endif
  Float error;                 // [m]: bound of the distance between the position and the true surface; exact shapes
                               // that a ray meets sooner belong to the place that it leaves
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

// What rays leave that go on before the surface (`front`) or behind it. The side is that of the event, not of a dot
// product, whose sign may be lost at grazing angles.
FUNCTION Uint leaving(const SurfacePacket* surface, const Mask front) {
#if HAS_MESH
  return ((surface->from & FROM_MESH) != 0) & front ? surface->from | FROM_FRONT : surface->from;
#else
  return surface->from;
#endif
}

#endif
