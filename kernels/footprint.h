// Footprints of photons: each photon of a lattice of emission stands for a cell of it, which reflection and refraction carry
// to a parallelogram on the receiver. There its power is spread, by a tent over it and its neighbours, which together are 1
// everywhere. Photon differentials (Igehy, Tracing Ray Differentials, 1999; Schjoth et al., Photon Differentials, 2007) tell
// the parallelogram from derivatives of each surface; here its sides are the differences to the neighbours that went the
// same way, which asks nothing of the surfaces, and sees their facets as they are.
#ifndef VITRUM_FOOTPRINT_H
#define VITRUM_FOOTPRINT_H

#include "lights.h"
#include "photon_map.h"
#include "sampler.h"

// A place on the lattice in the disc of emission, of radius 1: Shirley and Chiu, A Low Distortion Map Between Disk and Square,
// 1997. Neighbours in the square are neighbours in the disc. (column, row) need not be a point.
//
// Towards the rim points lie ever closer, and have ever less power. There light grazes a ball, and where it goes changes as
// the square root of the distance from the rim, which that evens out: else all that is reflected beside a ball's shadow
// comes from the outermost points, and the error of its caustic is two to three times as large.
typedef struct {
  Mask wide;                   // in the wedges about the x axis
  Float radius;                // less than 0: on the other side
  Float turns;                 // from that axis, to which the wedge belongs, towards the other: -1/8 to 1/8
  Float weight;                // of the disc by that of the square
} InWedge;

// Of the square's area, counted from the middle, the share that is spread evenly.
#define RIM_BEGINS 0.6f
#define RIM_SCALE (2.0f / (1.0f + RIM_BEGINS))

FUNCTION InWedge place_in_wedge(const LatticeData lattice, const Float column, const Float row) {
  const Float x = fma((Float)2.0f, (column + lattice.shift_u) / (float)lattice.columns, (Float)-1.0f);
  const Float y = fma((Float)2.0f, (row + lattice.shift_v) / (float)(1u << lattice.log2_rows), (Float)-1.0f);
  InWedge p;
  p.wide = fabs(x) > fabs(y);
  const Float side = p.wide ? x : y;
  p.turns = 0.125f * ((p.wide ? y : x) / (side == 0.0f ? (Float)1.0f : side));
  const Float inside = larger(fma(-side, side, (Float)1.0f), (Float)1e-6f);  // of the square's area, counted from the rim
  const Float near_rim = inside / (1.0f - RIM_BEGINS);
  const Mask is_near = near_rim < 1.0f;
  p.weight = RIM_SCALE * (is_near ? near_rim : (Float)1.0f);
  const Float from_rim = 0.5f * RIM_SCALE * inside * near_rim;
  const Float even = sqrt((float)RIM_SCALE);
  p.radius = is_near ? (side < 0.0f ? (Float)-1.0f : (Float)1.0f) * sqrt(1.0f - from_rim) : even * side;
  return p;
}

// A point of the lattice as what emission takes: the square of the radius in the disc, and the angle in turns.
// Returns its weight.
FUNCTION Float lattice_point(const LatticeData lattice, const Uint point, Float u[2]) {
  const Float column = TO_FLOAT(AS_INT(point >> lattice.log2_rows));
  const Float row = TO_FLOAT(AS_INT(point & ((1u << lattice.log2_rows) - 1u)));
  const InWedge p = place_in_wedge(lattice, column, row);
  const Float turns = (p.wide ? p.turns : 0.25f - p.turns) + (p.radius < 0.0f ? 0.5f : 0.0f);
  const Float below_1 = 0.99999994f;
  u[0] = smaller(p.radius * p.radius, below_1);
  u[1] = smaller(turns < 0.0f ? turns + 1.0f : turns, below_1);
  return p.weight;
}

// Where a point is on its lattice, which may be one of branches.
typedef struct {
  Uint column, row;            // whole steps
  Uint to_column;              // from a point to that of the next column
  Float step;                  // of the whole lattice: 1, or BRANCH_STEP
  Mask first_column, last_column, first_row, last_row;
} LatticePlace;

// A place in the disc of emission.
typedef struct {
  Float x, y, weight;
} DiscPlace;

FUNCTION DiscPlace place_in_disc(const LatticeData lattice, const Float column, const Float row) {
  const InWedge p = place_in_wedge(lattice, column, row);
  Float sine, cosine;
  sin_cos_turn(p.turns, &sine, &cosine);
  DiscPlace disc;
  disc.x = p.radius * (p.wide ? cosine : sine);
  disc.y = p.radius * (p.wide ? sine : cosine);
  disc.weight = p.weight;
  return disc;
}

