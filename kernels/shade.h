// What surfaces show to camera rays, how they scatter, and the rays that go on from them.
#ifndef VITRUM_SHADE_H
#define VITRUM_SHADE_H

#include "direct_light.h"
#include "interact.h"

// Camera rays of WIDTH pixels.
typedef struct {
  RayPacket rays;
  Vec3 weight;                 // R, T and transmittance so far
  Uint media;                  // stack
  Uint from;                   // what a ray leaves (surface.h)
  Uint path;                   // random bits
#if HAS_PATCHES
  Float x, y;                  // of those from the eye: in the pixel, from 0 to 1
#endif
  Mask active;
  uint depth;                  // surfaces met before
} CameraRays;

typedef struct {
  uint max_depth;
  float min_weight;            // branches below are cut
  float eye_index;             // index of refraction at the eye
} CameraLimits;

typedef struct {
  Vec3 shown;                  // radiance that the surfaces send out by themselves, times weight
  Scattering scattering;
  Float cut;                   // weight of the branches that end here
  CameraRays reflected, refracted;
} Shading;

// Radiance scales by (n_eye / n)^2 from a medium of index n (basic radiance, Nicodemus 1963), which is applied where light
// joins the path, so that borders passed in between cancel.
FUNCTION Shading shade(const Scene scene, const CameraLimits limits, const CameraRays* camera,
                       const SurfacePacket* surface) {
  const Vec3 direction = camera->rays.direction;
  const Vec3 weight = camera->weight;
  const Vec3 zero = make_vec3(0.0f, 0.0f, 0.0f);
  const int goes_deeper = camera->depth + 1 < limits.max_depth;

  Shading s;
  s.shown = zero;
  s.scattering.diffuse = zero;
  const Vec3 normal = shading_normal(surface);
  // On the side of the facet that is seen, also where the shading normal itself turns away from the viewer.
  s.scattering.normal = select3(surface->entering, normal, negate3(normal));
#if HAS_HIGHLIGHTS
  s.scattering.specular = zero;
  s.scattering.shininess = 0.0f;
#endif
  s.cut = 0.0f;
  s.reflected.active = 0;
  s.reflected.rays.direction = direction;
  s.reflected.weight = zero;
  s.reflected.media = 0;
  s.refracted = s.reflected;

  const Uint keys = encounter_keys(surface, camera->media);
  Mask todo = camera->active;
  while (ANY(todo)) {
    const Encounter e = next_encounter(scene, todo, surface, keys, camera->media);
    todo &= e.here == 0;
    const uint kind = e.material->surface;
    Vec3 arriving = weight;
#if HAS_ABSORPTION
    // [volume]
    if (top_medium(e.stack) != 0) arriving = multiply3(weight, media_transmittance(scene, e.stack, surface->t));
    // [/volume]
#endif
#if HAS_DIELECTRIC
    const float ratio = limits.eye_index / scene.media[top_medium(e.stack)].index;
    const Vec3 radiance_weight = scale3(ratio * ratio, arriving);
#else
    const Vec3 radiance_weight = arriving;
#endif

    // A light shows its front only.
    Vec3 own = uniform3(e.material->emission);
    if (e.material->front_only && !e.entering) own = zero;
    if (is_diffuse(e.material)) {
      const Vec3 rho_d = diffuse_reflectance(scene, e.material, surface);
      if (kind == SURFACE_UNLIT) own = add3(own, rho_d);
      if (kind == SURFACE_OPAQUE || kind == SURFACE_DIELECTRIC)
        s.scattering.diffuse = select3(e.here, multiply3(radiance_weight, rho_d), s.scattering.diffuse);
    }
    s.shown = select3(e.here, multiply3(radiance_weight, own), s.shown);
#if HAS_HIGHLIGHTS
    const float shininess = e.material->shininess;
    const Vec3 rho_s = scale3((shininess + 2.0f) * 0.15915494309189534f, uniform3(e.material->specular));
    s.scattering.specular = select3(e.here, multiply3(radiance_weight, rho_s), s.scattering.specular);
    s.scattering.shininess = e.here ? shininess : s.scattering.shininess;
#endif

    // [split]
    if (kind == SURFACE_MIRROR) {
      const Float left_over = max_channel(arriving);
      const Mask goes_on = goes_deeper ? e.here & (left_over >= limits.min_weight) : (Mask)0;
      s.reflected.active |= goes_on;
      s.reflected.rays.direction = select3(e.here, mirrored(e, surface, direction), s.reflected.rays.direction);
      s.reflected.weight = select3(e.here, arriving, s.reflected.weight);
      s.reflected.media = e.here ? e.stack : s.reflected.media;
      s.cut = (e.here & (goes_on == 0)) ? left_over : s.cut;
    }
#if HAS_DIELECTRIC
    if (kind == SURFACE_DIELECTRIC) {
      const Split split = split_at_dielectric(scene, e, surface, direction);
#if HAS_MEDIA_STACK
      if (split.hidden) {
        s.shown = select3(e.here, zero, s.shown);
        s.scattering.diffuse = select3(e.here, zero, s.scattering.diffuse);
#if HAS_HIGHLIGHTS
        s.scattering.specular = select3(e.here, zero, s.scattering.specular);
#endif
      }
#endif
      const Vec3 weight_reflected = scale3(split.R, arriving);
      const Vec3 weight_refracted = scale3(split.T, arriving);
      const Float reflected = max_channel(weight_reflected);
      const Float refracted = max_channel(weight_refracted);
      const Mask reflects = goes_deeper ? e.here & (reflected >= limits.min_weight) : (Mask)0;
      const Mask refracts = goes_deeper ? e.here & (refracted >= limits.min_weight) : (Mask)0;
      s.reflected.active |= reflects;
      s.reflected.rays.direction =
          select3(e.here, split_reflected(&split, direction), s.reflected.rays.direction);
      s.reflected.weight = select3(e.here, weight_reflected, s.reflected.weight);
      s.reflected.media = e.here ? split.stack_reflected : s.reflected.media;
      s.refracted.active |= refracts;
      s.refracted.rays.direction =
          select3(e.here, split_refracted(&split, direction), s.refracted.rays.direction);
      s.refracted.weight = select3(e.here, weight_refracted, s.refracted.weight);
      s.refracted.media = e.here ? split.stack_refracted : s.refracted.media;
      s.cut = e.here ? (reflects ? 0.0f : reflected) + (refracts ? 0.0f : refracted) : s.cut;
    }
#endif
    // [/split]
  }
  return s;
}

#endif
