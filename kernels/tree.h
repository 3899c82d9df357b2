// Traversal of the tree over triangles: SIMD inside the ray, 8 boxes or 4 triangles at a time, and WIDTH rays in turns,
// so that each one's next node is on its way from memory while the others go on.
//
// What a ray hits is decided by the triangle test alone: it is watertight (Woop, Benthin and Wald, Watertight
// Ray/Triangle Intersection, JCGT 2013), two-sided, and edges and corners belong to the triangle. The boxes are only
// there to be fast. Their padding covers every rounding of both tests, so the result does not hang on the tree:
// with u = 2^-24 and m = the largest coordinate of a box's corners as seen from the ray's origin, the sheared corners
// of a triangle are off by 9 u m, its t by 21 u m / |d_z|, the planes' t by 8 u m / |d| (division 2.5 ulp, as OpenCL
// grants); m is at most the sum of the largest coordinates of box and origin, and TREE_PADDING is 64 u of each.
#ifndef VITRUM_TREE_H
#define VITRUM_TREE_H

#include "packet.h"
#include "tree_types.h"

#pragma OPENCL FP_CONTRACT OFF

// Rays as the tests want them.
typedef struct {
  Uint near_x, near_y, near_z;         // which plane of each axis a ray meets first, as an index into TreeNode::planes
  Vec3 inverse;
  Vec3 enter, leave;                   // t of a plane at p is p * inverse - enter, early, or p * inverse - leave, late,
                                       // by the padding of the origin
  Uint kx, ky, kz;                     // axes, as indices into TreeLeaf::corners; the direction is longest along kz
  Vec3 origin;                         // along kx, ky, kz
  Float shear_x, shear_y, inverse_kz;
} TreeRays;

FUNCTION Float tree_component(const Vec3 v, const Uint axis) {
  return axis == (Uint)(0) ? v.x : axis == (Uint)(1) ? v.y : v.z;
}

// Finite, so that no plane gives 0 * INFINITY; what that moves a ray by is far below the padding.
FUNCTION Float tree_inverse(const Float d) {
  return 1.0f / (fabs(d) < 1e-18f ? copysign((Float)(1e-18f), d) : d);
}

FUNCTION TreeRays tree_rays(const RayPacket* rays) {
  const Vec3 o = rays->origin, d = rays->direction;
  TreeRays r;
  r.inverse = make_vec3(tree_inverse(d.x), tree_inverse(d.y), tree_inverse(d.z));
  r.near_x = r.inverse.x < 0.0f ? (Uint)(1 * TREE_WIDTH) : (Uint)(0 * TREE_WIDTH);
  r.near_y = r.inverse.y < 0.0f ? (Uint)(3 * TREE_WIDTH) : (Uint)(2 * TREE_WIDTH);
  r.near_z = r.inverse.z < 0.0f ? (Uint)(5 * TREE_WIDTH) : (Uint)(4 * TREE_WIDTH);
  const Float padding = TREE_PADDING * largest3(o);
  r.enter.x = o.x * r.inverse.x + padding * fabs(r.inverse.x);
  r.enter.y = o.y * r.inverse.y + padding * fabs(r.inverse.y);
  r.enter.z = o.z * r.inverse.z + padding * fabs(r.inverse.z);
  r.leave.x = o.x * r.inverse.x - padding * fabs(r.inverse.x);
  r.leave.y = o.y * r.inverse.y - padding * fabs(r.inverse.y);
  r.leave.z = o.z * r.inverse.z - padding * fabs(r.inverse.z);

  const Vec3 size = make_vec3(fabs(d.x), fabs(d.y), fabs(d.z));
  const Uint zero = (Uint)(0), two = (Uint)(2);
  const Uint z = size.x > size.y ? (size.x > size.z ? zero : two) : (size.y > size.z ? (Uint)(1) : two);
  const Uint x = z == two ? zero : z + 1u;
  const Uint y = x == two ? zero : x + 1u;
  r.kx = x * TREE_LEAF_WIDTH;
  r.ky = y * TREE_LEAF_WIDTH;
  r.kz = z * TREE_LEAF_WIDTH;
  r.origin = make_vec3(tree_component(o, x), tree_component(o, y), tree_component(o, z));
  const Float dz = tree_component(d, z);
  r.shear_x = tree_component(d, x) / dz;
  r.shear_y = tree_component(d, y) / dz;
  r.inverse_kz = 1.0f / dz;
  return r;
}

