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

// What tells groups apart, in one number: material, side, and with a single medium also whether the rays are in it.
FUNCTION Uint encounter_keys(const SurfacePacket* surface, const Uint stack) {
  const Uint side = surface->material << 1 | (surface->entering ? (Uint)1 : (Uint)0);
#if HAS_MEDIA_STACK
  return side;
#else
  return side << 8 | stack;
#endif
}

// The group of the first lane that is still to do.
FUNCTION Encounter next_encounter(const Scene scene, const Mask todo, const SurfacePacket* surface, const Uint keys,
                                  const Uint stack) {
  const uint lane = first_lane(todo);
  uint key = LANE(keys, uint, lane);
  Encounter e;
  e.here = todo & (keys == key);
#if HAS_MEDIA_STACK
  e.stack = LANE(stack, uint, lane);
  e.here &= stack == e.stack;
#else
  e.stack = key & 0xffu;
  key >>= 8;
#endif
  e.contacts = 0;
#if HAS_CONTACTS
  e.contacts = LANE(surface->contacts, uint, lane);
  e.here &= surface->contacts == e.contacts;
#endif
  e.entering = key & 1u;
  e.material = &scene.materials[key >> 1];
  return e;
}

#if HAS_DIELECTRIC

// The border of a dielectric as rays meet it.
typedef struct {
  Float R, T;                  // shares of the reflected and the refracted ray; T = 0: there is none
  uint stack_reflected, stack_refracted;
  int hidden;                  // 1: the same medium on both sides, so there is nothing to see
  Interface border;
  Fresnel fresnel;
  Vec3 normal;                 // on the incident side, for directions
} Split;

FUNCTION Vec3 split_reflected(const Split* split, const Vec3 direction) {
  return reflected_direction(direction, split->normal);
}
FUNCTION Vec3 split_refracted(const Split* split, const Vec3 direction) {
  return refracted_direction(split->border, split->fresnel, direction, split->normal);
}
FUNCTION Vec3 split_chosen(const Split* split, const Mask reflect, const Vec3 direction) {
  return chosen_direction(split->border, split->fresnel, reflect, direction, split->normal);
}

// Rays along `direction` meet the border of the material's medium.
FUNCTION Split split_at_dielectric(const Scene scene, const Encounter e, const SurfacePacket* surface,
                                   const Vec3 direction) {
  Crossing media = crossing(scene, e.stack, e.material->medium, e.entering);
#if HAS_CONTACTS
  for (uint rest = e.contacts; rest != 0; rest >>= CONTACT_BITS) {
    const Crossing next = crossing(scene, media.after, rest & 0xffu, (rest >> 8) & 1u);
    media.after = next.after;
    media.into = next.into;
  }
#endif
  // Between a medium and itself, k is 0: nothing is reflected, and the ray goes straight on.
  __global const InterfaceData* data = &scene.interfaces[media.from * scene.n_media + media.into];
  Split split;
  split.border.eta = data->eta;
  split.border.eta_inverse = data->eta_inverse;
  split.border.k_hi = data->k_hi;
  split.border.k_lo = data->k_lo;
  split.stack_reflected = media.before;
  split.stack_refracted = media.after;
  split.hidden = media.from == media.into;

  // Sides are decided by the geometric normal, angles by the shading normal where both rays then leave on their side.
#if HAS_MESH
  const Vec3 geometric = e.entering ? surface->geometric_normal : negate3(surface->geometric_normal);
  split.normal = e.entering ? surface->shading_normal : negate3(surface->shading_normal);
  split.fresnel = fresnel(split.border, -dot3(direction, split.normal));
  const Mask astray = (dot3(direction, split.normal) >= 0.0f) |
                      (dot3(split_reflected(&split, direction), geometric) <= 0.0f) |
                      ((split.fresnel.total == 0) & (dot3(split_refracted(&split, direction), geometric) >= 0.0f));
  if (ANY(e.here & astray)) {
    split.normal = select3(astray, geometric, split.normal);
    split.fresnel = fresnel(split.border, -dot3(direction, split.normal));
  }
#else
  split.normal = e.entering ? surface->geometric_normal : negate3(surface->geometric_normal);
  split.fresnel = fresnel(split.border, -dot3(direction, split.normal));
#endif
#ifdef CONSTANT_REFLECTANCE
  const float R = split.hidden ? 0.0f : CONSTANT_REFLECTANCE;
  split.R = split.fresnel.total ? (Float)1.0f : (Float)R;
  split.T = split.fresnel.total ? (Float)0.0f : (Float)(1.0f - R);
#else
  split.R = split.fresnel.R;
  split.T = split.fresnel.T;
#endif
  return split;
}

#endif

// Mirrored at the shading normal, or at the geometric one where the shading normal would send the ray inside.
FUNCTION Vec3 mirrored(const Encounter e, const SurfacePacket* surface, const Vec3 direction) {
  const Vec3 geometric = e.entering ? surface->geometric_normal : negate3(surface->geometric_normal);
#if HAS_MESH
  const Vec3 shading = e.entering ? surface->shading_normal : negate3(surface->shading_normal);
  const Vec3 smooth = reflected_direction(direction, shading);
  return select3(dot3(smooth, geometric) > 0.0f, smooth, reflected_direction(direction, geometric));
#else
  return reflected_direction(direction, geometric);
#endif
}

#endif
