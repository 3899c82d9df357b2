// The first surface that rays meet: exact shapes WIDTH rays at a time, then meshes (trace_mesh.h).
#ifndef VITRUM_TRACE_H
#define VITRUM_TRACE_H

#include "trace_exact.h"
#if HAS_MESH
#include "trace_mesh.h"
#endif

// `active`: the lanes that matter; others come out as anything. `textured`: texture coordinates are wanted. `media`: the
// stacks of the rays, which are mended where a ray slipped past an edge of a mesh (trace_mesh.h).
FUNCTION SurfacePacket trace(const Scene scene, const RayPacket packet, const Uint from, const Mask active,
                             const int textured, Uint* media) {
  SurfacePacket surface = trace_exact(scene, packet, from, textured);
#if HAS_MESH
  trace_mesh(scene, &packet, from, active, &surface, media);
#endif
  return surface;
}

#endif
