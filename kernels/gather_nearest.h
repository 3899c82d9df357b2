// The k photons nearest to a place. Included by gather.h. Eight photons or eight children of a node at a time.
//
// Near is what the fixed radius takes in first as it grows: a photon's distance, or 1 / PLANE_SHARE times its distance
// off the plane where that is more; photons that came to the back are infinitely far. Boxes are tested by the same
// sums in the same order as photons, and rounding keeps order, so that no photon is ever missed for a rounding error.
#ifndef VITRUM_GATHER_NEAREST_H
#define VITRUM_GATHER_NEAREST_H

typedef struct {
  uint count;
  uint nearest;                // k
  float max_radius;            // [m]
  PhotonTreeData tree;
  __global const float* nodes;
  __global const float* leaves;
} PhotonMap;

#define PHOTON_MAP_PARAMETERS                                                                                        \
  , const uint n_photons, const uint nearest, const float max_radius, const PhotonTreeData photon_tree,              \
      __global const float *photon_nodes, __global const float *photon_leaves
#define PHOTON_MAP { n_photons, nearest, max_radius, photon_tree, photon_nodes, photon_leaves }

FUNCTION Mask within_reach(const PhotonMap* map, const Vec3 p) { return (Mask)-1; }

#define MAX_CANDIDATES 128           // a multiple of 8, at least enough_candidates(MAX_NEAREST) + 7
#define STACK_SIZE (7 * PHOTON_TREE_LEVELS + 1)
#define ENTRY_SHIFT 28

// Candidates are cut down to the k nearest when there are so many.
FUNCTION uint enough_candidates(uint k) { return k + k / 2 + 8; }

FUNCTION float8 larger8(float8 a, float8 b) { return a > b ? a : b; }

// The square of how near the photons of a leaf are [m2].
FUNCTION float8 photon_distances(__global const float* leaf, float3 p, float3 n) {
  const float8 dx = vload8(PHOTON_X, leaf) - p.x;
  const float8 dy = vload8(PHOTON_Y, leaf) - p.y;
  const float8 dz = vload8(PHOTON_Z, leaf) - p.z;
  const float8 d2 = fma(dx, dx, fma(dy, dy, dz * dz));
  const float8 off_plane = distance_off_plane(dx, dy, dz, n) * (1.0f / PLANE_SHARE);
  const float8 nearness = larger8(d2, off_plane * off_plane);
  return came_to_front(as_int8(vload8(PHOTON_DIRECTION, leaf)), n) ? nearness : INFINITY;
}

// A lower bound of it for the photons of each child of a node.
FUNCTION float8 child_distances(__global const float* node, float3 p, float3 n) {
  const float8 low_x = vload8(PHOTON_NODE_LOW + 0, node) - p.x, high_x = vload8(PHOTON_NODE_HIGH + 0, node) - p.x;
  const float8 low_y = vload8(PHOTON_NODE_LOW + 1, node) - p.y, high_y = vload8(PHOTON_NODE_HIGH + 1, node) - p.y;
  const float8 low_z = vload8(PHOTON_NODE_LOW + 2, node) - p.z, high_z = vload8(PHOTON_NODE_HIGH + 2, node) - p.z;
  const float8 dx = larger8(larger8(low_x, -high_x), 0.0f);
  const float8 dy = larger8(larger8(low_y, -high_y), 0.0f);
  const float8 dz = larger8(larger8(low_z, -high_z), 0.0f);
  const float8 d2 = fma(dx, dx, fma(dy, dy, dz * dz));
  // The corners of the box that are farthest behind and before the plane.
  const float8 behind = (n.x > 0.0f ? low_x : high_x) * n.x + (n.y > 0.0f ? low_y : high_y) * n.y +
                        (n.z > 0.0f ? low_z : high_z) * n.z;
  const float8 before = (n.x > 0.0f ? high_x : low_x) * n.x + (n.y > 0.0f ? high_y : low_y) * n.y +
                        (n.z > 0.0f ? high_z : low_z) * n.z;
  const float8 off_plane = larger8(larger8(behind, -before), 0.0f) * (1.0f / PLANE_SHARE);
  // The direction that comes to the front most directly.
  const int row_x = n.x > 0.0f ? PHOTON_NODE_LOW_DIRECTION : PHOTON_NODE_HIGH_DIRECTION;
  const int row_y = n.y > 0.0f ? PHOTON_NODE_LOW_DIRECTION : PHOTON_NODE_HIGH_DIRECTION;
  const int row_z = n.z > 0.0f ? PHOTON_NODE_LOW_DIRECTION : PHOTON_NODE_HIGH_DIRECTION;
  const float8 along = vload8(row_x + 0, node) * n.x + vload8(row_y + 1, node) * n.y + vload8(row_z + 2, node) * n.z;
  return along < 0.0f ? larger8(d2, off_plane * off_plane) : INFINITY;
}

FUNCTION __global const float* leaf_of(__global const float* leaves, uint entry) {
  return leaves + (ulong)entry * (PHOTON_FIELDS * 8);
}

FUNCTION __global const float* node_of(const PhotonTreeData* tree, __global const float* nodes, uint entry) {
  const uint i = tree->first_node[entry >> ENTRY_SHIFT] + (entry & ((1u << ENTRY_SHIFT) - 1u));
  return nodes + (ulong)i * (PHOTON_NODE_ROWS * 8);
}

// Lane 0 of the children of an entry of the stack, a level and a number in it.
FUNCTION uint first_child(uint entry) {
  return ((entry >> ENTRY_SHIFT) - 1u) << ENTRY_SHIFT | (entry & ((1u << ENTRY_SHIFT) - 1u)) << 3;
}

