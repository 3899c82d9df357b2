// One step of photons: what the surface that they have met does to them.
#ifndef VITRUM_PHOTON_STEP_H
#define VITRUM_PHOTON_STEP_H

#include "interact.h"
#include "outcome.h"
#include "photon_map.h"
#include "photon_packet.h"
#include "sampler.h"

// A sum of powers with what its roundings lost (Kahan), in each lane.
typedef struct {
  Vec3 sum, rest;
} Tally;

FUNCTION void add_compensated(Float* sum, Float* rest, const Float value) {
  const Float corrected = value + *rest;
  const Float next = *sum + corrected;
  *rest = corrected - (next - *sum);
  *sum = next;
}

FUNCTION void add_power(Tally* tally, const Mask which, const Vec3 power) {
  add_compensated(&tally->sum.x, &tally->rest.x, which ? power.x : 0.0f);
  add_compensated(&tally->sum.y, &tally->rest.y, which ? power.y : 0.0f);
  add_compensated(&tally->sum.z, &tally->rest.z, which ? power.z : 0.0f);
}

#if HAS_PATCHES
// The way of photons that go on before or behind a surface.
FUNCTION Uint way_on(const Photons* photons, const SurfacePacket* surface, const Mask front) {
  return hash_pair(photons->way, surface->material << 1 | ((front == surface->entering) ? (Uint)1 : (Uint)0));
}
#endif

// Where photons go on after a surface.
typedef struct {
  Vec3 next;                   // direction
  Mask front;                  // before the surface
  Uint outcome;
} Onward;

// What the material that the first of `todo` meets does to all that meet it, who are taken off `todo`. The rest is as of
// `interact`.
FUNCTION void meet(const Scene scene, const SurfacePacket* surface, const Uint keys, const Uint stack, const Uint depth,
                   const Mask is_last, Waiting* branches, const uint branch_points, Mask* todo, Photons* photons, Onward* on,
                   uint* n_branched, Tally* absorbed, Tally* split_off) {
  const Vec3 direction = photons->direction;
  const Mask entering = surface->entering;
  // [photon]
  const Encounter e = next_encounter(scene, *todo, surface, keys, stack);
  *todo &= e.here == 0;
#if HAS_ABSORPTION
  // What the medium takes is counted by itself, not as a difference.
  if (top_medium(e.stack) != 0) {
    Vec3 left_over, taken;
    media_attenuation(scene, e.stack, surface->t, &left_over, &taken);
    add_power(absorbed, e.here, multiply3(photons->power, taken));
    photons->power = select3(e.here, multiply3(photons->power, left_over), photons->power);
  }
#endif
  if (e.material->surface == SURFACE_MIRROR) {
    on->next = select3(e.here, mirrored(e, surface, direction), on->next);
    on->outcome = e.here ? OUTCOME_ALIVE : on->outcome;
#if HAS_DIELECTRIC
  } else if (e.material->surface == SURFACE_DIELECTRIC) {
    const Split split = split_at_dielectric(scene, e, surface, direction);
    // One random number serves the first two choices: what a choice leaves of it is uniform again. Later ones are
    // drawn anew, before its bits run out.
    const Mask first_two = depth < 2;
    Float u = unit_float(photons->path);
    if (ANY(e.here & (first_two == 0)))
      u = first_two ? u : unit_float(hash_pair(photons->path, depth));
    const Mask may_branch = branches ? e.here & (is_last == 0) : (Mask)0;
#if HAS_PATCHES
    const Uint times = photons->history >> BRANCH_SHIFT & 3u;
    const Mask by_lattice = may_branch & (photons->point != NO_POINT) & (times < 2u);
    // Refracted as long as that is possible, so that neighbours part only where there is no light.
    const Mask mostly_reflects = by_lattice ? split.T <= 0.0f : split.R > split.T;
    const Float lesser = mostly_reflects ? split.T : split.R;
    const Mask leaves_lattice = by_lattice & (photons->branch_point != NO_POINT) & (lesser > 0.0f);
#else
    const Mask by_lattice = 0;
    const Mask leaves_lattice = 0;
    const Mask mostly_reflects = split.R > split.T;
    const Float lesser = mostly_reflects ? split.T : split.R;
#endif
    const Mask drawn = (u < lesser) & (by_lattice == 0);
    const Mask splits = by_lattice | (may_branch & ((photons->history & HAS_BRANCHED) == 0));
    const Mask leaves = (splits & drawn) | leaves_lattice;
    const Float gathered = leaves_lattice ? BRANCH_STEP * BRANCH_STEP * lesser : (Float)1.0f;
    const Mask reflect = mostly_reflects != ((drawn & (splits == 0)) != 0);
    on->next = select3(e.here, split_chosen(&split, reflect, direction), on->next);
    on->front = (e.here & (reflect == 0)) ? entering == 0 : on->front;
    photons->stack =
        e.here ? (reflect ? (Uint)split.stack_reflected : (Uint)split.stack_refracted) : photons->stack;
    if (branches && ANY(leaves)) {
      photons->history |= (leaves & (leaves_lattice == 0)) ? HAS_BRANCHED : (Uint)0;
      // They wait at once, since what is kept for later is kept in memory anyway.
      Photons branched;
      branched.origin = surface->position;
      branched.t_min = surface->error;
      branched.power = scale3(gathered, photons->power);
      branched.direction = split_chosen(&split, mostly_reflects == 0, direction);
      branched.stack = mostly_reflects ? (Uint)split.stack_refracted : (Uint)split.stack_reflected;
      const Mask front_branched = mostly_reflects ? entering == 0 : entering;
      branched.from = leaving(surface, front_branched);
      branched.path = hash_pair(photons->path, depth | HAS_BRANCHED);
      branched.history = (photons->history + 1u) | IS_BRANCH << BRANCH_SHIFT;
#if HAS_PATCHES
      branched.spacing = photons->spacing * (leaves_lattice ? (Float)BRANCH_STEP : 1.0f / sqrt(lesser));
      branched.point = leaves_lattice ? photons->branch_point + times * branch_points : (Uint)NO_POINT;
      branched.branch_point = NO_POINT;
      branched.way = way_on(photons, surface, front_branched);
#endif
      wait_in(&branches[0], &branched, leaves & (branched.stack == 0));
      wait_in(&branches[1], &branched, leaves & (branched.stack != 0));
      *n_branched += lanes_set(leaves);
    }
#if HAS_PATCHES
    photons->spacing = (e.here & drawn & (splits == 0)) ? photons->spacing / sqrt(lesser) : photons->spacing;
    photons->history += (by_lattice & (lesser > 0.0f)) ? (Uint)(1u << BRANCH_SHIFT) : (Uint)0;
#endif
    add_power(split_off, splits, scale3((leaves ? gathered : (Float)0.0f) - lesser, photons->power));
    photons->power = select3(splits, scale3(1.0f - lesser, photons->power), photons->power);
    const Float rest = (drawn ? u : u - lesser) / (drawn ? lesser : 1.0f - lesser);
    // The low bits, which no choice has used, serve for the hash.
    const Uint rest_bits = AS_UINT(TO_INT(smaller(rest, 0.99999994f) * 16777216.0f)) << 8 | (photons->path & 0xffu);
    photons->path = (e.here & first_two & (by_lattice == 0)) ? rest_bits : photons->path;
    on->outcome = e.here ? OUTCOME_ALIVE : on->outcome;
#endif
  } else {
    const int diffuse = e.material->surface == SURFACE_OPAQUE && is_diffuse(e.material);
    const Uint caustic = depth > 0 ? (Uint)OUTCOME_STORED : (Uint)OUTCOME_DIRECT;
    on->outcome = e.here ? (diffuse ? caustic : (Uint)OUTCOME_ABSORBED) : on->outcome;
  }
  // [/photon]
}

