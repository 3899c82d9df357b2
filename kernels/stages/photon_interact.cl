// Stage photon_interact: what each photon's surface does to it: absorbs, stores, mirrors, reflects or refracts it.
// Reads: queue rays and surfaces [0, count), materials, media. Writes: the same rays in place, outcomes, absorbed.
// Before: outcomes are ALIVE or ended. After: ALIVE, with the next ray; or ended, with origin = where, weight = power.
#include "interact.h"
#include "outcome.h"
#include "sampler.h"

__kernel void photon_interact(SCENE_PARAMETERS, const uint count, const uint stride, const uint max_depth,
                              __global const float* surfaces, __global float* rays, __global uint* outcomes,
                              __global float* absorbed) {
  const uint i = get_global_id(0) * WIDTH;
  if (i >= count) return;
  const Scene scene = SCENE;
  const Uint before = LOAD(outcomes, i);
  const Mask alive = lanes_below(i, count) & (before == OUTCOME_ALIVE);
  if (!ANY(alive)) {
#if HAS_ABSORPTION
    store3(absorbed, 0, stride, i, make_vec3(0.0f, 0.0f, 0.0f));
#endif
    return;
  }
  const Vec3 direction = load3(rays, RAY_DIRECTION, stride, i);
  const Uint stack = load_bits(rays, RAY_MEDIA, stride, i);
  const Uint depth = load_bits(rays, RAY_SLOT, stride, i);
  const Uint path = load_bits(rays, RAY_PATH, stride, i);
  const SurfacePacket surface = load_surfaces(surfaces, stride, i);
  const Mask entering = dot3(direction, surface.geometric_normal) < 0.0f;
  const Mask met = alive & (surface.t < INFINITY);
  Vec3 power = load3(rays, RAY_WEIGHT, stride, i);
  Vec3 next = direction;
  Uint next_stack = stack;
  Uint next_path = path;
  Uint outcome = OUTCOME_LOST;
#if HAS_ABSORPTION
  Vec3 taken = make_vec3(0.0f, 0.0f, 0.0f);
#endif

  // [photon]
  Mask todo = met;
  while (ANY(todo)) {
    const Encounter e = next_encounter(scene, todo, surface, stack, entering);
    todo &= e.here == 0;
#if HAS_ABSORPTION
    // What the medium takes is counted by itself, not as a difference.
    if (top_medium(e.stack) != 0) {
      taken = select3(e.here, multiply3(power, media_absorptance(scene, e.stack, surface.t)), taken);
      power = select3(e.here, multiply3(power, media_transmittance(scene, e.stack, surface.t)), power);
    }
#endif
    if (e.material->surface == SURFACE_MIRROR) {
      next = select3(e.here, mirrored(e, surface, direction), next);
      outcome = e.here ? OUTCOME_ALIVE : outcome;
#if HAS_DIELECTRIC
    } else if (e.material->surface == SURFACE_DIELECTRIC) {
      const Split split = split_at_dielectric(scene, e, surface, direction);
      // One random number serves the first two choices: what a choice leaves of it is uniform again. Later ones are
      // drawn anew, before its bits run out.
      const Float u = unit_float(depth < 2 ? path : hash_pair(path, depth));
      const Mask reflect = u < split.R;
      next = select3(e.here, select3(reflect, split.reflected, split.refracted), next);
      next_stack = e.here ? (reflect ? (Uint)split.stack_reflected : (Uint)split.stack_refracted) : next_stack;
      const Float rest = reflect ? u / split.R : (u - split.R) / (1.0f - split.R);
      const Uint rest_bits = TO_UINT(smaller(rest, 0.99999994f) * 16777216.0f) << 8 | (hash32(path) & 0xffu);
      next_path = (e.here & (depth < 2)) ? rest_bits : next_path;
      outcome = e.here ? OUTCOME_ALIVE : outcome;
#endif
    } else {
      const int diffuse = e.material->surface == SURFACE_OPAQUE &&
                          (e.material->texture != NO_INDEX || e.material->diffuse[0] > 0.0f ||
                           e.material->diffuse[1] > 0.0f || e.material->diffuse[2] > 0.0f);
      const Uint end = diffuse ? (depth > 0 ? (Uint)OUTCOME_STORED : (Uint)OUTCOME_DIRECT) : (Uint)OUTCOME_ABSORBED;
      outcome = e.here ? end : outcome;
    }
  }
  const Mask spent = (depth + 1 >= max_depth) | (max_channel(power) <= 0.0f);
  outcome = (outcome == OUTCOME_ALIVE) & spent ? OUTCOME_CUT : outcome;
  // [/photon]

  const Mask goes_on = outcome == OUTCOME_ALIVE;
  store3(rays, RAY_ORIGIN, stride, i, select3(alive, surface.position, load3(rays, RAY_ORIGIN, stride, i)));
  store3(rays, RAY_DIRECTION, stride, i, select3(goes_on, next, direction));
  store1(rays, RAY_T_MIN, stride, i, leaving_t_min(surface, next));
  store3(rays, RAY_WEIGHT, stride, i, power);
  store_bits(rays, RAY_MEDIA, stride, i, next_stack);
  store_bits(rays, RAY_FROM, stride, i, surface.from);
  store_bits(rays, RAY_PATH, stride, i, next_path);
  store_bits(rays, RAY_SLOT, stride, i, depth + 1);
  STORE(outcomes, i, alive ? outcome : before);
#if HAS_ABSORPTION
  store3(absorbed, 0, stride, i, taken);
#endif
}
