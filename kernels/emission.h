// Emission of photons as a pure map: (light, caster, u) -> ray and power. The numbers u come from outside (sampler.h).
//
// Each pair of light and caster (what refracts or mirrors, by its bounding sphere) has a cone from a point, a disc
// across a directional light, a cone by position on an area light. Where several casters cover a direction, a photon
// of each pair carries its share of the power, one over their number.
#ifndef VITRUM_EMISSION_H
#define VITRUM_EMISSION_H

#include "lights.h"
#include "queue.h"
#include "sampler.h"

typedef struct {
  Vec3 origin, direction;      // [m], unit
  Vec3 power;                  // of the whole pair [W]; a photon has it divided by their number
} Emission;

// 1 - cos of the half angle under which the sphere is seen from `point`; 2 (all directions) from inside.
FUNCTION Float cone_of_sphere(const Vec3 point, const Vec3 centre, const Float radius) {
  const Vec3 to_centre = subtract3(centre, point);
  const Float s2 = radius * radius / dot3(to_centre, to_centre);
  return s2 < 1.0f ? s2 / (1.0f + sqrt(1.0f - s2)) : 2.0f;
}

// Does the caster's sphere cover the ray?
FUNCTION Mask covers(__global const CasterData* caster, const Vec3 origin, const Vec3 direction, int directional) {
  const Vec3 to_centre = subtract3(uniform3(caster->centre), origin);
  const float radius2 = caster->radius * caster->radius;
  const Float along = dot3(to_centre, direction);
  const Vec3 across = along3(to_centre, -along, direction);
  const Mask in_line = dot3(across, across) <= radius2;
  return directional ? in_line : (dot3(to_centre, to_centre) <= radius2) | ((along > 0.0f) & in_line);
}

// [aimed]
// u[0..1]: direction, or place on the disc of a directional light; u[2..3]: place on the light; `face`: of a mesh light.
// `upstream` [m]: how far before the caster a directional light's photons start.
FUNCTION Emission emit(const Scene scene, __global const LightData* light, __global const CasterData* casters,
                       const uint n_casters, const uint caster_index, const Float u[4], const Uint face,
                       const float upstream) {
  __global const CasterData* caster = &casters[caster_index];
  const Vec3 centre = uniform3(caster->centre);
  const float radius = caster->radius;
  const LightPoint from = point_on_light(scene, light, u[2], u[3], face);
  Float sine, cosine;
  sin_cos_turn(u[1], &sine, &cosine);

  Emission emission;
  if (light->kind == LIGHT_DIRECTIONAL) {
    const Float r = radius * sqrt(u[0]);
    const Vec3 on_disc = in_frame(frame_around(from.normal), from.normal, r * cosine, r * sine, -upstream);
    emission.origin = add3(centre, on_disc);
    emission.direction = from.normal;
    emission.power = scale3(3.14159265358979f * radius * radius, from.emitted);
  } else {
    const int is_point = light->kind == LIGHT_POINT;
    const Float whole = cone_of_sphere(from.position, centre, radius);
    // From inside the bound: all directions, of a surface the half before it.
    const Mask aimed = whole < 2.0f;
    const Float one_minus_cos_max = aimed ? whole : is_point ? (Float)2.0f : (Float)1.0f;
    const Vec3 axis = select3(aimed, normalize3(subtract3(centre, from.position)), from.normal);
    // 1 - cos is what is uniform in a cone, and sin follows from it without cancellation.
    const Float one_minus_cos = u[0] * one_minus_cos_max;
    const Float sin_theta = sqrt(one_minus_cos * (2.0f - one_minus_cos));
    emission.origin = from.position;
    emission.direction = normalize3(
        in_frame(frame_around(axis), axis, sin_theta * cosine, sin_theta * sine, 1.0f - one_minus_cos));
    const Float facing = dot3(emission.direction, from.normal);
    const Float cos_theta = is_point ? (Float)1.0f : facing > 0.0f ? facing : 0.0f;
    const Float solid_angle = 6.28318530717958648f * one_minus_cos_max;
    emission.power = scale3(from.area * solid_angle * cos_theta, from.emitted);
  }

  Float covering = 1.0f;
  for (uint i = 0; i < n_casters; ++i)
    if (i != caster_index)
      covering += covers(&casters[i], emission.origin, emission.direction, light->kind == LIGHT_DIRECTIONAL)
                      ? (Float)1.0f
                      : (Float)0.0f;
  emission.power = scale3(1.0f / covering, emission.power);
  return emission;
}
// [/aimed]

#endif