// One bit a lane that is true (-1). VITRUM_PORTABLE leaves the processor's own instructions out.
#if defined(__AVX__) && !defined(VITRUM_PORTABLE)
static uint tree_mask8(const int8 lanes) { return (uint)__builtin_ia32_movmskps256(as_float8(lanes)); }
static uint tree_mask4(const int4 lanes) { return (uint)__builtin_ia32_movmskps(as_float4(lanes)); }
#else
static uint tree_mask4(const int4 lanes) {
  const int4 bits = lanes & (int4)(1, 2, 4, 8);
  const int2 pairs = bits.lo | bits.hi;
  return (uint)(pairs.x | pairs.y);
}
static uint tree_mask8(const int8 lanes) { return tree_mask4(lanes.lo) | tree_mask4(lanes.hi) << 4; }
#endif

// fmin and fmax of OpenCL are slow for what they do with NaN.
static float8 tree_min(const float8 a, const float8 b) { return select(b, a, a < b); }
static float8 tree_max(const float8 a, const float8 b) { return select(b, a, a > b); }

// a b - c d with the right sign, and 0 only where it is 0: within 2 u of it (Jeannerod, Louvet and Muller, Further
// analysis of Kahan's algorithm for the accurate computation of 2x2 determinants, Math. Comp. 2013).
static float4 tree_cross(const float4 a, const float4 b, const float4 c, const float4 d) {
  const float4 cd = c * d;
  return fma(a, b, -cd) + fma(-c, d, cd);
}

// Which triangles of a leaf the line of ray i meets, at which t, with the weights of corners b and c, and whether it
// meets their fronts; meaningless elsewhere.
static int4 tree_triangles(const TreeRays* r, const uint i, __global const TreeLeaf* leaf, float4* t, float4* u,
                           float4* v, int4* front) {
  __global const float* a = &leaf->corners[0][0][0];
  __global const float* b = &leaf->corners[1][0][0];
  __global const float* c = &leaf->corners[2][0][0];
  const uint kx = LANE(r->kx, uint, i), ky = LANE(r->ky, uint, i), kz = LANE(r->kz, uint, i);
  const float3 origin = LANE3(r->origin, i);
  const float inverse_kz = LANE(r->inverse_kz, float, i);
  const float4 shear_x = -LANE(r->shear_x, float, i), shear_y = -LANE(r->shear_y, float, i);
  const float4 az = vload4(0, a + kz) - origin.z;
  const float4 bz = vload4(0, b + kz) - origin.z;
  const float4 cz = vload4(0, c + kz) - origin.z;
  const float4 ax = fma(shear_x, az, vload4(0, a + kx) - origin.x);
  const float4 bx = fma(shear_x, bz, vload4(0, b + kx) - origin.x);
  const float4 cx = fma(shear_x, cz, vload4(0, c + kx) - origin.x);
  const float4 ay = fma(shear_y, az, vload4(0, a + ky) - origin.y);
  const float4 by = fma(shear_y, bz, vload4(0, b + ky) - origin.y);
  const float4 cy = fma(shear_y, cz, vload4(0, c + ky) - origin.y);
  const float4 weight_a = tree_cross(cx, by, cy, bx);
  const float4 weight_b = tree_cross(ax, cy, ay, cx);
  const float4 weight_c = tree_cross(bx, ay, by, ax);
  const float4 sum = weight_a + weight_b + weight_c;
  const int4 positive = (weight_a >= 0.0f) & (weight_b >= 0.0f) & (weight_c >= 0.0f);
  const int4 negative = (weight_a <= 0.0f) & (weight_b <= 0.0f) & (weight_c <= 0.0f);
  const int4 met = (positive | negative) & (sum != 0.0f);
  if (!tree_mask4(met)) {
    *t = *u = *v = 0.0f;
    *front = 0;
    return met;
  }
  // The sum is -dot(direction, cross(b - a, c - a)) / d_kz.
  *front = inverse_kz > 0.0f ? positive : negative;
  *u = weight_b / sum;
  *v = weight_c / sum;
  *t = inverse_kz * fma(weight_a / sum, az, fma(*u, bz, *v * cz));
  return met;
}

