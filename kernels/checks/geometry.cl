// Rays at the edges and corners of a closed mesh, for `vitrum verify`: none may slip through, and what enters must leave.
// Reads: the scene, whose only shape is the mesh. Writes: what was found, by work-item.
#include "checks/geometry_types.h"
#include "photon_step.h"
#include "trace.h"

FUNCTION Vec3 unit_vector(const Uint bits) {
  Float sine, cosine;
  sin_cos_turn(unit_float(hash32(bits + 11)), &sine, &cosine);
  const Float z = fma((Float)2.0f, unit_float(hash32(bits + 12)), (Float)-1.0f);
  const Float room = fma(-z, z, (Float)1.0f);
  const Float r = sqrt(room > 0.0f ? room : 0.0f);
  return make_vec3(r * cosine, r * sine, z);
}

// Ray `number` of each lane.
FUNCTION RayPacket aimed_rays(__global const float* edges, const uint n_edges, __global const AimData* aim,
                              const Uint number) {
  const Uint bits = hash_pair(number, (Uint)aim->seed);
  const Vec3 centre = uniform3(aim->centre);
  Vec3 target;
  if (aim->edges) {
    const Uint edge = (hash32(bits + 1) % n_edges) * 6u;
    const Float along = (hash32(bits + 3) & 7u) == 0u ? (Float)0.0f : unit_float(hash32(bits + 2));
    const Vec3 a = GATHER3(edges, edge);
    target = along3(a, along, subtract3(GATHER3(edges + 3, edge), a));
    target = along3(target, aim->spread * unit_float(hash32(bits + 4)), unit_vector(bits + 5));
  } else {
    target = along3(centre, aim->spread, unit_vector(bits + 5));
  }
  const Vec3 up = subtract3(target, centre);
  const Float size = length3(up);
  Vec3 aside = unit_vector(bits + 7);
  if (aim->tangential) aside = along3(aside, -dot3(aside, up) / (size * size), up);
  const Vec3 slanted = along3(up, aim->slant * size * unit_float(hash32(bits + 6)), aside);
  RayPacket rays;
  rays.origin = aim->distance > 0.0f ? along3(target, aim->distance, normalize3(slanted))
                                     : along3(centre, 0.3f * size * unit_float(hash32(bits + 6)), unit_vector(bits + 7));
  rays.direction = normalize3(subtract3(target, rays.origin));
  rays.t_min = 0.0f;
  rays.t_max = INFINITY;
  return rays;
}

FUNCTION void note_wrong(__global GeometryResult* result, const RayPacket* rays, const Mask wrong) {
  if (!ANY(wrong)) return;
  if (result->wrong == 0) {
    const uint lane = first_lane(wrong);
    vstore3(LANE3(rays->origin, lane), 0, result->origin);
    vstore3(LANE3(rays->direction, lane), 0, result->direction);
  }
  result->wrong += lanes_set(wrong);
}

FUNCTION uint sum_of_lanes(const Uint values) {
  uint sum = 0;
  for (uint lane = 0; lane < WIDTH; ++lane) sum += LANE(values, uint, lane);
  return sum;
}

BODY shoot_rays(const Scene scene, __global const float* edges, const uint n_edges, __global const AimData* aim,
                const uint first, const uint packets, __global GeometryResult* result) {
  for (uint k = 0; k < packets; ++k) {
    const RayPacket rays = aimed_rays(edges, n_edges, aim, LANES + (first + k * WIDTH));
    Uint media = 0;
    const SurfacePacket surface = trace(scene, rays, (Uint)NO_INDEX, (Mask)-1, 0, &media);
    note_wrong(result, &rays, (surface.t < INFINITY) == 0);
    // The triangle and the place on it.
    result->sum += sum_of_lanes(hash_pair(AS_UINT(surface.t), surface.from));
    result->rays += WIDTH;
    result->events += WIDTH;
  }
}

// Every one of them must hit: it is aimed at the mesh's edges.
KERNEL void edge_rays(SCENE_PARAMETERS, __global const float* edges, const uint n_edges, __global const AimData* aim,
                      const uint packets, const uint items, __global GeometryResult* results) {
  const Scene scene = SCENE;
  const uint item = get_global_id(0);
  if (item >= items) return;
  shoot_rays(scene, edges, n_edges, aim, item * packets * WIDTH, packets, &results[item]);
}

BODY follow_chains(const Scene scene, __global const float* edges, const uint n_edges, __global const AimData* aim,
                   const uint first, const uint packets, const uint max_depth, __global GeometryResult* result) {
  for (uint k = 0; k < packets; ++k) {
    const Uint number = LANES + (first + k * WIDTH);
    const RayPacket start = aimed_rays(edges, n_edges, aim, number);
    Photons photons;
    photons.origin = start.origin;
    photons.direction = start.direction;
    photons.power = make_vec3(1.0f, 1.0f, 1.0f);
    photons.t_min = 0.0f;
    photons.stack = aim->distance > 0.0f ? 0u : scene.materials[scene.bodies[0].material].medium;
    photons.from = NO_INDEX;
    photons.path = hash_pair(number, (Uint)(aim->seed + 77u));
    photons.history = 0;
    photons.alive = (Mask)-1;
    uint n_branched = 0;
    Tally absorbed, split_off;
    absorbed.sum = absorbed.rest = make_vec3(0.0f, 0.0f, 0.0f);
    split_off = absorbed;
    while (ANY(photons.alive)) {
      RayPacket packet = start;
      packet.origin = photons.origin;
      packet.direction = photons.direction;
      packet.t_min = photons.t_min;
      const SurfacePacket surface = trace(scene, packet, photons.from, photons.alive, 0, &photons.stack);
      // Outside of it the mesh shows its front, inside its back, and who is nowhere any more is outside. Only at an edge
      // that hides what is behind it may the back be met first: then the ray counts as having been inside (media.h).
      const Mask inside = photons.stack != 0;
      const Mask missed = (surface.t < INFINITY) == 0;
      const Mask in_order = (surface.entering != 0) != (inside != 0);
      const Mask wrong = photons.alive & (missed ? inside
                                                   : ((in_order == 0) & (surfaces_met(&photons) > 0)) |
                                                         (surfaces_met(&photons) >= aim->crossings));
      note_wrong(result, &start, wrong);
      result->events += lanes_set(photons.alive);
      photons.alive &= wrong == 0;
      interact(scene, &surface, max_depth, 0, 0, &photons, &n_branched, &absorbed, &split_off);
    }
    result->rays += WIDTH;
  }
}

// Photons that are reflected and refracted at random until they leave the mesh.
KERNEL void chains(SCENE_PARAMETERS, __global const float* edges, const uint n_edges, __global const AimData* aim,
                   const uint packets, const uint items, const uint max_depth, __global GeometryResult* results) {
  const Scene scene = SCENE;
  const uint item = get_global_id(0);
  if (item >= items) return;
  follow_chains(scene, edges, n_edges, aim, item * packets * WIDTH, packets, max_depth, &results[item]);
}
