// Triangles of meshes as rays meet them.
#ifndef VITRUM_MESH_H
#define VITRUM_MESH_H

#include "packet.h"
#include "scene.h"
#include "surface.h"

FUNCTION float3 corner_of(const Scene scene, __global const TriangleData* triangle, const uint corner) {
  return vload3(triangle->position[corner], scene.positions);
}

FUNCTION float3 triangle_normal(const Scene scene, __global const TriangleData* triangle) {
  const float3 a = corner_of(scene, triangle, 0);
  return lane_normalize3(lane_cross3(corner_of(scene, triangle, 1) - a, corner_of(scene, triangle, 2) - a));
}

FUNCTION int leaves_mesh(const uint from) { return from != NO_INDEX && (from & FROM_MESH); }

// One ray of a packet, for the tree.
FUNCTION Ray mesh_ray(const Scene scene, const RayPacket* packet, const uint from, const uint lane) {
  Ray ray = free_ray(LANE3(packet->origin, lane), LANE3(packet->direction, lane), LANE(packet->t_min, float, lane),
                     LANE(packet->t_max, float, lane));
  ray.error = ray.t_min;
  if (leaves_mesh(from)) {
    // What it leaves is known by name, so that its neighbours may come at once.
    ray.t_min = 0.0f;
    ray.primitive = from & FROM_TRIANGLE;
    ray.shape = scene.triangles[ray.primitive].shape;
    ray.front = (from & FROM_FRONT) != 0;
  }
  return ray;
}

#endif