// WIDTH rays on their way through the tree.
typedef struct {
  TreeRays rays;
  Float t_first, t_last;                  // [m], t_first >= 0: what lies outside is passed over
  Uint child;                             // what a ray comes to next, or TREE_EMPTY
  Uint waiting;                           // children on its stack, the closest one on top
  float enter[WIDTH][TREE_STACK_SIZE];    // where the ray enters their boxes, at the earliest
  uint children[WIDTH][TREE_STACK_SIZE];
} TreeWalks;

FUNCTION void tree_start(TreeWalks* walks, const RayPacket* rays, const Float t_first, const Float t_last) {
  walks->rays = tree_rays(rays);
  walks->t_first = t_first;
  walks->t_last = t_last;
  walks->child = (Uint)(0);
  walks->waiting = (Uint)(0);
}

// The last t before t_max; no t is up to it if t_max <= 0.
FUNCTION Float tree_before_end(const Float t_max) { return AS_FLOAT(AS_UINT(t_max) - 1u); }

static __global const TreeLeaf* tree_leaf(__global const TreeLeaf* leaves, const uint child) {
  return leaves + (child & ~TREE_LEAF_BIT);
}

static void tree_fetch(__global const TreeNode* nodes, __global const TreeLeaf* leaves, const uint child) {
  const ulong place = child & TREE_LEAF_BIT ? (ulong)tree_leaf(leaves, child) : (ulong)(nodes + child);
  for (uint line = 0; line < sizeof(TreeNode); line += 64) PREFETCH(place + line);
}

// Ray i goes on to the closest child that waits, of those that it enters before t_last, `waiting` at most.
static void tree_pop(TreeWalks* walks, const uint i, uint waiting, __global const TreeNode* nodes,
                     __global const TreeLeaf* leaves) {
  const float t_last = LANE(walks->t_last, float, i);
  uint child = TREE_EMPTY;
  while (waiting) {
    --waiting;
    if (walks->enter[i][waiting] > t_last) continue;
    child = walks->children[i][waiting];
    tree_fetch(nodes, leaves, child);
    break;
  }
  SET_LANE(walks->child, uint, i, child);
  SET_LANE(walks->waiting, uint, i, waiting);
}

static uint8 tree_exchanged(const uint8 a, const uint8 b, const int8 greater) {
  return greater ? max(a, b) : min(a, b);
}

// In descending order: a network of Batcher's (1968), which guesses no branches.
static uint8 tree_sorted(uint8 a) {
  a = tree_exchanged(a, a.s10325476, (int8)(-1, 0, 0, -1, -1, 0, 0, -1));
  a = tree_exchanged(a, a.s23016745, (int8)(-1, -1, 0, 0, 0, 0, -1, -1));
  a = tree_exchanged(a, a.s10325476, (int8)(-1, 0, -1, 0, 0, -1, 0, -1));
  a = tree_exchanged(a, a.s45670123, (int8)(-1, -1, -1, -1, 0, 0, 0, 0));
  a = tree_exchanged(a, a.s23016745, (int8)(-1, -1, 0, 0, -1, -1, 0, 0));
  return tree_exchanged(a, a.s10325476, (int8)(-1, 0, -1, 0, -1, 0, -1, 0));
}

// values[lanes[i]] in each lane i.
static uint8 tree_chosen(const uint8 values, const uint8 lanes) {
#if defined(__AVX2__) && !defined(VITRUM_PORTABLE)
  return as_uint8(__builtin_ia32_permvarsi256(as_int8(values), as_int8(lanes)));
#else
  return shuffle(values, lanes);
#endif
}

