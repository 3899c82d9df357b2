// Stage photon_interact: what surfaces do to photons: absorb, store, mirror, reflect or refract them.
// Reads: queue rays [0, count), materials, media; with meshes the surfaces that trace found.
// Writes: the same rays in place, outcomes, absorbed.
// Before: outcomes are ALIVE or ended. After: ended, with origin = where and weight = power; with meshes also ALIVE,
// with the next ray. Without meshes photons are followed to their end here, in registers.
#include "interact.h"
#include "outcome.h"
#include "sampler.h"
#if !HAS_MESH
#include "trace_exact.h"
#endif

typedef struct {
  Vec3 origin, direction;
  Vec3 power;                  // [W]
  Vec3 taken;                  // by media on the way [W]
  Float t_min;
  Uint stack, from, path;
  Uint depth;                  // surfaces met
  Uint outcome;
} PhotonPacket;

// What the surfaces do to the photons of `alive`.
FUNCTION void interact(const Scene scene, const SurfacePacket surface, const Mask alive, const uint max_depth,
                       PhotonPacket* photon) {
  const Vec3 direction = photon->direction;
  const Uint stack = photon->stack;
  const Mask entering = dot3(direction, surface.geometric_normal) < 0.0f;
  Uint outcome = OUTCOME_LOST;
  Vec3 next = direction;

  // [photon]
  Mask todo = alive & (surface.t < INFINITY);
  while (ANY(todo)) {
    const Encounter e = next_encounter(scene, todo, surface, stack, entering);
    todo &= e.here == 0;
#if HAS_ABSORPTION
    // What the medium takes is counted by itself, not as a difference.
    if (top_medium(e.stack) != 0) {
      const Vec3 taken = multiply3(photon->power, media_absorptance(scene, e.stack, surface.t));
      const Vec3 left_over = multiply3(photon->power, media_transmittance(scene, e.stack, surface.t));
      photon->taken = select3(e.here, add3(photon->taken, taken), photon->taken);
      photon->power = select3(e.here, left_over, photon->power);
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
      const Float u = unit_float(photon->depth < 2 ? photon->path : hash_pair(photon->path, photon->depth));
      const Mask reflect = u < split.R;
      next = select3(e.here, select3(reflect, split.reflected, split.refracted), next);
      photon->stack =
          e.here ? (reflect ? (Uint)split.stack_reflected : (Uint)split.stack_refracted) : photon->stack;
      const Float rest = reflect ? u / split.R : (u - split.R) / (1.0f - split.R);
      const Uint rest_bits =
          TO_UINT(smaller(rest, 0.99999994f) * 16777216.0f) << 8 | (hash32(photon->path) & 0xffu);
      photon->path = (e.here & (photon->depth < 2)) ? rest_bits : photon->path;
      outcome = e.here ? OUTCOME_ALIVE : outcome;
#endif
    } else {
      const int diffuse = e.material->surface == SURFACE_OPAQUE &&
                          (e.material->texture != NO_INDEX || e.material->diffuse[0] > 0.0f ||
                           e.material->diffuse[1] > 0.0f || e.material->diffuse[2] > 0.0f);
      const Uint caustic = photon->depth > 0 ? (Uint)OUTCOME_STORED : (Uint)OUTCOME_DIRECT;
      outcome = e.here ? (diffuse ? caustic : (Uint)OUTCOME_ABSORBED) : outcome;
    }
  }
  const Mask spent = (photon->depth + 1 >= max_depth) | (max_channel(photon->power) <= 0.0f);
  outcome = (outcome == OUTCOME_ALIVE) & spent ? OUTCOME_CUT : outcome;
  // [/photon]

  photon->outcome = alive ? outcome : photon->outcome;
  photon->origin = select3(alive, surface.position, photon->origin);
  photon->direction = select3(alive & (outcome == OUTCOME_ALIVE), next, direction);
  photon->t_min = alive ? leaving_t_min(surface, next) : photon->t_min;
  photon->from = alive ? surface.from : photon->from;
  photon->depth += alive ? (Uint)1 : (Uint)0;
}

__kernel void photon_interact(SCENE_PARAMETERS, const uint count, const uint stride, const uint max_depth,
                              __global const float* surfaces, __global float* rays, __global uint* outcomes,
                              __global float* absorbed) {
  const uint i = get_global_id(0) * WIDTH;
  if (i >= count) return;
  const Scene scene = SCENE;
  PhotonPacket photon;
  photon.origin = load3(rays, RAY_ORIGIN, stride, i);
  photon.direction = load3(rays, RAY_DIRECTION, stride, i);
  photon.power = load3(rays, RAY_WEIGHT, stride, i);
  photon.taken = make_vec3(0.0f, 0.0f, 0.0f);
  photon.t_min = load1(rays, RAY_T_MIN, stride, i);
  photon.stack = load_bits(rays, RAY_MEDIA, stride, i);
  photon.from = load_bits(rays, RAY_FROM, stride, i);
  photon.path = load_bits(rays, RAY_PATH, stride, i);
  photon.depth = load_bits(rays, RAY_SLOT, stride, i);
  photon.outcome = LOAD(outcomes, i);
  const Mask valid = lanes_below(i, count);
  Mask alive = valid & (photon.outcome == OUTCOME_ALIVE);

#if HAS_MESH
  interact(scene, load_surfaces(surfaces, stride, i), alive, max_depth, &photon);
#else
  while (ANY(alive)) {
    RayPacket packet;
    packet.origin = photon.origin;
    packet.direction = photon.direction;
    packet.t_min = photon.t_min;
    packet.t_max = INFINITY;
    Float u, v;
    interact(scene, trace_exact_shapes(scene, packet, photon.from, &u, &v), alive, max_depth, &photon);
    alive = valid & (photon.outcome == OUTCOME_ALIVE);
  }
#endif

  store3(rays, RAY_ORIGIN, stride, i, photon.origin);
  store3(rays, RAY_DIRECTION, stride, i, photon.direction);
  store3(rays, RAY_WEIGHT, stride, i, photon.power);
  STORE(outcomes, i, photon.outcome);
#if HAS_MESH
  store1(rays, RAY_T_MIN, stride, i, photon.t_min);
  store_bits(rays, RAY_MEDIA, stride, i, photon.stack);
  store_bits(rays, RAY_FROM, stride, i, photon.from);
  store_bits(rays, RAY_PATH, stride, i, photon.path);
#endif
  store_bits(rays, RAY_SLOT, stride, i, photon.depth);
#if HAS_ABSORPTION
  store3(absorbed, 0, stride, i, photon.taken);
#endif
}