// Adds to `photons->power` and tallies, and more: what the surface does to the living photons. Returns their outcome, and
// with that ALIVE their next ray. Adds what the media before it took to `absorbed`.
//
// Where light is split, a photon goes the way of the greater share, and its power is that share. The other way goes, by
// chance, as often as its share says, a photon with all of the power. So what most of the light does is not left to
// chance, which would make holes in the caustic. Those that branch off wait in `branches`, outside of all media or inside,
// and are added to `n_branched`; `split_off` is the power that this gave less what it took: 0 on average. Once a photon has
// branched, and where there is no room to wait (`branches` is 0), it takes all of its power along and itself goes the lesser
// way by that chance.
//
// On a lattice of emission nothing is left to chance the first two times: every few photons along both axes, one with the
// power of all of them goes the lesser way. Those are a lattice of `branch_points` again, of neighbours that go one way.
FUNCTION Uint interact(const Scene scene, const SurfacePacket* surface, const uint max_depth, Waiting* branches,
                       const uint branch_points, Photons* photons, uint* n_branched, Tally* absorbed, Tally* split_off) {
  const Mask alive = photons->alive;
  const Uint stack = photons->stack;
  const Uint depth = surfaces_met(photons);
  const Mask is_last = depth + 1 >= max_depth;
  Onward on;
  on.next = photons->direction;
  on.front = surface->entering;
  on.outcome = OUTCOME_LOST;
  const Uint keys = encounter_keys(surface, stack);
  Mask todo = alive & (surface->t < INFINITY);
  // Most packets meet one material, which costs less by itself than in a loop: what that carries from turn to turn is much.
  if (ANY(todo))
    meet(scene, surface, keys, stack, depth, is_last, branches, branch_points, &todo, photons, &on, n_branched, absorbed,
         split_off);
  while (ANY(todo))
    meet(scene, surface, keys, stack, depth, is_last, branches, branch_points, &todo, photons, &on, n_branched, absorbed,
         split_off);
  const Mask spent = is_last | (max_channel(photons->power) <= 0.0f);
  const Uint outcome = (on.outcome == OUTCOME_ALIVE) & spent ? OUTCOME_CUT : on.outcome;

  photons->history += alive ? (Uint)1 : (Uint)0;
  photons->origin = surface->position;
  photons->t_min = surface->error;
  photons->from = leaving(surface, on.front);
  // Those that end keep the direction that they came from.
  photons->direction = on.next;
  photons->alive = alive & (outcome == OUTCOME_ALIVE);
#if HAS_PATCHES
  photons->way = way_on(photons, surface, on.front);
#endif
  return alive ? outcome : (Uint)OUTCOME_ALIVE;
}

#endif
