// The first exact shape that rays meet, and what lies there.
#ifndef VITRUM_TRACE_EXACT_H
#define VITRUM_TRACE_EXACT_H

#include "exact.h"
#include "surface.h"

// Shapes are numbered spheres first, then flats; `from` is the one that a ray leaves, or NO_INDEX. A ray that meets
// nothing has t = INFINITY and the background's material 0. Texture coordinates only where they are `textured`.
FUNCTION SurfacePacket trace_exact(const Scene scene, const RayPacket packet, const Uint from, const int textured) {
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
    const FlatHit flat = flat_hit(&scene.flats[f], packet, from == scene.n_spheres + f, textured);
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
#if HAS_TEXTURES
  Float tex_u = 0.0f;
  Float tex_v = 0.0f;
#endif
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
    if (textured && scene.materials[scene.spheres[s].material].texture != NO_INDEX) {
      // Longitude from -x over +z, latitude from the south pole.
      FOR_LANES(lane, here) {
        const float3 up = LANE3(n, lane);
        SET_LANE(tex_u, float, lane, fma(atan2(-up.z, up.x), 0.15915494309189534f, 0.5f));
        SET_LANE(tex_v, float, lane, fma(asin(clamp(up.y, -1.0f, 1.0f)), 0.3183098861837907f, 0.5f));
      }
    }
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
#if HAS_TEXTURES
    tex_u = here ? fma(u, (Float)flat->texcoord[2], fma(v, (Float)flat->texcoord[4], (Float)flat->texcoord[0])) : tex_u;
    tex_v = here ? fma(u, (Float)flat->texcoord[3], fma(v, (Float)flat->texcoord[5], (Float)flat->texcoord[1])) : tex_v;
#endif
  }

  SurfacePacket surface;
  surface.t = t;
  surface.position = position;
  surface.geometric_normal = normal;
#if HAS_MESH
  surface.shading_normal = normal;
#endif
  surface.material = material;
  surface.entering = dot3(packet.direction, normal) < 0.0f;
  surface.from = shape;
#if HAS_TEXTURES
  surface.u = tex_u;
  surface.v = tex_v;
#endif
  surface.error = SURFACE_ROUNDING * larger(extent, larger(largest3(position), largest3(packet.origin)));
#if HAS_CONTACTS
  surface.contacts = 0;
#endif
  return surface;
}

#endif