FUNCTION LatticePlace place_on_lattice(const LatticeData lattice, const Uint point) {
  const uint all = lattice_points(lattice);
  const uint branches = branch_points(lattice);
  const Mask is_branch = point >= all;
  const Uint base = is_branch ? (point >= all + branches ? (Uint)(all + branches) : (Uint)all) : (Uint)0;
  const Uint log2_rows = is_branch ? (Uint)(lattice.log2_rows - BRANCH_LOG2) : (Uint)lattice.log2_rows;
  const Uint columns = is_branch ? (Uint)branch_columns(lattice) : (Uint)lattice.columns;
  LatticePlace p;
  p.to_column = (Uint)1 << log2_rows;
  p.step = is_branch ? (Float)BRANCH_STEP : (Float)1.0f;
  p.column = (point - base) >> log2_rows;
  p.row = (point - base) & (p.to_column - 1u);
  p.first_column = p.column == 0u;
  p.last_column = p.column + 1u >= columns;
  p.first_row = p.row == 0u;
  p.last_row = p.row + 1u >= p.to_column;
  return p;
}

// The parallelogram's sides, and into how many parts each is cut.
typedef struct {
  Vec3 side_u, side_v;         // [m], in the receiver's plane
  Vec3 across_u, across_v;     // [1/m]: of a part, what is from -1 to 1 across its tent
  Float area;                  // [m2]
  Uint parts_u, parts_v;
  Uint level;                  // of the grid
} Footprint;

// More parts make more entries of the map, fewer larger cells with more to look at: with 8, a lamp between two balls takes twice
// the memory and time; with 2, a caustic takes longer to gather.
#define FOOTPRINT_MOST_PARTS 4.0f
#define FOOTPRINT_MOST_APART 8.0f
// Sides beyond so many times `largest` are cut off: two parts of the highest level.
#define FOOTPRINT_MOST_SIDE 128.0f

// Side of the square of photons that have no neighbours [m]. Alone on its way, one of a lattice is one of few, farther apart.
FUNCTION Float side_alone(const FootprintLimits limits, const Mask on_lattice, const Float spacing) {
  const Float apart = on_lattice ? larger(spacing, (Float)LEVEL_RATIO) : spacing;
  return limits.largest * smaller(apart, (Float)FOOTPRINT_MOST_APART);
}

// Into how many parts no larger than `largest` a side of this length is cut.
FUNCTION Float parts_of(const Float side, const float largest) {
  return larger(ceil(side / largest - 0.001f), (Float)1.0f);
}

// From a photon's place towards its neighbour ahead, or from that behind to it. Where both went the same way and lie about
// as far, it is their mean; else the nearer's, so that footprints do not bridge what a facet's edge has torn apart.
FUNCTION Vec3 difference(__global const float* landings, const Vec3 place, const Uint way, const Uint ahead,
                         const Mask is_ahead, const Uint behind, const Mask is_behind, Mask* found, Mask* at_edge) {
  const Uint to = LANDING_ROW * (is_ahead ? ahead : (Uint)0);
  const Uint from = LANDING_ROW * (is_behind ? behind : (Uint)0);
  const Vec3 forward = subtract3(GATHER3(landings, to), place);
  const Vec3 backward = subtract3(place, GATHER3(landings, from));
  const Mask has_ahead = is_ahead & (AS_UINT(GATHER(Float, landings, to + LANDING_WAY)) == way);
  const Mask has_behind = is_behind & (AS_UINT(GATHER(Float, landings, from + LANDING_WAY)) == way);
  const Float forward2 = dot3(forward, forward);
  const Float backward2 = dot3(backward, backward);
  const Mask alike = has_ahead & has_behind & (forward2 < 4.0f * backward2) & (backward2 < 4.0f * forward2);
  const Mask goes_ahead = has_ahead & ((has_behind == 0) | (forward2 < backward2));
  *found &= has_ahead | has_behind;
  *at_edge |= (has_ahead & has_behind) == 0;
  return select3(alike, scale3(0.5f, add3(forward, backward)), select3(goes_ahead, forward, backward));
}

