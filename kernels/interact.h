// What surfaces do to rays that meet them, for camera rays and photons alike: the one place where reflectance is
// computed.
//
// Lanes that meet the same material from the same side with the same media form a group (`Encounter`); all that a
// material decides is then the same in every lane, and only angles and distances differ. Typically a packet is one or
// two groups.
#ifndef VITRUM_INTERACT_H
#define VITRUM_INTERACT_H

#include "contacts.h"
#include "media.h"
#include "surface.h"

typedef struct {
  Mask here;                   // the lanes of the group
  __global const MaterialData* material;
  uint stack;                  // media that the rays are in
  uint contacts;               // borders crossed together with this one (contacts.h)
  int entering;                // 1: the rays meet the front
} Encounter;

// The group of the first lane that is still to do.
FUNCTION Encounter next_encounter(const Scene scene, const Mask todo, const SurfacePacket surface, const Uint stack,
                                  const Mask entering) {
  const uint lane = first_lane(todo);
  const uint material = LANE(surface.material, uint, lane);
  Encounter e;
  e.stack = LANE(stack, uint, lane);
  e.entering = LANE(entering, int, lane) != 0;
  e.here = todo & (surface.material == material) & (stack == e.stack) & (e.entering ? entering : entering == 0);
  e.contacts = 0;
#if HAS_CONTACTS
  e.contacts = LANE(surface.contacts, uint, lane);
  e.here &= surface.contacts == e.contacts;
#endif
  e.material = &scene.materials[material];
  return e;
}

typedef struct {
  Float R, T;                  // shares of the reflected and the refracted ray; T = 0: there is none
  Vec3 reflected, refracted;   // unit directions
  uint stack_reflected, stack_refracted;
  int hidden;                  // 1: the same medium on both sides, so there is nothing to see
} Split;

#if HAS_DIELECTRIC

// Rays along `direction` meet the border of the material's medium.
FUNCTION Split split_at_dielectric(const Scene scene, const Encounter e, const SurfacePacket surface,
                                   const Vec3 direction) {
  Crossing media = crossing(scene, e.stack, e.material->medium, e.entering);
#if HAS_CONTACTS
  for (uint rest = e.contacts; rest != 0; rest >>= CONTACT_BITS) {
    const Crossing next = crossing(scene, media.after, rest & 0xffu, (rest >> 8) & 1u);
    media.after = next.after;
    media.into = next.into;
  }
#endif
  __global const InterfaceData* data = &scene.interfaces[media.from * scene.n_media + media.into];
  Interface border;
  border.eta = data->eta;
  border.eta_inverse = data->eta_inverse;
  border.k_hi = data->k_hi;
  border.k_lo = data->k_lo;

  // Sides are decided by the geometric normal, angles by the shading normal where both rays then leave on their side.
  const Vec3 geometric = e.entering ? surface.geometric_normal : negate3(surface.geometric_normal);
#if HAS_MESH
  Vec3 normal = e.entering ? surface.shading_normal : negate3(surface.shading_normal);
#else
  const Vec3 normal = geometric;
#endif

  Split split;
  split.stack_reflected = media.before;
  split.stack_refracted = media.after;
  split.hidden = media.from == media.into;
  if (split.hidden) {
    split.R = 0.0f;
    split.T = 1.0f;
    split.reflected = direction;
    split.refracted = direction;
    return split;
  }
#if HAS_MESH
  Fresnel f = fresnel(border, -dot3(direction, normal));
  split.reflected = reflected_direction(direction, normal);
  split.refracted = refracted_direction(border, f, direction, normal);
  const Mask astray = (dot3(direction, normal) >= 0.0f) | (dot3(split.reflected, geometric) <= 0.0f) |
                      ((f.total == 0) & (dot3(split.refracted, geometric) >= 0.0f));
  if (ANY(e.here & astray)) {
    normal = select3(astray, geometric, normal);
    f = fresnel(border, -dot3(direction, normal));
  }
#else
  const Fresnel f = fresnel(border, -dot3(direction, normal));
#endif
#ifdef CONSTANT_REFLECTANCE
  split.R = f.total ? (Float)1.0f : (Float)CONSTANT_REFLECTANCE;
  split.T = f.total ? (Float)0.0f : (Float)(1.0f - CONSTANT_REFLECTANCE);
#else
  split.R = f.R;
  split.T = f.T;
#endif
  split.reflected = reflected_direction(direction, normal);
  split.refracted = refracted_direction(border, f, direction, normal);
  return split;
}

#endif

// Mirrored at the shading normal, or at the geometric one where the shading normal would send the ray inside.
FUNCTION Vec3 mirrored(const Encounter e, const SurfacePacket surface, const Vec3 direction) {
  const Vec3 geometric = e.entering ? surface.geometric_normal : negate3(surface.geometric_normal);
#if HAS_MESH
  const Vec3 shading = e.entering ? surface.shading_normal : negate3(surface.shading_normal);
  const Vec3 smooth = reflected_direction(direction, shading);
  return select3(dot3(smooth, geometric) > 0.0f, smooth, reflected_direction(direction, geometric));
#else
  return reflected_direction(direction, geometric);
#endif
}

#endif
