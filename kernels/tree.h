// Traversal of the tree over triangles: SIMD inside the ray, 8 boxes or 4 triangles at a time.
//
// What a ray hits is decided by the triangle test alone: it is watertight (Woop, Benthin and Wald, Watertight
// Ray/Triangle Intersection, JCGT 2013), two-sided, and edges and corners belong to the triangle. The boxes are only there
// to be fast. Their padding covers every rounding of both tests, so the result does not hang on the tree:
// with u = 2^-24 and m = the largest coordinate of a box's corners as seen from the ray's origin, the sheared corners of
// a triangle are off by 9 u m, its t by 21 u m / |d_z|, the planes' t by 8 u m / |d| (division 2.5 ulp, as OpenCL grants);
// m is at most the sum of the largest coordinates of box and origin, and TREE_PADDING is 64 u of each.
#ifndef VITRUM_TREE_H
#define VITRUM_TREE_H

#include "ray.h"
#include "tree_types.h"

#pragma OPENCL FP_CONTRACT OFF

// The ray as the tests want it.
typedef struct {
  uint near_x, near_y, near_z;       // which plane of each axis the ray meets first, as an index into TreeNode::planes
  float inverse_x, inverse_y, inverse_z;
  float enter_x, enter_y, enter_z;   // t of a plane at p is p * inverse - enter, early,
  float leave_x, leave_y, leave_z;   // or p * inverse - leave, late by the padding of the origin
  uint kx, ky, kz;                   // axes; the direction is longest along kz
  float origin_x, origin_y, origin_z;  // along kx, ky, kz
  float shear_x, shear_y, inverse_kz;
} TreeRay;

