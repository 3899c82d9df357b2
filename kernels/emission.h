// Emission of photons as a pure map: (light, caster, u) -> ray and power. The numbers u come from outside (sampler.h).
//
// Each pair of light and caster (what refracts or mirrors, by its bounding sphere) has a cone from a point, a disc
// across a directional light, a cone by position on an area light. Where several casters cover a direction, a photon
// of each pair carries its share of the power, one over their number.
#ifndef VITRUM_EMISSION_H
#define VITRUM_EMISSION_H

#include "lights.h"
#include "packet.h"
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

// Where the light aims from one of its places: at the caster's bound, or in all directions.
typedef struct {
  Vec3 axis;
  Frame frame;                 // around the axis
  Float one_minus_cos_max;     // of the cone
} Aim;

// [aimed]
FUNCTION Aim aim_at(__global const CasterData* caster, const LightPoint from, const int is_point) {
  const Vec3 centre = uniform3(caster->centre);
  const Float whole = cone_of_sphere(from.position, centre, caster->radius);
  // From inside the bound: all directions, of a surface the half before it.
  const Mask aimed = whole < 2.0f;
  Aim aim;
  aim.one_minus_cos_max = aimed ? whole : is_point ? (Float)2.0f : (Float)1.0f;
  aim.axis = select3(aimed, normalize3(subtract3(centre, from.position)), from.normal);
  aim.frame = frame_around(aim.axis);
  return aim;
}

// u[0..1]: direction, or place on the disc of a directional light. `aim`: from the place on the light; of no interest to
// a directional one. `upstream` [m]: how far before the caster a directional light's photons start.
FUNCTION Emission emit(__global const LightData* light, __global const CasterData* casters, const uint n_casters,
                       const uint caster_index, const LightPoint from, const Aim* aim, const Float u[2],
                       const float upstream) {
  __global const CasterData* caster = &casters[caster_index];
  Float sine, cosine;
  sin_cos_turn(u[1], &sine, &cosine);

  Emission emission;
  if (light->kind == LIGHT_DIRECTIONAL) {
    const float radius = caster->radius;
    const Float r = radius * sqrt(u[0]);
    const Vec3 on_disc = in_frame(frame_around(from.normal), from.normal, r * cosine, r * sine, -upstream);
    emission.origin = add3(uniform3(caster->centre), on_disc);
    emission.direction = from.normal;
    emission.power = scale3(3.14159265358979f * radius * radius, from.emitted);
  } else {
    // 1 - cos is what is uniform in a cone, and sin follows from it without cancellation.
    const Float one_minus_cos = u[0] * aim->one_minus_cos_max;
    const Float sin_theta = sqrt(one_minus_cos * (2.0f - one_minus_cos));
    const Vec3 in_cone = in_frame(aim->frame, aim->axis, sin_theta * cosine, sin_theta * sine, 1.0f - one_minus_cos);
    emission.origin = from.position;
    emission.direction = scale3(fma(-0.5f, dot3(in_cone, in_cone), 1.5f), in_cone);  // Newton: off by roundings only
    const Float facing = dot3(emission.direction, from.normal);
    const Float cos_theta = light->kind == LIGHT_POINT ? (Float)1.0f : facing > 0.0f ? facing : 0.0f;
    const Float solid_angle = 6.28318530717958648f * aim->one_minus_cos_max;
    emission.power = scale3(from.area * solid_angle * cos_theta, from.emitted);
  }

  Float covering = 1.0f;
  for (uint i = 0; i < n_casters; ++i)
    if (i != caster_index)
      covering += covers(&casters[i], emission.origin, emission.direction, light->kind == LIGHT_DIRECTIONAL)
                      ? (Float)1.0f
                      : (Float)0.0f;
  if (n_casters > 1) emission.power = scale3(1.0f / covering, emission.power);
  return emission;
}
// [/aimed]

#endif
