// WIDTH photons side by side, and those that wait until they are so many.
#ifndef VITRUM_PHOTON_PACKET_H
#define VITRUM_PHOTON_PACKET_H

#include "portability.h"
#include "switches.h"

typedef struct {
  Vec3 origin, direction;
  Vec3 power;                  // [W]
  Float t_min;
  Uint stack, from, path;
  Uint history;                // surfaces met, and what has branched off
#if HAS_PATCHES
  Uint point;                  // of the lattice of emission, or of those of branches; NO_POINT: none
  Uint branch_point;           // of the first lattice of branches; NO_POINT: what branches off here is left to others
  Uint way;                    // hash of what it met and did there: photons of one way are neighbours all along
  Float spacing;               // 1 / sqrt(probability) of its way where that was left to chance
#endif
  Mask alive;
} Photons;

// In `history`: by chance a photon has branched off this one, or this one off another; and how often one has branched off by
// the lattice, or that this one did.
#define HAS_BRANCHED 0x80000000u
#define BRANCH_SHIFT 29u
#define IS_BRANCH 3u

FUNCTION Uint surfaces_met(const Photons* photons) { return photons->history & ((1u << BRANCH_SHIFT) - 1u); }

// Photons that wait for a packet of their own: field f of the k-th at [f][k]. A packet is emitted only while fewer than
// WIDTH wait in either queue. One that is taken puts no more back than it had, and as many that branch off, which do not
// branch again: so less than 4 WIDTH wait in both. On a lattice six may come of one in four, of others two: less than 15
// WIDTH.
#if HAS_PATCHES
#define WAITING_FIELDS 18
#define WAITING_ROOM (16 * WIDTH)
#else
#define WAITING_FIELDS 14
#define WAITING_ROOM (6 * WIDTH)
#endif

typedef struct {
  float fields[WAITING_FIELDS][WAITING_ROOM];
  uint count;
} Waiting;

FUNCTION void wait_in(Waiting* waiting, const Photons* photons, const Mask which) {
  FOR_LANES(lane, which) {
    const uint k = waiting->count++;
    waiting->fields[0][k] = LANE(photons->origin.x, float, lane);
    waiting->fields[1][k] = LANE(photons->origin.y, float, lane);
    waiting->fields[2][k] = LANE(photons->origin.z, float, lane);
    waiting->fields[3][k] = LANE(photons->direction.x, float, lane);
    waiting->fields[4][k] = LANE(photons->direction.y, float, lane);
    waiting->fields[5][k] = LANE(photons->direction.z, float, lane);
    waiting->fields[6][k] = LANE(photons->power.x, float, lane);
    waiting->fields[7][k] = LANE(photons->power.y, float, lane);
    waiting->fields[8][k] = LANE(photons->power.z, float, lane);
    waiting->fields[9][k] = LANE(photons->t_min, float, lane);
    waiting->fields[10][k] = as_float(LANE(photons->stack, uint, lane));
    waiting->fields[11][k] = as_float(LANE(photons->from, uint, lane));
    waiting->fields[12][k] = as_float(LANE(photons->path, uint, lane));
    waiting->fields[13][k] = as_float(LANE(photons->history, uint, lane));
#if HAS_PATCHES
    waiting->fields[14][k] = as_float(LANE(photons->point, uint, lane));
    waiting->fields[15][k] = as_float(LANE(photons->way, uint, lane));
    waiting->fields[16][k] = LANE(photons->spacing, float, lane);
    waiting->fields[17][k] = as_float(LANE(photons->branch_point, uint, lane));
#endif
  }
}

// The last of those that wait, WIDTH of them at most.
FUNCTION Photons take_waiting(Waiting* waiting) {
  const uint taken = min(waiting->count, (uint)WIDTH);
  waiting->count -= taken;
  const uint k = waiting->count;
  Photons photons;
  photons.origin =
      make_vec3(LOAD(waiting->fields[0], k), LOAD(waiting->fields[1], k), LOAD(waiting->fields[2], k));
  photons.direction =
      make_vec3(LOAD(waiting->fields[3], k), LOAD(waiting->fields[4], k), LOAD(waiting->fields[5], k));
  photons.power = make_vec3(LOAD(waiting->fields[6], k), LOAD(waiting->fields[7], k), LOAD(waiting->fields[8], k));
  photons.t_min = LOAD(waiting->fields[9], k);
  photons.stack = AS_UINT(LOAD(waiting->fields[10], k));
  photons.from = AS_UINT(LOAD(waiting->fields[11], k));
  photons.path = AS_UINT(LOAD(waiting->fields[12], k));
  photons.history = AS_UINT(LOAD(waiting->fields[13], k));
#if HAS_PATCHES
  photons.point = AS_UINT(LOAD(waiting->fields[14], k));
  photons.way = AS_UINT(LOAD(waiting->fields[15], k));
  photons.spacing = LOAD(waiting->fields[16], k);
  photons.branch_point = AS_UINT(LOAD(waiting->fields[17], k));
#endif
  photons.alive = lanes_below(0, taken);
  return photons;
}

#endif