// Ray i goes on from a node to the closest of its children whose boxes it meets; the others wait. On each level at most
// TREE_WIDTH - 1 do so, and writing all TREE_WIDTH above them stays within the stack.
static void tree_descend(TreeWalks* walks, const uint i, __global const TreeNode* nodes,
                         __global const TreeLeaf* leaves) {
  __global const TreeNode* node = nodes + LANE(walks->child, uint, i);
  __global const float* planes = &node->planes[0][0][0];
  const TreeRays* r = &walks->rays;
  const uint near_x = LANE(r->near_x, uint, i), near_y = LANE(r->near_y, uint, i), near_z = LANE(r->near_z, uint, i);
  const float3 inverse = LANE3(r->inverse, i), early = LANE3(r->enter, i), late = LANE3(r->leave, i);
  const float8 x0 = fma(vload8(0, planes + near_x), (float8)(inverse.x), (float8)(-early.x));
  const float8 y0 = fma(vload8(0, planes + near_y), (float8)(inverse.y), (float8)(-early.y));
  const float8 z0 = fma(vload8(0, planes + near_z), (float8)(inverse.z), (float8)(-early.z));
  const float8 x1 = fma(vload8(0, planes + (near_x ^ TREE_WIDTH)), (float8)(inverse.x), (float8)(-late.x));
  const float8 y1 = fma(vload8(0, planes + (near_y ^ TREE_WIDTH)), (float8)(inverse.y), (float8)(-late.y));
  const float8 z1 = fma(vload8(0, planes + (near_z ^ TREE_WIDTH)), (float8)(inverse.z), (float8)(-late.z));
  const float8 enter = tree_max(tree_max((float8)(LANE(walks->t_first, float, i)), x0), tree_max(y0, z0));
  const float8 leave = tree_min(tree_min((float8)(LANE(walks->t_last, float, i)), x1), tree_min(y1, z1));
  const int8 met = enter <= leave;
  // t >= 0 orders as its bits do. The last three make room for the child, which puts t down.
  const uint8 children = (uint8)(0, 1, 2, 3, 4, 5, 6, 7);
  const uint8 keys = tree_sorted(met ? (as_uint8(enter) & 0x7ffffff8u) | children : (uint8)(0));
  const uint waiting = LANE(walks->waiting, uint, i);
  vstore8(as_float8(keys & 0x7ffffff8u), 0, &walks->enter[i][waiting]);
  vstore8(tree_chosen(vload8(0, node->child), keys & 7u), 0, &walks->children[i][waiting]);
  tree_pop(walks, i, waiting + popcount(tree_mask8(met)), nodes, leaves);
}

// The triangles of a leaf that ray i meets in (t_first, t_last], as bits.
static uint tree_leaf_hits(const TreeWalks* walks, const uint i, __global const TreeLeaf* leaf, float4* t, float4* u,
                           float4* v, int4* front) {
  const int4 met = tree_triangles(&walks->rays, i, leaf, t, u, v, front);
  return tree_mask4(met & (*t > LANE(walks->t_first, float, i)) & (*t <= LANE(walks->t_last, float, i)));
}

static bool tree_before(const Hit* a, const Hit* b) {
  return a->t < b->t ||
         (a->t == b->t && (a->shape < b->shape || (a->shape == b->shape && a->primitive < b->primitive)));
}

static float3 tree_corner(__global const TreeLeaf* leaf, const uint corner, const uint lane) {
  return (float3)(leaf->corners[corner][0][lane], leaf->corners[corner][1][lane], leaf->corners[corner][2][lane]);
}

static float tree_sum(const float3 v) { return fabs(v.x) + fabs(v.y) + fabs(v.z); }

// Is `p` within `error` [m] of the triangle's plane? The second term is what roundings do to the normal of a needle:
// differences of corners, products and sums take 8 u of the lengths.
static bool tree_near_plane(const float3 p, const float3 a, const float3 b, const float3 c, const float error) {
  const float3 ab = b - a, ac = c - a, ap = p - a, normal = cross(ab, ac);
  const float height = fabs(dot(normal, ap));
  // Mostly it is far off, which sums of components tell sooner than lengths.
  if (height > error * tree_sum(normal) + 0x1p-21f * tree_sum(ab) * tree_sum(ac) * tree_sum(ap)) return false;
  return height <= error * length(normal) + 0x1p-21f * length(ab) * length(ac) * length(ap);
}