static float tree_component(const float3 v, const uint axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

// Finite, so that no plane gives 0 * INFINITY; what that moves a ray by is far below the padding.
static float tree_inverse(const float d) { return 1.0f / (fabs(d) < 1e-18f ? copysign(1e-18f, d) : d); }

static TreeRay tree_ray(const Ray* ray) {
  const float3 o = ray->origin, d = ray->direction, size = fabs(d);
  TreeRay r;
  r.inverse_x = tree_inverse(d.x);
  r.inverse_y = tree_inverse(d.y);
  r.inverse_z = tree_inverse(d.z);
  r.near_x = r.inverse_x < 0.0f ? 1 : 0;
  r.near_y = r.inverse_y < 0.0f ? 3 : 2;
  r.near_z = r.inverse_z < 0.0f ? 5 : 4;
  const float padding = TREE_PADDING * fmax(fabs(o.x), fmax(fabs(o.y), fabs(o.z)));
  r.enter_x = o.x * r.inverse_x + padding * fabs(r.inverse_x);
  r.enter_y = o.y * r.inverse_y + padding * fabs(r.inverse_y);
  r.enter_z = o.z * r.inverse_z + padding * fabs(r.inverse_z);
  r.leave_x = o.x * r.inverse_x - padding * fabs(r.inverse_x);
  r.leave_y = o.y * r.inverse_y - padding * fabs(r.inverse_y);
  r.leave_z = o.z * r.inverse_z - padding * fabs(r.inverse_z);

  r.kz = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
  r.kx = r.kz == 2 ? 0 : r.kz + 1;
  r.ky = r.kx == 2 ? 0 : r.kx + 1;
  r.origin_x = tree_component(o, r.kx);
  r.origin_y = tree_component(o, r.ky);
  r.origin_z = tree_component(o, r.kz);
  const float dz = tree_component(d, r.kz);
  r.shear_x = tree_component(d, r.kx) / dz;
  r.shear_y = tree_component(d, r.ky) / dz;
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

// Index of the lowest bit of a mask that is not 0.
static uint tree_lowest(const uint mask) { return 31u - clz(mask & (0u - mask)); }

// fmin and fmax of OpenCL are slow for what they do with NaN.
static float8 tree_min(const float8 a, const float8 b) { return select(b, a, a < b); }
static float8 tree_max(const float8 a, const float8 b) { return select(b, a, a > b); }

// Which children's boxes the ray meets within [t_first, t_last], and where it enters them.
static uint tree_boxes(const TreeRay* r, __global const TreeNode* node, const float t_first, const float t_last,
                       float8* enter) {
  __global const float* planes = &node->planes[0][0][0];
  const float8 x0 = fma(vload8(r->near_x, planes), (float8)(r->inverse_x), (float8)(-r->enter_x));
  const float8 y0 = fma(vload8(r->near_y, planes), (float8)(r->inverse_y), (float8)(-r->enter_y));
  const float8 z0 = fma(vload8(r->near_z, planes), (float8)(r->inverse_z), (float8)(-r->enter_z));
  const float8 x1 = fma(vload8(r->near_x ^ 1, planes), (float8)(r->inverse_x), (float8)(-r->leave_x));
  const float8 y1 = fma(vload8(r->near_y ^ 1, planes), (float8)(r->inverse_y), (float8)(-r->leave_y));
  const float8 z1 = fma(vload8(r->near_z ^ 1, planes), (float8)(r->inverse_z), (float8)(-r->leave_z));
  *enter = tree_max(tree_max((float8)(t_first), x0), tree_max(y0, z0));
  const float8 leave = tree_min(tree_min((float8)(t_last), x1), tree_min(y1, z1));
  return tree_mask8(*enter <= leave);
}

// a b - c d with the right sign, and 0 only where it is 0: within 2 u of it (Jeannerod, Louvet and Muller, Further
// analysis of Kahan's algorithm for the accurate computation of 2x2 determinants, Math. Comp. 2013).
static float4 tree_cross(const float4 a, const float4 b, const float4 c, const float4 d) {
  const float4 cd = c * d;
  return fma(a, b, -cd) + fma(-c, d, cd);
}

// Which triangles of a leaf the ray's line meets, at which t, with the weights of corners b and c, and whether it meets
// their fronts; meaningless elsewhere.
static int4 tree_triangles(const TreeRay* r, __global const TreeLeaf* leaf, float4* t, float4* u, float4* v,
                           int4* front) {
  __global const float* corners = &leaf->corners[0][0][0];
  const float4 az = vload4(r->kz, corners) - r->origin_z;
  const float4 bz = vload4(r->kz + 3, corners) - r->origin_z;
  const float4 cz = vload4(r->kz + 6, corners) - r->origin_z;
  const float4 shear_x = -r->shear_x, shear_y = -r->shear_y;
  const float4 ax = fma(shear_x, az, vload4(r->kx, corners) - r->origin_x);
  const float4 bx = fma(shear_x, bz, vload4(r->kx + 3, corners) - r->origin_x);
  const float4 cx = fma(shear_x, cz, vload4(r->kx + 6, corners) - r->origin_x);
  const float4 ay = fma(shear_y, az, vload4(r->ky, corners) - r->origin_y);
  const float4 by = fma(shear_y, bz, vload4(r->ky + 3, corners) - r->origin_y);
  const float4 cy = fma(shear_y, cz, vload4(r->ky + 6, corners) - r->origin_y);
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
  *front = r->inverse_kz > 0.0f ? positive : negative;
  *u = weight_b / sum;
  *v = weight_c / sum;
  *t = r->inverse_kz * fma(weight_a / sum, az, fma(*u, bz, *v * cz));
  return met;
}

// A child on the stack, with where the ray enters it: t >= 0 orders as its bits do.
static ulong tree_entry(const float enter, const uint child) { return (ulong)as_uint(enter) << 32 | child; }
static float tree_enter(const ulong entry) { return as_float((uint)(entry >> 32)); }

// Puts the children in `mask` on the stack, the closest one on top.
static uint tree_push(ulong* stack, const uint base, uint mask, const float8 enter, __global const TreeNode* node) {
  float t[TREE_WIDTH];
  vstore8(enter, 0, t);
  uint top = base;
  for (; mask; mask &= mask - 1) {
    const uint i = tree_lowest(mask);
    const ulong entry = tree_entry(t[i], node->child[i]);
    uint place = top++;
    for (; place > base && stack[place - 1] < entry; --place) stack[place] = stack[place - 1];
    stack[place] = entry;
  }
  return top;
}

// The next leaf that the ray may meet within [t_first, t_last], closest boxes first, or TREE_EMPTY. The stack holds the
// children that wait, *top of them; a traversal starts with the root there.
static uint tree_next_leaf(const TreeRay* r, __global const TreeNode* nodes, const float t_first, const float t_last,
                           ulong* stack, uint* top) {
  while (*top) {
    const ulong entry = stack[--*top];
    if (tree_enter(entry) > t_last) continue;
    uint child = (uint)entry;
    while (!(child & TREE_LEAF_BIT)) {
      __global const TreeNode* node = nodes + child;
      float8 enter;
      const uint mask = tree_boxes(r, node, t_first, t_last, &enter);
      if (!mask) {
        child = TREE_EMPTY;
      } else if (!(mask & (mask - 1))) {
        child = node->child[tree_lowest(mask)];
      } else {
        *top = tree_push(stack, *top, mask, enter, node);
        child = (uint)stack[--*top];
      }
    }
    if (child != TREE_EMPTY) return child & ~TREE_LEAF_BIT;
  }
  return TREE_EMPTY;
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

// Does the triangle belong to the surface that the ray leaves, so that it is not met? The one that it leaves does. Of the
// same body, those do which it starts from within rounding and would see from the wrong side: a ray that has gone inside
// does not enter again through the next facet. Of others, where shapes touch, all that it starts from: they have been
// crossed together with the one it leaves (contacts.h).
static bool tree_left_behind(const Ray* ray, __global const TreeLeaf* leaf, const uint lane, const uint front) {
  if (leaf->shape[lane] == ray->shape) {
    if (leaf->primitive[lane] == ray->primitive) return true;
    if (front == ray->front) return false;
  } else {
#if HAS_CONTACTS
    if (ray->error == 0.0f) return false;
#else
    return false;
#endif
  }
  return tree_near_plane(ray->origin, tree_corner(leaf, 0, lane), tree_corner(leaf, 1, lane), tree_corner(leaf, 2, lane),
                         ray->error);
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

// Replaces *hit by the first triangle in (t_min, t_max) if that comes before it. True if it does.
static bool tree_closest(const Ray* ray, __global const TreeNode* nodes, __global const TreeLeaf* leaves, Hit* hit) {
  const TreeRay r = tree_ray(ray);
  Hit best = *hit;
  if (!(best.t < ray->t_max)) {
    best.t = ray->t_max;
    best.shape = best.primitive = 0;  // nothing at t_max comes before this
  }
  bool found = false;
  ulong stack[TREE_STACK_SIZE];
  stack[0] = tree_entry(0.0f, 0);
  uint top = 1, next;
  while ((next = tree_next_leaf(&r, nodes, ray->t_min, best.t, stack, &top)) != TREE_EMPTY) {
    __global const TreeLeaf* leaf = leaves + next;
    float4 t, u, v;
    int4 front;
    const int4 met = tree_triangles(&r, leaf, &t, &u, &v, &front);
    for (uint mask = tree_mask4(met & (t > ray->t_min) & (t <= best.t)); mask; mask &= mask - 1) {
      const uint lane = tree_lowest(mask);
      const Hit candidate = tree_hit(leaf, lane, t, u, v, tree_mask4(front));
      if (!tree_before(&candidate, &best) || tree_left_behind(ray, leaf, lane, candidate.front)) continue;
      best = candidate;
      found = true;
    }
  }
  if (found) *hit = best;
  return found;
}

// Is there a triangle in (t_min, t_max)?
static bool tree_any(const Ray* ray, __global const TreeNode* nodes, __global const TreeLeaf* leaves) {
  const TreeRay r = tree_ray(ray);
  ulong stack[TREE_STACK_SIZE];
  stack[0] = tree_entry(0.0f, 0);
  uint top = 1, next;
  while ((next = tree_next_leaf(&r, nodes, ray->t_min, ray->t_max, stack, &top)) != TREE_EMPTY) {
    float4 t, u, v;
    int4 front;
    const int4 met = tree_triangles(&r, leaves + next, &t, &u, &v, &front);
    for (uint mask = tree_mask4(met & (t > ray->t_min) & (t < ray->t_max)); mask; mask &= mask - 1) {
      const uint lane = tree_lowest(mask);
      if (!tree_left_behind(ray, leaves + next, lane, tree_mask4(front) >> lane & 1u)) return true;
    }
  }
  return false;
}

#define TREE_MAX_BORDERS 4

// The first TREE_MAX_BORDERS borders at t_first <= t <= t_last, t_first >= 0, of triangles whose planes are within
// `error` [m] of `place`, in order; returns how many there are in `hits`. The triangles of a shape that are met from one
// side are one border, since at an edge or a corner a ray meets several: the first of them counts. For surfaces in
// contact; the ray's own t_min and t_max and what it leaves do not matter.
static uint tree_borders_within(const Ray* ray, __global const TreeNode* nodes, __global const TreeLeaf* leaves,
                                const float t_first, const float t_last, const float3 place, const float error,
                                Hit hits[TREE_MAX_BORDERS]) {
  const TreeRay r = tree_ray(ray);
  uint count = 0;
  float t_end = t_last;
  ulong stack[TREE_STACK_SIZE];
  stack[0] = tree_entry(0.0f, 0);
  uint top = 1, next;
  while ((next = tree_next_leaf(&r, nodes, t_first, t_end, stack, &top)) != TREE_EMPTY) {
    __global const TreeLeaf* leaf = leaves + next;
    float4 t, u, v;
    int4 front;
    const int4 met = tree_triangles(&r, leaf, &t, &u, &v, &front);
    for (uint mask = tree_mask4(met & (t >= t_first) & (t <= t_end)); mask; mask &= mask - 1) {
      const uint lane = tree_lowest(mask);
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
    if (count == TREE_MAX_BORDERS) t_end = hits[TREE_MAX_BORDERS - 1].t;
  }
  return count;
}

#endif
