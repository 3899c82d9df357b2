// The first triangle that a ray meets, and what lies there.
#ifndef VITRUM_TRACE_MESH_H
#define VITRUM_TRACE_MESH_H

#include "contacts.h"
#include "media.h"
#include "mesh.h"
#include "tree.h"

// Puts what the triangles are at the places of hits into the lanes of `which`.
FUNCTION void set_mesh_surfaces(const Scene scene, const HitPacket* hits, const Mask which, SurfacePacket* surface) {
  const Uint primitive = which ? hits->primitive : (Uint)(0);
  const Corners corners = corners_of(scene, primitive);
  const Float u = hits->u;
  const Float v = hits->v;
  const Float w = 1.0f - u - v;
  // Near its plane however far the ray has come.
  const Vec3 to_b = subtract3(corners.b, corners.a);
  const Vec3 to_c = subtract3(corners.c, corners.a);
  const Vec3 position = along3(along3(corners.a, u, to_b), v, to_c);
  const Vec3 geometric = normal_of(&corners);
  const Uint body = bodies_of(scene, which, hits->shape);
  Vec3 shading = geometric;
  const CornerIndices normals =
      corner_indices(scene.normal_corners, which, FIELD(Uint, uint, scene.bodies, normals, body), primitive);
  if (ANY(normals.there)) {
    const Vec3 n = along3(along3(scale3(v, GATHER3(scene.normals, 3u * normals.c)), u,
                                 GATHER3(scene.normals, 3u * normals.b)), w, GATHER3(scene.normals, 3u * normals.a));
    const Mask is_smooth = normals.there & (dot3(n, geometric) > 1e-6f);
    shading = select3(is_smooth, normalize_any3(n), geometric);
  }
  surface->t = which ? hits->t : surface->t;
  surface->position = select3(which, position, surface->position);
  surface->geometric_normal = select3(which, geometric, surface->geometric_normal);
  surface->shading_normal = select3(which, shading, surface->shading_normal);
  surface->material = which ? FIELD(Uint, uint, scene.bodies, material, body) : surface->material;
  surface->error = which ? triangle_error(&corners) : surface->error;
  surface->entering = which ? hits->front != 0 : surface->entering;
  surface->from = which ? FROM_MESH | primitive : surface->from;
#if HAS_TEXTURES
  const CornerIndices mapped =
      corner_indices(scene.texcoord_corners, which, FIELD(Uint, uint, scene.bodies, texcoords, body), primitive);
  Float texture_u = NAN;
  Float texture_v = NAN;
  if (ANY(mapped.there)) {
    __global const float* us = scene.texcoords;
    __global const float* vs = scene.texcoords + 1;
    texture_u = w * GATHER(Float, us, 2u * mapped.a) + u * GATHER(Float, us, 2u * mapped.b) +
                v * GATHER(Float, us, 2u * mapped.c);
    texture_v = w * GATHER(Float, vs, 2u * mapped.a) + u * GATHER(Float, vs, 2u * mapped.b) +
                v * GATHER(Float, vs, 2u * mapped.c);
  }
  surface->u = which ? (mapped.there ? texture_u : NAN) : surface->u;
  surface->v = which ? (mapped.there ? texture_v : NAN) : surface->v;
#endif
}

#if HAS_CONTACTS

// How far off each other [m] two surfaces may be found that a ray from `origin` meets at one place, which is within
// `error` of the first: by what the triangle test makes of the way from there (tree.h).
FUNCTION Float contact_error(const Float error, const Vec3 origin) {
  return error + SURFACE_ROUNDING * largest3(origin);
}

// An opaque exact shape in contact with glass before it wins: these lanes of `met`.
FUNCTION Mask hidden_by_exact(const Scene scene, const RayPacket* rays, const HitPacket* hits, const Mask met,
                              const Mask exact_is_opaque, const SurfacePacket* surface) {
  const Corners corners = corners_of(scene, met ? hits->primitive : (Uint)(0));
  const Float gap = (surface->t - hits->t) * fabs(dot3(rays->direction, surface->geometric_normal));
  return met & exact_is_opaque & (gap <= contact_error(triangle_error(&corners), rays->origin));
}

// What lies within the rounding of the transparent surface in `lane` belongs to the same event: notes the further
// borders, or is true and has put an opaque surface in the place of its hit.
FUNCTION int find_contacts(const Scene scene, const RayPacket* rays, const uint lane, const float error,
                           SurfacePacket* surface, HitPacket* hits) {
  const float cosine = fabs(lane_dot3(LANE3(rays->direction, lane), LANE3(surface->geometric_normal, lane)));
  const Hit first = hit_of(hits, lane);
  Hit near[TREE_MAX_BORDERS];
  const uint n = tree_borders_within(rays, lane, scene.nodes, scene.leaves, first.t, first.t + error / cosine,
                                     LANE3(surface->position, lane), error, near);
  const uint first_entering = LANE(surface->entering, int, lane) != 0;
  uint contacts = 0;
  uint places = 0;
  for (uint k = 0; k < n; ++k) {
    __global const MaterialData* material = &scene.materials[body_of(scene, near[k].shape)->material];
    if (material->surface != SURFACE_DIELECTRIC) {
      set_hit(hits, lane, near[k]);
      return 1;
    }
    const uint entering = near[k].front;
    if (near[k].shape == first.shape && entering == first_entering) continue;
    if (places < MAX_CONTACTS) contacts |= packed_contact(material->medium, entering, places++);
  }
  SET_LANE(surface->contacts, uint, lane, contacts);
  return 0;
}

