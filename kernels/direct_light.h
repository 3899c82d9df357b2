// The light of one lamp on surfaces that scatter, with its shadow and highlight.
#ifndef VITRUM_DIRECT_LIGHT_H
#define VITRUM_DIRECT_LIGHT_H

#include "exact.h"
#include "lights.h"
#include "media.h"
#include "surface.h"
#if HAS_MESH
#include "mesh.h"
#include "tree.h"
#endif

// What a surface does with light that comes to it, times the weight of the camera ray that sees it.
typedef struct {
  Vec3 normal;                 // shading normal on the side of the viewer
  Vec3 diffuse;                // rho_d
#if HAS_HIGHLIGHTS
  Vec3 specular;               // rho_s (s + 2) / (2 pi)
  Float shininess;             // s
#endif
} Scattering;

// What reaches the surface from a place on the light, shadows left out.
typedef struct {
  Vec3 direction;              // unit, towards the light
  Float distance;              // [m]
  Vec3 irradiance;             // across the direction [W/m2]
} Illumination;

FUNCTION Illumination illumination(const Scene scene, __global const LightData* light, const Vec3 position, Float u,
                                   Float v, Float u_face) {
  Illumination in;
#if LIGHT_KINDS & (1 << LIGHT_SPHERE)
  if (light->kind == LIGHT_SPHERE) {
    // Uniform in the cone under which the sphere is seen: only the cosine at the surface is left to chance.
    const Vec3 to_centre = subtract3(uniform3(light->position), position);
    const float radius = light->radius;
    const Float d2 = dot3(to_centre, to_centre);
    const Float d = sqrt(d2);
    const Float s2 = smaller(radius * radius / d2, 1.0f);
    const Float one_minus_cos_max = s2 / (1.0f + sqrt(1.0f - s2));
    const Float one_minus_cos = u * one_minus_cos_max;
    const Float sine2 = one_minus_cos * (2.0f - one_minus_cos);
    Float s, c;
    sin_cos_turn(v, &s, &c);
    const Vec3 axis = scale3(1.0f / d, to_centre);
    const Float r = sqrt(sine2);
    in.direction = normalize3(in_frame(frame_around(axis), axis, r * c, r * s, 1.0f - one_minus_cos));
    const Float room = fma(-d2, sine2, (Float)(radius * radius));
    in.distance = d * (1.0f - one_minus_cos) - sqrt(room > 0.0f ? room : 0.0f);
    in.irradiance = scale3(6.28318530717958648f * one_minus_cos_max, uniform3(light->emitted));
    return in;
  }
#endif
  const LightPoint from = point_on_light(scene, light, u, v, face_of_light(scene, light, u_face));
  if (light->kind == LIGHT_DIRECTIONAL) {
    in.direction = negate3(from.normal);
    in.distance = INFINITY;
    in.irradiance = from.emitted;
    return in;
  }
  const Vec3 to_light = subtract3(from.position, position);
  const Float d2 = dot3(to_light, to_light);
  in.distance = sqrt(d2);
  in.direction = scale3(1.0f / in.distance, to_light);
  const Float facing = -dot3(in.direction, from.normal);
  const Float cosine = light->kind == LIGHT_POINT ? (Float)1.0f : facing > 0.0f ? facing : 0.0f;
  in.irradiance = scale3(cosine * from.area / d2, from.emitted);
  return in;
}

// Radiance towards the viewer along `-direction`, from surfaces in `media`. `sample`: its point of a sequence, shifted at
// random on each `path`. Adds to `shadow_rays` how many were traced.
FUNCTION Vec3 direct_light(const Scene scene, const uint light_index, __global const CameraSample* sample,
                           const Uint path, const Vec3 direction, const Uint media, const SurfacePacket* surface,
                           const Scattering* scattering, const Mask active, uint* shadow_rays) {
  const Vec3 dark = make_vec3(0.0f, 0.0f, 0.0f);
  Mask wanted = max_channel(scattering->diffuse) > 0.0f;
#if HAS_HIGHLIGHTS
  wanted |= max_channel(scattering->specular) > 0.0f;
#endif
  wanted &= active;
  if (!ANY(wanted)) return dark;
  __global const LightData* light = &scene.lights[light_index];

  Float u = 0.0f;
  Float v = 0.0f;
  Float u_face = 0.0f;
#if LIGHT_KINDS & ~((1 << LIGHT_POINT) | (1 << LIGHT_DIRECTIONAL))
  const Uint bits = hash_pair(path, (Uint)light_index);
  u = unit_float(hash32(bits + 1)) + sample->light_u;
  v = unit_float(hash32(bits + 2)) + sample->light_v;
  u_face = unit_float(hash32(bits + 3)) + sample->light_face;
  u -= floor(u);
  v -= floor(v);
  u_face -= floor(u_face);
#endif
  const Illumination in = illumination(scene, light, surface->position, u, v, u_face);
  const Vec3 normal = scattering->normal;
  const Float cos_theta = dot3(normal, in.direction);
  // The light must stand before the facet too, not only before the shading normal.
  const Float side = dot3(surface->geometric_normal, in.direction) * dot3(surface->geometric_normal, normal);
  wanted &= (cos_theta > 0.0f) & (side > 0.0f) & (max_channel(in.irradiance) > 0.0f);
  if (!ANY(wanted)) return dark;

  *shadow_rays += lanes_set(wanted);
  RayPacket shadow;
  shadow.origin = surface->position;
  shadow.direction = in.direction;
  shadow.t_min = surface->error;
  shadow.t_max = in.distance - larger((Float)light->clearance, 4e-7f * in.distance);
  shadow.t_max = in.distance == INFINITY ? INFINITY : shadow.t_max;
  Mask lit = wanted & (exact_any_hit(scene, shadow, surface->from) == 0);
#if HAS_MESH
  const Uint from = leaving(surface, surface->entering);
  const MeshRays rays = mesh_rays(scene, &shadow, from, lit);
  lit &= mask_of(~tree_any(&rays, lane_bits(lit), scene.nodes, scene.leaves));
#endif

  // [direct]
  Vec3 reflected = scale3(0.318309886183790672f, scattering->diffuse);
#if HAS_HIGHLIGHTS
  // Phong: rho_s (s + 2) / (2 pi) max(0, w_o . w_r)^s, w_r the light's direction mirrored at the normal.
  const Vec3 w_r = along3(negate3(in.direction), 2.0f * cos_theta, normal);
  const Float lobe = -dot3(direction, w_r);
  const Mask bright = lit & (lobe > 0.0f) & (max_channel(scattering->specular) > 0.0f);
  if (ANY(bright)) {
    const Float power = exp2(scattering->shininess * log2(lobe > 0.0f ? lobe : 1.0f));
    reflected = add3(reflected, scale3(bright ? power : 0.0f, scattering->specular));
  }
#endif
  Vec3 share = multiply3(reflected, scale3(lit ? cos_theta : 0.0f, in.irradiance));
#if HAS_ABSORPTION
  // Glass casts shadows, so the light has come all the way through the medium that the surface lies in.
  Mask todo = lit & ((media & 0xffu) != 0);
  while (ANY(todo)) {
    const uint stack = LANE(media, uint, first_lane(todo));
    const Mask here = todo & (media == stack);
    todo &= here == 0;
    share = select3(here, multiply3(share, media_transmittance(scene, stack, in.distance)), share);
  }
#endif
  // [/direct]
  return select3(lit, share, dark);
}

#endif
