// Triangles of meshes as rays meet them: WIDTH at a time, by their numbers among those of all meshes.
#ifndef VITRUM_MESH_H
#define VITRUM_MESH_H

#include "packet.h"
#include "scene.h"
#include "surface.h"

typedef struct {
  Vec3 a, b, c;
} Corners;

FUNCTION Corners corners_of(const Scene scene, const Uint primitive) {
  Corners corners;
  corners.a = GATHER3(scene.positions, 3u * FIELD(Uint, uint, scene.triangles, position[0], primitive));
  corners.b = GATHER3(scene.positions, 3u * FIELD(Uint, uint, scene.triangles, position[1], primitive));
  corners.c = GATHER3(scene.positions, 3u * FIELD(Uint, uint, scene.triangles, position[2], primitive));
  return corners;
}

FUNCTION Vec3 normal_of(const Corners* corners) {
  return normalize_any3(cross3(subtract3(corners->b, corners->a), subtract3(corners->c, corners->a)));
}

// Bound of the distance [m] between a place that is computed on a triangle and its plane.
FUNCTION Float triangle_error(const Corners* corners) {
  return SURFACE_ROUNDING * larger(larger(largest3(corners->a), largest3(corners->b)), largest3(corners->c));
}

// The bodies that shapes beyond the exact ones are, in the lanes of `which`; 0 in the others.
FUNCTION Uint bodies_of(const Scene scene, const Mask which, const Uint shape) {
  return which ? shape - (scene.n_spheres + scene.n_flats) : (Uint)(0);
}
FUNCTION __global const BodyData* body_of(const Scene scene, const uint shape) {
  return &scene.bodies[shape - (scene.n_spheres + scene.n_flats)];
}

// What a mesh has at its triangles' corners, as indices.
typedef struct {
  Mask there;
  Uint a, b, c;                // 0 in other lanes
} CornerIndices;

// In the lanes of `which`. `start`: BodyData's normals or texcoords; `corners`: what that is an index of.
FUNCTION CornerIndices corner_indices(__global const uint* corners, const Mask which, const Uint start,
                                      const Uint primitive) {
  CornerIndices indices;
  indices.there = which & (start != NO_INDEX);
  indices.a = indices.b = indices.c = (Uint)(0);
  if (!ANY(indices.there)) return indices;
  const Uint place = indices.there ? start + 3u * primitive : (Uint)(0);
  const Uint first = GATHER(Uint, corners, place);
  indices.there &= first != NO_INDEX;
  indices.a = indices.there ? first : (Uint)(0);
  indices.b = indices.there ? GATHER(Uint, corners + 1, place) : (Uint)(0);
  indices.c = indices.there ? GATHER(Uint, corners + 2, place) : (Uint)(0);
  return indices;
}

// A packet's rays, for the tree: those of the lanes of `which`.
FUNCTION MeshRays mesh_rays(const Scene scene, const RayPacket* packet, const Uint from, const Mask which) {
  const Mask leaves_mesh = which & (from != NO_INDEX) & ((from & FROM_MESH) != 0);
  const Uint primitive = leaves_mesh ? from & FROM_TRIANGLE : (Uint)(0);
  MeshRays m;
  m.rays = *packet;
  m.rays.t_min = leaves_mesh ? 0.0f : packet->t_min;
  m.error = packet->t_min;
  m.shape = leaves_mesh ? FIELD(Uint, uint, scene.triangles, shape, primitive) : (Uint)(NO_INDEX);
  m.primitive = leaves_mesh ? primitive : (Uint)(NO_INDEX);
  m.front = (leaves_mesh & ((from & FROM_FRONT) != 0)) ? (Uint)(1) : (Uint)(0);
  return m;
}

#endif
