// Stage camera: pixels from the eye to the film.
// Reads: the scene, the camera, samples, the photon map, drawn patches. Adds to: the film's planes, counts.
// A work-item minds WIDTH neighbouring pixels. Where glass splits their rays, the packet of reflected rays waits on a
// stack of its own while the refracted ones are followed. So nothing depends on timing, and samples may be dealt out to
// launches in any way: a pixel's shares are added up in the same order.
// Pixels stand in slots, in any order, so that those that get many samples can be neighbours. The film is by slot.
#include "film.h"
#include "gather.h"
#include "patch.h"
#include "sampler.h"
#include "shade.h"
#include "trace.h"
#include "view.h"

// Rays through `pixel` for a sample. `jitter` 0: through the pixel's centre.
FUNCTION CameraRays camera_rays(__global const CameraData* camera, __global const CameraSample* sample,
                                const uint jitter, const uint media, const Uint pixel) {
  const Uint row = pixel / camera->width;
  const Uint column = pixel - row * camera->width;
  const Uint path = hash_pair(pixel, (Uint)sample->seed);

  // One point of a two-dimensional sequence for all pixels, shifted at random in each (Cranley and Patterson 1976).
  const Float shifted_x = unit_float(hash32(path + 1)) + sample->x;
  const Float shifted_y = unit_float(hash32(path + 2)) + sample->y;
  const Float jx = jitter ? shifted_x - floor(shifted_x) : 0.5f;
  const Float jy = jitter ? shifted_y - floor(shifted_y) : 0.5f;
  CameraRays rays;
  rays.rays.origin = uniform3(camera->eye);
  rays.rays.direction = direction_through(camera, TO_FLOAT(AS_INT(column)) + jx, TO_FLOAT(AS_INT(row)) + jy);
#if HAS_PATCHES
  rays.x = jx;
  rays.y = jy;
#endif
  rays.rays.t_min = 0.0f;
  rays.rays.t_max = INFINITY;
  rays.weight = make_vec3(1.0f, 1.0f, 1.0f);
  rays.media = media;
  rays.from = NO_INDEX;
  rays.path = path;
  rays.depth = 0;
  rays.active = (Mask)-1;
  return rays;
}

// The rest of what `child` needs to leave the surfaces that `parent` met, `crossing` them or not. That also tells its
// random numbers from those of its sibling (every use hashes them again).
FUNCTION void start_from(const SurfacePacket* surface, const CameraRays* parent, const uint crossing, CameraRays* child) {
  child->rays.origin = surface->position;
  child->rays.t_min = surface->error;
  child->rays.t_max = INFINITY;
  child->from = leaving(surface, crossing ? surface->entering == 0 : surface->entering);
  child->path = parent->path * 0x9e3779b1u + (0x7f4a7c15u + crossing);
  child->depth = parent->depth + 1;
}

FUNCTION void add_count(__global uint* count, const ulong n) {
  const uint low = (uint)n;
  const uint before = atomic_add(&count[0], low);
  const uint high = (uint)(n >> 32) + (before + low < before);
  if (high > 0) atomic_add(&count[1], high);
}

// What the first surface is.
FUNCTION void add_first_hits(const Scene scene, const SurfacePacket* surface, const Shading* shading, const uint i,
                             const uint stride, __global float* film) {
  for (uint lane = 0; lane < WIDTH; ++lane) {
    const float t = LANE(surface->t, float, lane);
    if (!(t < INFINITY)) continue;
    const uint kind = scene.materials[LANE(surface->material, uint, lane)].surface;
    const float3 diffuse = LANE3(shading->scattering.diffuse, lane);
    const float3 albedo = kind == SURFACE_MIRROR || kind == SURFACE_DIELECTRIC ? (float3)(1.0f) : diffuse;
    const float3 normal = LANE3(shading->scattering.normal, lane);
    film[(FILM_ALBEDO + 0) * stride + i + lane] += albedo.x;
    film[(FILM_ALBEDO + 1) * stride + i + lane] += albedo.y;
    film[(FILM_ALBEDO + 2) * stride + i + lane] += albedo.z;
    film[(FILM_NORMAL + 0) * stride + i + lane] += normal.x;
    film[(FILM_NORMAL + 1) * stride + i + lane] += normal.y;
    film[(FILM_NORMAL + 2) * stride + i + lane] += normal.z;
    film[FILM_DEPTH * stride + i + lane] += t;
  }
}

FUNCTION Vec3 load_film3(__global const float* film, uint plane, uint stride, uint i) {
  return make_vec3(LOAD(film, plane * stride + i), LOAD(film, (plane + 1) * stride + i),
                   LOAD(film, (plane + 2) * stride + i));
}

FUNCTION void store_film3(__global float* film, uint plane, uint stride, uint i, const Vec3 value) {
  STORE(film, plane * stride + i, value.x);
  STORE(film, (plane + 1) * stride + i, value.y);
  STORE(film, (plane + 2) * stride + i, value.z);
}

