// kernels/tree.h by itself, for `vitrum bench`. Reads the tree and `rays`, eight floats each: origin, t_min, direction,
// t_max.
#include "tree.h"

static Ray ray_of(__global const float* rays, const uint i) {
  return free_ray(vload3(0, rays + 8 * i), vload3(0, rays + 8 * i + 4), rays[8 * i + 3], rays[8 * i + 7]);
}

// Where each ray meets the first triangle, INFINITY: nowhere; and which that is.
__kernel void closest(const uint count, __global const TreeNode* nodes, __global const TreeLeaf* leaves,
                      __global const float* rays, __global float* t, __global uint* primitive) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  const Ray ray = ray_of(rays, i);
  Hit hit;
  hit.t = INFINITY;
  hit.shape = hit.primitive = TREE_EMPTY;
  hit.u = hit.v = 0.0f;
  tree_closest(&ray, nodes, leaves, &hit);
  t[i] = hit.t;
  primitive[i] = hit.primitive;
}

// 1 for each ray that meets a triangle.
__kernel void occluded(const uint count, __global const TreeNode* nodes, __global const TreeLeaf* leaves,
                       __global const float* rays, __global uint* met) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  const Ray ray = ray_of(rays, i);
  met[i] = tree_any(&ray, nodes, leaves);
}