// Of photons that arrived at `place` on a surface with this normal. Those without a lattice or alone on their way spread
// over a square.
FUNCTION Footprint footprint_of(const LatticeData lattice, __global const float* landings, const FootprintLimits limits,
                                const Uint point, const Float spacing, const Vec3 place, const Vec3 normal) {
  Mask found = lattice.columns > 0 ? point != NO_POINT : (Mask)0;
  const Mask on_lattice = found;
  Mask at_edge = 0;            // of those that went its way
  const Uint own = on_lattice ? point : (Uint)0;
  Vec3 u = make_vec3(0.0f, 0.0f, 0.0f);
  Vec3 v = u;
  if (ANY(on_lattice)) {
    const Uint way = AS_UINT(GATHER(Float, landings, LANDING_ROW * own + LANDING_WAY));
    const LatticePlace at = place_on_lattice(lattice, own);
    u = difference(landings, place, way, own + at.to_column, on_lattice & (at.last_column == 0), own - at.to_column,
                   on_lattice & (at.first_column == 0), &found, &at_edge);
    v = difference(landings, place, way, own + 1u, on_lattice & (at.last_row == 0), own - 1u,
                   on_lattice & (at.first_row == 0), &found, &at_edge);
  }

  // The sides as a matrix (a b; c d) in the receiver's plane, its columns u and v.
  const Frame frame = frame_around(normal);
  const Float off_u = dot3(u, normal);
  const Float off_v = dot3(v, normal);
  found &= (off_u * off_u <= 0.25f * dot3(u, u)) & (off_v * off_v <= 0.25f * dot3(v, v));
  const Float alone = side_alone(limits, on_lattice, spacing);
  Float a = found ? dot3(u, frame.x) : alone;
  Float b = found ? dot3(v, frame.x) : 0.0f;
  Float c = found ? dot3(u, frame.y) : 0.0f;
  Float d = found ? dot3(v, frame.y) : alone;

  // Where light is focussed, a footprint shrinks to nothing, which a pixel's samples would miss or catch by chance. So its
  // axes (singular values q + r and q - r) are at least what lies between samples, and at most what few parts reach over.
  const Float x = place.x - limits.eye[0];
  const Float y = place.y - limits.eye[1];
  const Float z = place.z - limits.eye[2];
  const Float sample = limits.sharpness * sqrt(fma(x, x, fma(y, y, z * z)));
  const Float least = larger(smaller(sample, (Float)limits.largest), (Float)(1e-3f * limits.largest));
  const Float most = FOOTPRINT_MOST_SIDE * limits.largest;
  const Float half_sum = 0.5f * (a + d);
  const Float half_difference = 0.5f * (a - d);
  const Float half_turn = 0.5f * (c - b);
  const Float half_shear = 0.5f * (c + b);
  const Float q = sqrt(fma(half_sum, half_sum, half_turn * half_turn));
  const Float r = sqrt(fma(half_difference, half_difference, half_shear * half_shear));
  const Float long_axis = larger(smaller(q + r, most), least);
  // At an edge the neighbours may lie along it, and say nothing of what is across.
  const Float least_short = at_edge ? larger(least, 0.125f * long_axis) : least;
  const Float short_axis = larger(smaller(fabs(q - r), most), least_short);
  const Float signed_short = q < r ? -short_axis : short_axis;
  const Float new_q = 0.5f * (long_axis + signed_short);
  const Float new_r = 0.5f * (long_axis - signed_short);
  const Float grow_q = q > 0.0f ? new_q / q : 0.0f;
  const Float grow_r = r > 0.0f ? new_r / r : 0.0f;
  const Float sum = q > 0.0f ? grow_q * half_sum : new_q;
  const Float turn = grow_q * half_turn;
  const Float stretch = r > 0.0f ? grow_r * half_difference : new_r;
  const Float shear = grow_r * half_shear;
  a = sum + stretch;
  d = sum - stretch;
  b = shear - turn;
  c = shear + turn;

  Footprint f;
  f.side_u = add3(scale3(a, frame.x), scale3(c, frame.y));
  f.side_v = add3(scale3(b, frame.x), scale3(d, frame.y));
  const Float determinant = long_axis * signed_short;
  f.area = long_axis * short_axis;
  const Float length_u = sqrt(fma(a, a, c * c));
  const Float length_v = sqrt(fma(b, b, d * d));
  Float parts_u = parts_of(length_u, limits.largest);
  Float parts_v = parts_of(length_v, limits.largest);
  f.level = 0;
  for (uint level = 1; level < LEVELS; ++level) {
    const Mask is_large = parts_u * parts_v > FOOTPRINT_MOST_PARTS;
    parts_u = is_large ? parts_of(length_u, level_scale(level) * limits.largest) : parts_u;
    parts_v = is_large ? parts_of(length_v, level_scale(level) * limits.largest) : parts_v;
    f.level = is_large ? (Uint)level : f.level;
  }
  f.across_u = scale3(parts_u / determinant, add3(scale3(d, frame.x), scale3(-b, frame.y)));
  f.across_v = scale3(parts_v / determinant, add3(scale3(-c, frame.x), scale3(a, frame.y)));
  f.parts_u = AS_UINT(TO_INT(parts_u));
  f.parts_v = AS_UINT(TO_INT(parts_v));
  return f;
}

#endif