// Leaves the k nearest of the `count` candidates (k or more, all below `limit`), in no order; returns a new limit.
// Non-negative floats are in the order of their bits, so at most 31 steps find the k-th.
FUNCTION float keep_nearest(float* candidates, uint count, uint k, float limit) {
  for (uint i = count; i & 7u; ++i) candidates[i] = INFINITY;
  uint low = 0, high = as_uint(limit);
  while (low < high) {
    const uint middle = low + (high - low) / 2;
    int8 within = 0;
    for (uint i = 0; i < count; i += 8) within -= vload8(0, candidates + i) <= as_float(middle);
    const int4 half_sum = within.lo + within.hi;
    const uint n = (uint)(half_sum.s0 + half_sum.s1 + half_sum.s2 + half_sum.s3);
    if (n >= k) high = middle;
    else low = middle + 1;
    if (n == k) break;
  }
  // Where several are equally far, only so many of them as make up k.
  uint kept = 0;
  for (uint i = 0; i < count; ++i) {
    const float candidate = candidates[i];
    candidates[kept] = candidate;
    kept += candidate < as_float(high);
  }
  for (; kept < k; ++kept) candidates[kept] = as_float(high);
  return as_float(high);
}

// [nearest]
// The square of the radius within which the k nearest photons lie, at most `limit` [m2].
FUNCTION float nearest_radius2(const PhotonTreeData* tree, __global const float* nodes, __global const float* leaves,
                               float3 p, float3 n, uint k, float limit) {
  float candidates[MAX_CANDIDATES];
  uint count = 0;
  float bounds[STACK_SIZE];
  uint stack[STACK_SIZE];
  uint waiting = 1;
  stack[0] = tree->top << ENTRY_SHIFT;
  bounds[0] = 0.0f;
  while (waiting > 0) {
    --waiting;
    if (bounds[waiting] >= limit) continue;
    const uint entry = stack[waiting];
    float distances[8];
    if (entry >> ENTRY_SHIFT == 0) {
      const float8 d = photon_distances(leaf_of(leaves, entry), p, n);
      if (!any(d < limit)) continue;
      vstore8(d, 0, distances);
      for (uint lane = 0; lane < 8; ++lane) {
        candidates[count] = distances[lane];
        count += distances[lane] < limit;
      }
      if (count >= enough_candidates(k)) {
        limit = keep_nearest(candidates, count, k, limit);
        count = k;
      }
    } else {
      const float8 d = child_distances(node_of(tree, nodes, entry), p, n);
      if (!any(d < limit)) continue;
      vstore8(d, 0, distances);
      const uint child = first_child(entry);
      const uint bottom = waiting;
      for (uint lane = 0; lane < 8; ++lane) {
        if (!(distances[lane] < limit)) continue;
        // The nearest on top.
        uint place = waiting++;
        for (; place > bottom && bounds[place - 1] < distances[lane]; --place) {
          bounds[place] = bounds[place - 1];
          stack[place] = stack[place - 1];
        }
        bounds[place] = distances[lane];
        stack[place] = child + lane;
      }
    }
  }
  if (count < k) return limit;
  keep_nearest(candidates, count, k, limit);
  float radius2 = 0.0f;
  for (uint i = 0; i < k; ++i) radius2 = max(radius2, candidates[i]);
  return radius2;
}
// [/nearest]

// Adds the photons within the radius.
FUNCTION Sums power_within(const PhotonTreeData* tree, __global const float* nodes, __global const float* leaves,
                           float3 p, float3 n, float radius2) {
  Sums sums = no_sums();
  uint stack[STACK_SIZE];
  uint waiting = 1;
  stack[0] = tree->top << ENTRY_SHIFT;
  while (waiting > 0) {
    const uint entry = stack[--waiting];
    if (entry >> ENTRY_SHIFT == 0) {
      __global const float* leaf = leaf_of(leaves, entry);
      const int8 counts = photon_distances(leaf, p, n) <= radius2;
      sums.minus_count += counts;
      sums.red += counts ? vload8(PHOTON_POWER + 0, leaf) : 0.0f;
      sums.green += counts ? vload8(PHOTON_POWER + 1, leaf) : 0.0f;
      sums.blue += counts ? vload8(PHOTON_POWER + 2, leaf) : 0.0f;
    } else {
      const int8 reached = child_distances(node_of(tree, nodes, entry), p, n) <= radius2;
      if (!any(reached)) continue;
      int lanes[8];
      vstore8(reached, 0, lanes);
      const uint child = first_child(entry);
      for (uint lane = 8; lane-- > 0;) {
        stack[waiting] = child + lane;
        waiting += lanes[lane] != 0;
      }
    }
  }
  return sums;
}

// Irradiance [W/m2] at p on the side of the unit normal n: power of the k nearest over the area of the circle around them
// (Jensen 2001, section 7.2), or of all those within the greatest radius over its circle where they are fewer. `photons`:
// their number.
FUNCTION float3 irradiance_at(const PhotonMap* map, float3 p, float3 n, uint* photons) {
  const float limit = map->max_radius * map->max_radius;
  const float radius2 = nearest_radius2(&map->tree, map->nodes, map->leaves, p, n, map->nearest, limit);
  const Sums sums = power_within(&map->tree, map->nodes, map->leaves, p, n, radius2);
  *photons = photons_in(&sums);
  // Where k photons lie in one place, their irradiance is that of a circle of 0.1 um.
  return total_power(&sums) * (0.318309886183790672f / max(radius2, 1e-14f));
}

#endif