// Does the triangle belong to the surface that ray i leaves, so that it is not met? The one that it leaves does. Of the
// same body, those do which it starts from within rounding and would see from the wrong side: a ray that has gone
// inside does not enter again through the next facet. Of others, where shapes touch, all that it starts from: they have
// been crossed together with the one it leaves (contacts.h).
static bool tree_left_behind(const MeshRays* rays, const uint i, __global const TreeLeaf* leaf, const uint lane,
                             const uint front) {
  if (leaf->shape[lane] == LANE(rays->shape, uint, i)) {
    if (leaf->primitive[lane] == LANE(rays->primitive, uint, i)) return true;
    if (front == LANE(rays->front, uint, i)) return false;
  } else {
#if HAS_CONTACTS
    if (LANE(rays->error, float, i) == 0.0f) return false;
#else
    return false;
#endif
  }
  return tree_near_plane(LANE3(rays->rays.origin, i), tree_corner(leaf, 0, lane), tree_corner(leaf, 1, lane),
                         tree_corner(leaf, 2, lane), LANE(rays->error, float, i));
}

static Hit tree_hit(__global const TreeLeaf* leaf, const uint lane, const float4 t, const float4 u, const float4 v,
                    const uint fronts) {
  float lanes[3][TREE_LEAF_WIDTH];
  vstore4(t, 0, lanes[0]);
  vstore4(u, 0, lanes[1]);
  vstore4(v, 0, lanes[2]);
  Hit hit;
  hit.t = lanes[0][lane];
  hit.shape = leaf->shape[lane];
  hit.primitive = leaf->primitive[lane];
  hit.u = lanes[1][lane];
  hit.v = lanes[2][lane];
  hit.front = fronts >> lane & 1u;
  return hit;
}

// Which rays have come to a node, and which to a leaf, as bits; neither: to the end.
typedef struct {
  uint at_node, at_leaf;
} TreePlaces;

static void tree_sort_in(TreePlaces* places, const uint i, const uint child) {
  const uint leaf = child >> 31;
  places->at_node |= (leaf ^ 1) << i;
  places->at_leaf |= (leaf & (uint)(child != TREE_EMPTY)) << i;
}

// One step for each ray that is at a node. Node by node and leaf by leaf, so that a processor guesses what comes next.
static void tree_descend_each(TreePlaces* places, TreeWalks* walks, __global const TreeNode* nodes,
                              __global const TreeLeaf* leaves) {
  uint bits = places->at_node;
  for (places->at_node = 0; bits; bits &= bits - 1) {
    const uint i = lowest_bit(bits);
    tree_descend(walks, i, nodes, leaves);
    tree_sort_in(places, i, LANE(walks->child, uint, i));
  }
}

// The rays whose bits in `which` are set look for triangles in (t_min, t_last]: for one, if `any`, or for the first, which
// replaces its lane of *hits if that comes later. The bits of those that found one.
FUNCTION uint tree_search(const MeshRays* rays, const uint which, __global const TreeNode* nodes,
                          __global const TreeLeaf* leaves, const Float t_last, const int any, HitPacket* hits) {
  TreeWalks walks;
  tree_start(&walks, &rays->rays, rays->rays.t_min, t_last);
  uint found = 0;
  TreePlaces places = {which, 0};
  while (places.at_node | places.at_leaf) {
    tree_descend_each(&places, &walks, nodes, leaves);
    uint bits = places.at_leaf;
    for (places.at_leaf = 0; bits; bits &= bits - 1) {
      const uint i = lowest_bit(bits);
      __global const TreeLeaf* leaf = tree_leaf(leaves, LANE(walks.child, uint, i));
      float4 t, u, v;
      int4 front;
      uint waiting = LANE(walks.waiting, uint, i);
      for (uint mask = tree_leaf_hits(&walks, i, leaf, &t, &u, &v, &front); mask; mask &= mask - 1) {
        const uint lane = lowest_bit(mask);
        const Hit candidate = tree_hit(leaf, lane, t, u, v, tree_mask4(front));
        if (!any) {
          const Hit best = hit_of(hits, i);
          if (!tree_before(&candidate, &best)) continue;
        }
        if (tree_left_behind(rays, i, leaf, lane, candidate.front)) continue;
        found |= 1u << i;
        if (any) {
          waiting = 0;
          break;
        }
        set_hit(hits, i, candidate);
        SET_LANE(walks.t_last, float, i, candidate.t);
      }
      tree_pop(&walks, i, waiting, nodes, leaves);
      tree_sort_in(&places, i, LANE(walks.child, uint, i));
    }
  }
  return found;
}