BODY trace_pixels(const Scene scene, const PhotonMap map, const PatchView view, const CameraLimits limits,
                  __global const CameraData* camera_data, __global const CameraSample* samples,
                  const uint first_sample, const uint last_sample, const uint jitter, const Uint pixels, const uint i,
                  const uint last_slot, const uint eye_media, const uint n_lights, const uint first_hits,
                  const uint film_stride, __global float* restrict film, __global uint* restrict counts) {
#if CAUSTICS != CAUSTICS_NONE
  Vec3 caustics = load_film3(film, FILM_CAUSTICS, film_stride, i);
  ulong gathered = 0;
  ulong pairs = 0;
#endif
  Vec3 beauty = load_film3(film, FILM_BEAUTY, film_stride, i);
  Float cut = LOAD(film, FILM_CUT * film_stride + i);
#if HAS_PATCHES
  const ShownPlane shown = plane_shown(view, pixels);
  const Uint row = pixels / camera_data->width;
  const Uint column = pixels - row * camera_data->width;
#endif
  uint secondary_rays = 0;
  uint shadow_rays = 0;

  CameraRays waiting[CAMERA_STACK];
  for (uint s = first_sample; s < last_sample; ++s) {
    waiting[0] = camera_rays(camera_data, &samples[s], jitter, eye_media, pixels);
    waiting[0].active = lanes_below(i, last_slot);
    uint n_waiting = 1;
    while (n_waiting > 0) {
      CameraRays camera = waiting[--n_waiting];
      const SurfacePacket surface = trace(scene, camera.rays, camera.from, camera.active, 1, &camera.media);
      Shading shading = shade(scene, limits, &camera, &surface);
      Vec3 radiance = shading.shown;
#if HAS_DIRECT_LIGHT
      for (uint light = 0; light < n_lights; ++light)
        radiance = add3(radiance, direct_light(scene, light, &samples[s], camera.path, camera.rays.direction,
                                               camera.media, &surface, &shading.scattering, camera.active,
                                               &shadow_rays));
#endif
#if CAUSTICS != CAUSTICS_NONE
      const Mask receives = camera.active & (max_channel(shading.scattering.diffuse) > 0.0f);
      Mask gathers = map.count > 0 ? receives & within_reach(&map, surface.position) : (Mask)0;
      Mask lit = gathers;
      Vec3 irradiance = make_vec3(0.0f, 0.0f, 0.0f);
#if HAS_PATCHES
      if (camera.depth == 0) {
        const Vec3 outward = surface.geometric_normal;
        const Vec3 normal = select3(surface.entering, outward, negate3(outward));
        const Mask drawn = receives & is_on(&shown, surface.position, normal);
        irradiance = select3(drawn, irradiance_shown(view, column, row, camera.x, camera.y), irradiance);
        lit |= drawn;
        gathers &= drawn == 0;
      }
#endif
      if (ANY(gathers)) {
        const Vec3 found = gathered_irradiance(&map, surface.position, shading.scattering.normal, gathers, &gathered,
                                               &pairs);
        irradiance = select3(gathers, found, irradiance);
      }
      const Vec3 caustic = scale3(0.318309886183790672f, multiply3(shading.scattering.diffuse, irradiance));
      radiance = select3(lit, add3(radiance, caustic), radiance);
      caustics = select3(lit, add3(caustics, caustic), caustics);
#endif
      beauty = select3(camera.active, add3(beauty, radiance), beauty);
      cut = camera.active ? cut + shading.cut : cut;
      if (camera.depth == 0 && first_hits) add_first_hits(scene, &surface, &shading, i, film_stride, film);

      if (ANY(shading.reflected.active)) {
        start_from(&surface, &camera, 0, &shading.reflected);
        secondary_rays += lanes_set(shading.reflected.active);
        waiting[n_waiting++] = shading.reflected;
      }
#if HAS_DIELECTRIC
      if (ANY(shading.refracted.active)) {
        start_from(&surface, &camera, 1, &shading.refracted);
        secondary_rays += lanes_set(shading.refracted.active);
        waiting[n_waiting++] = shading.refracted;
      }
#endif
    }
  }

  store_film3(film, FILM_BEAUTY, film_stride, i, beauty);
#if CAUSTICS != CAUSTICS_NONE
  store_film3(film, FILM_CAUSTICS, film_stride, i, caustics);
#endif
  STORE(film, FILM_CUT * film_stride + i, cut);
  add_count(counts + COUNT_SECONDARY, secondary_rays);
  add_count(counts + COUNT_SHADOW, shadow_rays);
#if CAUSTICS != CAUSTICS_NONE
  add_count(counts + COUNT_GATHERED, gathered);
  add_count(counts + COUNT_PAIRS, pairs);
#endif
}

// Samples [first_sample, last_sample) of the pixels in slots [first_slot, last_slot), counted from the first of their own
// half of `samples`; SLOT_GROUP neighbours take as many of them as `allotted` says. first_slot is a multiple of WIDTH, and
// slots and film have room for whole packets. `eye_media`: the stack at the eye. `first_hits`: 1: albedo, normal and depth
// are wanted.
KERNEL void camera(SCENE_PARAMETERS, __global const CameraData* camera_data, __global const CameraSample* samples,
                   __global const uint* pixel_of_slot, __global const uint* allotted, const uint second_half,
                   const uint first_sample, const uint last_sample, const uint jitter, const uint first_slot,
                   const uint last_slot, const uint max_depth, const float min_weight, const float eye_index,
                   const uint eye_media, const uint n_lights, const uint first_hits PHOTON_MAP_PARAMETERS
                   PATCH_VIEW_PARAMETERS, const uint film_stride, __global float* film, __global uint* counts) {
  const uint i = first_slot + get_global_id(0) * WIDTH;
  if (i >= last_slot) return;
  const uint own = allotted[i / SLOT_GROUP];
  const Scene scene = SCENE;
  const PhotonMap map = PHOTON_MAP;
  const PatchView view = PATCH_VIEW;
  const CameraLimits limits = {max_depth, min_weight, eye_index};
  trace_pixels(scene, map, view, limits, camera_data, samples + second_half * own, first_sample, min(last_sample, own), jitter,
               LOAD(pixel_of_slot, i), i, last_slot, eye_media, n_lights, first_hits, film_stride, film, counts);
}
