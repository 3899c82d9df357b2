// Stage camera_shade: what each ray's surface shows by itself, what of it scatters, and the rays that it makes.
// Reads: queue rays and surfaces [0, count), materials, media, textures.
// Writes: shares (emission, cut; caustics 0), scatter, children.
#include "film.h"
#include "interact.h"

// Writes the lanes of `here` only; another group of the packet may have written the others.
FUNCTION void store_child(__global float* children, uint direction_field, uint weight_field, uint stack_field,
                          uint stride, uint i, Mask here, Vec3 direction, Vec3 weight, uint stack) {
  if (!ANY(here)) return;
  store3(children, direction_field, stride, i, select3(here, direction, load3(children, direction_field, stride, i)));
  store3(children, weight_field, stride, i, select3(here, weight, load3(children, weight_field, stride, i)));
  store_bits(children, stack_field, stride, i, here ? stack : load_bits(children, stack_field, stride, i));
}

// `eye_index`: index of refraction at the eye. Radiance scales by (n_eye / n)^2 from a medium of index n (basic
// radiance, Nicodemus 1963), which is applied where light joins the path, so that borders passed in between cancel.
__kernel void camera_shade(SCENE_PARAMETERS, const uint count, const uint stride, const uint depth,
                           const uint max_depth, const float min_weight, const float eye_index,
                           __global const float* rays, __global const float* surfaces, __global float* shares,
                           __global float* scatter, __global float* children) {
  const uint i = get_global_id(0) * WIDTH;
  if (i >= count) return;
  const Scene scene = SCENE;
  const Vec3 direction = load3(rays, RAY_DIRECTION, stride, i);
  const Uint stack = load_bits(rays, RAY_MEDIA, stride, i);
  const SurfacePacket surface = load_surfaces(surfaces, stride, i);
  const Mask entering = dot3(direction, surface.geometric_normal) < 0.0f;
  const Vec3 weight = load3(rays, RAY_WEIGHT, stride, i);
  const Vec3 zero = make_vec3(0.0f, 0.0f, 0.0f);

  Vec3 shown = zero;
  Vec3 diffuse = zero;
  Vec3 specular = zero;
  Float shininess = 0.0f;
  Float cut = 0.0f;
  Uint which = 0;
  Mask todo = lanes_below(i, count);
  while (ANY(todo)) {
    const Encounter e = next_encounter(scene, todo, surface, stack, entering);
    todo &= e.here == 0;
    const uint kind = e.material->surface;
    Vec3 arriving = weight;
#if HAS_ABSORPTION
    // [volume]
    if (top_medium(e.stack) != 0) arriving = multiply3(weight, media_transmittance(scene, e.stack, surface.t));
    // [/volume]
#endif
#if HAS_DIELECTRIC
    const float ratio = eye_index / scene.media[top_medium(e.stack)].index;
    const Vec3 radiance_weight = scale3(ratio * ratio, arriving);
#else
    const Vec3 radiance_weight = arriving;
#endif

    // A light shows its front only.
    Vec3 own = uniform3(e.material->emission);
    if (e.material->front_only && !e.entering) own = zero;
    if (e.material->texture != NO_INDEX || e.material->diffuse[0] > 0.0f || e.material->diffuse[1] > 0.0f ||
        e.material->diffuse[2] > 0.0f) {
      const Vec3 rho_d = diffuse_reflectance(scene, e.material, surfaces, stride, i);
      if (kind == SURFACE_UNLIT) own = add3(own, rho_d);
      if (kind == SURFACE_OPAQUE || kind == SURFACE_DIELECTRIC)
        diffuse = select3(e.here, multiply3(radiance_weight, rho_d), diffuse);
    }
    shown = select3(e.here, multiply3(radiance_weight, own), shown);
#if HAS_HIGHLIGHTS
    const float s = e.material->shininess;
    const Vec3 rho_s = scale3((s + 2.0f) * 0.15915494309189534f, uniform3(e.material->specular));
    specular = select3(e.here, multiply3(radiance_weight, rho_s), specular);
    shininess = e.here ? s : shininess;
#endif

    // [split]
    if (kind == SURFACE_MIRROR) {
      const Mask goes_on = e.here & (max_channel(arriving) >= min_weight) & (depth + 1 < max_depth ? e.here : (Mask)0);
      store_child(children, CHILD_REFLECTED, CHILD_WEIGHT_REFLECTED, CHILD_STACK_REFLECTED, stride, i, goes_on,
                  mirrored(e, surface, direction), arriving, e.stack);
      which = goes_on ? (Uint)1 : which;
      cut = (e.here & (goes_on == 0)) ? max_channel(arriving) : cut;
    }
#if HAS_DIELECTRIC
    if (kind == SURFACE_DIELECTRIC) {
      const Split split = split_at_dielectric(scene, e, surface, direction);
#if HAS_MEDIA_STACK
      if (split.hidden) {
        shown = select3(e.here, zero, shown);
        diffuse = select3(e.here, zero, diffuse);
        specular = select3(e.here, zero, specular);
      }
#endif
      const Vec3 weight_reflected = scale3(split.R, arriving);
      const Vec3 weight_refracted = scale3(split.T, arriving);
      const Float reflected = max_channel(weight_reflected);
      const Float refracted = max_channel(weight_refracted);
      const Mask deep = depth + 1 < max_depth ? e.here : (Mask)0;
      const Mask reflects = deep & (reflected >= min_weight);
      const Mask refracts = deep & (refracted >= min_weight);
      which = e.here ? (reflects ? (Uint)1 : (Uint)0) | (refracts ? (Uint)2 : (Uint)0) : which;
      cut = e.here ? (reflects ? 0.0f : reflected) + (refracts ? 0.0f : refracted) : cut;
      store_child(children, CHILD_REFLECTED, CHILD_WEIGHT_REFLECTED, CHILD_STACK_REFLECTED, stride, i, reflects,
                  split.reflected, weight_reflected, split.stack_reflected);
      store_child(children, CHILD_REFRACTED, CHILD_WEIGHT_REFRACTED, CHILD_STACK_REFRACTED, stride, i, refracts,
                  split.refracted, weight_refracted, split.stack_refracted);
    }
#endif
    // [/split]
  }

  const Vec3 normal = select3(dot3(direction, surface.shading_normal) > 0.0f, negate3(surface.shading_normal),
                              surface.shading_normal);
  store3(shares, SHARE_BEAUTY, stride, i, shown);
  store3(shares, SHARE_CAUSTICS, stride, i, zero);
  store1(shares, SHARE_CUT, stride, i, cut);
  store3(scatter, SCATTER_DIFFUSE, stride, i, diffuse);
#if HAS_HIGHLIGHTS
  store3(scatter, SCATTER_SPECULAR, stride, i, specular);
  store1(scatter, SCATTER_SHININESS, stride, i, shininess);
#endif
  store3(scatter, SCATTER_NORMAL, stride, i, normal);
  store_bits(children, CHILD_WHICH, stride, i, which);
}