// Replaces hits by the first triangle in (t_min, t_max) if that comes before them, for each lane whose bit in `which`
// is set. The bits of those that it replaced.
static uint tree_closest(const MeshRays* rays, const uint which, __global const TreeNode* nodes,
                         __global const TreeLeaf* leaves, HitPacket* hits) {
  const Float end = rays->rays.t_max;
  return tree_search(rays, which, nodes, leaves, hits->t < end ? hits->t : tree_before_end(end), 0, hits);
}

// Is there a triangle in (t_min, t_max)? For each lane whose bit in `which` is set, as bits.
static uint tree_any(const MeshRays* rays, const uint which, __global const TreeNode* nodes,
                     __global const TreeLeaf* leaves) {
  return tree_search(rays, which, nodes, leaves, tree_before_end(rays->rays.t_max), 1, 0);
}

#define TREE_MAX_BORDERS 4

// The first TREE_MAX_BORDERS borders at t_first <= t <= t_last, t_first >= 0, of triangles whose planes are within
// `error` [m] of `place`, in order, for one of the rays; returns how many there are in `hits`. The triangles of a shape
// that are met from one side are one border, since at an edge or a corner a ray meets several: the first of them
// counts. For surfaces in contact; the rays' own t_min and t_max and what they leave do not matter.
static uint tree_borders_within(const RayPacket* rays, const uint i, __global const TreeNode* nodes,
                                __global const TreeLeaf* leaves, const float t_first, const float t_last,
                                const float3 place, const float error, Hit hits[TREE_MAX_BORDERS]) {
  TreeWalks walks;
  tree_start(&walks, rays, t_first, t_last);
  uint count = 0;
  for (uint child; (child = LANE(walks.child, uint, i)) != TREE_EMPTY;) {
    if (!(child & TREE_LEAF_BIT)) {
      tree_descend(&walks, i, nodes, leaves);
      continue;
    }
    __global const TreeLeaf* leaf = tree_leaf(leaves, child);
    float4 t, u, v;
    int4 front;
    const int4 met = tree_triangles(&walks.rays, i, leaf, &t, &u, &v, &front);
    for (uint mask = tree_mask4(met & (t >= t_first) & (t <= LANE(walks.t_last, float, i))); mask; mask &= mask - 1) {
      const uint lane = lowest_bit(mask);
      const float3 a = tree_corner(leaf, 0, lane), b = tree_corner(leaf, 1, lane), c = tree_corner(leaf, 2, lane);
      if (!tree_near_plane(place, a, b, c, error)) continue;
      const Hit candidate = tree_hit(leaf, lane, t, u, v, tree_mask4(front));
      // It may replace a later one of its border, or else the last of all.
      uint slot = 0;
      while (slot < count && (hits[slot].shape != candidate.shape || hits[slot].front != candidate.front)) ++slot;
      if (slot == TREE_MAX_BORDERS) --slot;
      if (slot < count && !tree_before(&candidate, &hits[slot])) continue;
      count += slot == count;
      for (; slot > 0 && tree_before(&candidate, &hits[slot - 1]); --slot) hits[slot] = hits[slot - 1];
      hits[slot] = candidate;
    }
    if (count == TREE_MAX_BORDERS) SET_LANE(walks.t_last, float, i, hits[TREE_MAX_BORDERS - 1].t);
    tree_pop(&walks, i, LANE(walks.waiting, uint, i), nodes, leaves);
  }
  return count;
}

#endif
