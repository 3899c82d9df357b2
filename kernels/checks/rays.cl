// kernels/tree.h by itself, for `vitrum bench`. Reads the tree and `rays`, eight floats each: origin, t_min, direction,
// t_max. WIDTH rays a work-item.
#include "tree.h"

static MeshRays rays_of(__global const float* rays, const uint first, const uint end) {
  MeshRays taken;
  for (uint i = first; i < end; ++i) {
    const uint lane = i - first;
    set_lane3(&taken.rays.origin, lane, vload3(0, rays + 8 * i));
    SET_LANE(taken.rays.t_min, float, lane, rays[8 * i + 3]);
    set_lane3(&taken.rays.direction, lane, vload3(0, rays + 8 * i + 4));
    SET_LANE(taken.rays.t_max, float, lane, rays[8 * i + 7]);
  }
  taken.shape = taken.primitive = (Uint)(TREE_EMPTY);
  taken.front = (Uint)(0);
  taken.error = 0.0f;
  return taken;
}

// Where each ray meets the first triangle, INFINITY: nowhere; and which that is.
KERNEL void closest(const uint count, __global const TreeNode* nodes, __global const TreeLeaf* leaves,
                    __global const float* rays, __global float* t, __global uint* primitive) {
  const uint first = get_global_id(0) * WIDTH;
  const uint end = min(count, first + WIDTH);
  if (first >= end) return;
  const MeshRays taken = rays_of(rays, first, end);
  HitPacket hits;
  hits.t = INFINITY;
  hits.shape = hits.primitive = (Uint)(TREE_EMPTY);
  hits.u = hits.v = 0.0f;
  hits.front = (Uint)(0);
  tree_closest(&taken, lane_bits(lanes_below(first, end)), nodes, leaves, &hits);
  for (uint i = first; i < end; ++i) {
    t[i] = LANE(hits.t, float, i - first);
    primitive[i] = LANE(hits.primitive, uint, i - first);
  }
}

// 1 for each ray that meets a triangle.
KERNEL void occluded(const uint count, __global const TreeNode* nodes, __global const TreeLeaf* leaves,
                     __global const float* rays, __global uint* met) {
  const uint first = get_global_id(0) * WIDTH;
  const uint end = min(count, first + WIDTH);
  if (first >= end) return;
  const MeshRays taken = rays_of(rays, first, end);
  const uint any = tree_any(&taken, lane_bits(lanes_below(first, end)), nodes, leaves);
  for (uint i = first; i < end; ++i) met[i] = any >> (i - first) & 1u;
}