#endif

#if HAS_DIELECTRIC

// A ray that has gone into a closed mesh meets its back next, one that has gone out of it its front or nothing.
// Rounding near edges can make it otherwise, in one of two ways.
FUNCTION Mask are_astray(const MeshRays* rays, const HitPacket* hits) {
  const Mask meets_wrong_side = (hits->shape == rays->shape) & (hits->front != rays->front);
  return hits->t < INFINITY ? meets_wrong_side : rays->front == 0;
}

// One: rounding has put the start below the plane of the very triangle that the ray leaves, or back along a ray that
// grazes it, by as much as the ray takes to rise from the plane. There it may still be beyond an edge, and meet a
// neighbour from the side that it came from, or the one again that it met before. It has crossed this surface already.
// Of the lanes of `which`, whose rays leave a triangle.
FUNCTION Mask have_crossed_already(const Scene scene, const MeshRays* rays, const HitPacket* hits, const Mask which) {
  const Mask in_question =
      which & (hits->t < INFINITY) & (hits->shape == rays->shape) & ((hits->front | rays->front) != 0);
  if (!ANY(in_question)) return in_question;
  const Corners corners = corners_of(scene, in_question ? rays->primitive : (Uint)(0));
  return in_question & (hits->t * fabs(dot3(rays->rays.direction, normal_of(&corners))) <= rays->error);
}

// The other: a ray that grazes an edge has slipped past it. It went in, but from where rounding has put it the mesh
// lies behind, or the reverse. Then the stack of media is mended: the ray is on the other side.
FUNCTION void mend_media(const Scene scene, const MeshRays* rays, const Mask astray, Uint* media) {
  FOR_LANES(lane, astray) {
    const uint medium = scene.materials[body_of(scene, LANE(rays->shape, uint, lane))->material].medium;
    const uint stack = LANE(*media, uint, lane);
    SET_LANE(*media, uint, lane,
             LANE(rays->front, uint, lane) ? entered(scene, stack, medium) : left(stack, medium));
  }
}

// The lanes whose rays leave a closed body.
FUNCTION Mask leave_closed(const Scene scene, const MeshRays* rays) {
  const Mask leave = rays->shape != NO_INDEX;
  return leave & (FIELD(Uint, uint, scene.bodies, closed, bodies_of(scene, leave, rays->shape)) != 0);
}

#endif

// Replaces the exact shapes in the lanes of `active` by the triangles that come before them.
FUNCTION void trace_mesh(const Scene scene, const RayPacket* packet, const Uint from, const Mask active,
                         SurfacePacket* surface, Uint* media) {
  MeshRays rays = mesh_rays(scene, packet, from, active);
  HitPacket exact;
  exact.t = surface->t;
  exact.shape = surface->from;
  exact.primitive = exact.front = (Uint)(0);
  exact.u = exact.v = 0.0f;
  HitPacket hits = exact;
  uint found = 0;
  for (Mask todo = active; ANY(todo);) {
    const uint which = lane_bits(todo);
    found = (found & ~which) | tree_closest(&rays, which, scene.nodes, scene.leaves, &hits);
#if HAS_DIELECTRIC
    todo &= leave_closed(scene, &rays);
    const Mask again = have_crossed_already(scene, &rays, &hits, todo);
    mend_media(scene, &rays, todo & (again == 0) & are_astray(&rays, &hits), media);
    rays.rays.t_min = again ? hits.t : rays.rays.t_min;
    hits.t = again ? exact.t : hits.t;
    hits.shape = again ? exact.shape : hits.shape;
    hits.primitive = again ? exact.primitive : hits.primitive;
    hits.front = again ? exact.front : hits.front;
    todo = again;
#else
    todo = 0;
#endif
  }
  Mask met = mask_of(found);
#if HAS_CONTACTS
  const Uint exact_material = active ? surface->material : (Uint)(0);
  const Mask exact_is_opaque = FIELD(Uint, uint, scene.materials, surface, exact_material) != SURFACE_DIELECTRIC;
  const Uint body = bodies_of(scene, met, hits.shape);
  const Uint material = met ? FIELD(Uint, uint, scene.bodies, material, body) : exact_material;
  Mask transparent = active & (FIELD(Uint, uint, scene.materials, surface, material) == SURFACE_DIELECTRIC);
  const Mask hidden = hidden_by_exact(scene, packet, &hits, met & transparent, exact_is_opaque, surface);
  met &= hidden == 0;
  transparent &= (hidden == 0) & (hits.shape != NO_INDEX);
  while (ANY(met | transparent)) {
    set_mesh_surfaces(scene, &hits, met, surface);
    met = 0;
    const Float error = contact_error(surface->error, packet->origin);
    FOR_LANES(lane, transparent) {
      if (find_contacts(scene, packet, lane, LANE(error, float, lane), surface, &hits)) SET_LANE(met, int, lane, -1);
    }
    transparent = 0;
  }
#else
  if (ANY(met)) set_mesh_surfaces(scene, &hits, met, surface);
#endif
}

#endif
