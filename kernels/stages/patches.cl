// Stage patches: the caustic where its receiver is seen directly (patch.h).
// Reads: the scene and the camera; runs of photons, and where the points of the lattice landed. Writes: the planes that the
// picture shows; rows of patches; adds to the irradiance of the pixels that show a plane.
#include "footprint.h"
#include "outcome.h"
#include "patch.h"
#include "trace.h"
#include "view.h"

// The planes at the pixels' corners, row by row of width + 1.
KERNEL void look_at_corners(SCENE_PARAMETERS, __global const CameraData* camera, const uint eye_media, const uint stride,
                            __global float* planes) {
  const uint width = camera->width + 1u;
  const uint count = width * (camera->height + 1u);
  const uint i = get_global_id(0) * WIDTH;
  if (i >= count) return;
  const Scene scene = SCENE;
  const Uint corner = LANES + i;
  const Uint row = corner / width;
  RayPacket rays;
  rays.origin = uniform3(camera->eye);
  rays.direction = direction_through(camera, TO_FLOAT(AS_INT(corner - row * width)), TO_FLOAT(AS_INT(row)));
  rays.t_min = 0.0f;
  rays.t_max = INFINITY;
  Uint stack = eye_media;
  const SurfacePacket surface = trace(scene, rays, (Uint)NO_INDEX, lanes_below(i, count), 1, &stack);
  Mask plain = 0;
  FOR_LANES(lane, lanes_below(i, count) & (surface.t < INFINITY)) {
    __global const MaterialData* material = &scene.materials[LANE(surface.material, uint, lane)];
    SET_LANE(plain, int, lane,
             material->surface == SURFACE_OPAQUE && material->texture == NO_INDEX && is_diffuse(material) ? -1 : 0);
  }
  const Vec3 normal = select3(surface.entering, surface.geometric_normal, negate3(surface.geometric_normal));
  STORE(planes, VIEW_NORMAL * stride + i, plain ? normal.x : (Float)NAN);
  STORE(planes, (VIEW_NORMAL + 1) * stride + i, normal.y);
  STORE(planes, (VIEW_NORMAL + 2) * stride + i, normal.z);
  STORE(planes, VIEW_OFFSET * stride + i, dot3(normal, surface.position));
  STORE(planes, VIEW_TOLERANCE * stride + i, 8.0f * SURFACE_ROUNDING * largest3(surface.position));
}

// A neighbour on the lattice.
typedef struct {
  Vec3 place, power;
  Mask joined;                 // went the same way, to the same plane
} Neighbour;

FUNCTION Neighbour neighbour_at(__global const float* landings, const Uint point, const Mask is_there, const Uint way,
                                const Vec3 place, const Vec3 normal) {
  const Uint at = LANDING_ROW * (is_there ? point : (Uint)0);
  Neighbour n;
  n.place = GATHER3(landings, at);
  const Vec3 apart = subtract3(n.place, place);
  const Float off = fabs(dot3(apart, normal));
  n.joined = is_there & (AS_UINT(GATHER(Float, landings, at + LANDING_WAY)) == way) &
             (off <= fma((Float)1e-3f, largest3(apart), 8.0f * SURFACE_ROUNDING * largest3(place)));
  n.power = GATHER3(landings, at + LANDING_POWER);
  return n;
}

// Writes the lanes of `which` as further rows.
FUNCTION void put_rows(const Mask which, const Float* values, const uint stride, __global float* rows, uint* count) {
  FOR_LANES(lane, which) {
    for (uint field = 0; field < PATCH_FIELDS; ++field)
      rows[field * stride + *count] = LANE(values[field], float, lane);
    ++*count;
  }
}

// The corners in the picture and what a triangle's area is there, of quadrangles in a plane. Returns those in view.
FUNCTION Mask project_corners(__global const CameraData* camera, const Vec3* corners, const Vec3 normal, const Mask which,
                              Float* values, Mask* behind) {
  Seen seen[4];
  for (uint k = 0; k < 4; ++k) seen[k] = seen_at(camera, corners[k]);
  const Mask in_view = which & ((seen[0].outside & seen[1].outside & seen[2].outside & seen[3].outside) == 0);
  const Mask clear = seen[0].clear & seen[1].clear & seen[2].clear & seen[3].clear;
  *behind |= in_view & (clear == 0);
  for (uint k = 0; k < 4; ++k) {
    values[PATCH_CORNER + 2 * k] = seen[k].x;
    values[PATCH_CORNER + 2 * k + 1] = seen[k].y;
  }
  const float pixel = camera->step_x * camera->step_y;
  const Float height = fabs(dot3(normal, subtract3(corners[0], uniform3(camera->eye)))) / pixel;
  const Float shared = seen[0].depth * seen[2].depth;
  values[PATCH_SCALE] = height / (shared * seen[1].depth);
  values[PATCH_SCALE + 1] = height / (shared * seen[3].depth);
  return in_view & clear;
}

BODY project_run(__global const CameraData* camera, const uint stored, const uint run_length,
                 __global const float* restrict fields, __global const float* restrict landings, const LatticeData lattice,
                 const FootprintLimits limits, __global float* restrict rows, __global float* restrict boxes,
                 __global PatchRunData* restrict report) {
  const uint from_stride = photons_stride(run_length);
  const uint stride = patches_stride(run_length);
  uint count = 0;
  Mask behind = 0;
  for (uint first = 0; first < stored; first += WIDTH) {
    __global const float* photon = fields + first;
    const Mask here = lanes_below(first, stored);
    const Vec3 place = make_vec3(LOAD(photon, PHOTON_X * from_stride), LOAD(photon, PHOTON_Y * from_stride),
                                 LOAD(photon, PHOTON_Z * from_stride));
    const Vec3 power = make_vec3(LOAD(photon, PHOTON_POWER * from_stride), LOAD(photon, (PHOTON_POWER + 1) * from_stride),
                                 LOAD(photon, (PHOTON_POWER + 2) * from_stride));
    const Vec3 normal =
        make_vec3(LOAD(photon, ARRIVED_NORMAL * from_stride), LOAD(photon, (ARRIVED_NORMAL + 1) * from_stride),
                  LOAD(photon, (ARRIVED_NORMAL + 2) * from_stride));
    const Uint point = here ? AS_UINT(LOAD(photon, ARRIVED_POINT * from_stride)) : (Uint)NO_POINT;
    const Float spacing = LOAD(photon, ARRIVED_SPACING * from_stride);
    const Mask on_lattice = lattice.columns > 0 ? here & (point != NO_POINT) : (Mask)0;

    Float values[PATCH_FIELDS];
    values[PATCH_NORMAL + 0] = normal.x;
    values[PATCH_NORMAL + 1] = normal.y;
    values[PATCH_NORMAL + 2] = normal.z;
    values[PATCH_OFFSET] = dot3(normal, place);
    Mask alone = here;
    Float torn_power = 1.0f;
    if (ANY(on_lattice)) {
      const Uint own = on_lattice ? point : (Uint)0;
      const LatticePlace lies = place_on_lattice(lattice, own);
      const Uint way = AS_UINT(GATHER(Float, landings, LANDING_ROW * own + LANDING_WAY));
      // u: ahead and behind, v: ahead and behind.
      const Mask is_there[4] = {on_lattice & (lies.last_column == 0), on_lattice & (lies.first_column == 0),
                                on_lattice & (lies.last_row == 0), on_lattice & (lies.first_row == 0)};
      const Uint at[4] = {own + lies.to_column, own - lies.to_column, own + 1u, own - 1u};
      Neighbour side[4];
      for (uint k = 0; k < 4; ++k) side[k] = neighbour_at(landings, at[k], is_there[k], way, place, normal);
      // Quadrants: bit 0: behind along u, bit 1: behind along v. Their patches are whole or torn.
      Mask torn[4];
      Float torn_quadrants = 0.0f;
      Vec3 opposite = place;
      Vec3 opposite_power = power;
      for (uint k = 0; k < 4; ++k) {
        const uint u = k & 1u;
        const uint v = 2u + (k >> 1);
        const Neighbour corner = neighbour_at(landings, at[u] + at[v] - own, is_there[u] & is_there[v], way, place, normal);
        torn[k] = (side[u].joined & side[v].joined & corner.joined) == 0;
        torn_quadrants += torn[k] ? (Float)1.0f : (Float)0.0f;
        if (k == 0) opposite = corner.place;
        if (k == 0) opposite_power = corner.power;
      }

      const Vec3 corners[4] = {place, side[0].place, opposite, side[2].place};
      Mask shown = project_corners(camera, corners, normal, on_lattice & (torn[0] == 0), values, &behind);
      const Vec3 sum = add3(add3(power, side[0].power), add3(opposite_power, side[2].power));
      values[PATCH_POWER + 0] = 0.25f * sum.x;
      values[PATCH_POWER + 1] = 0.25f * sum.y;
      values[PATCH_POWER + 2] = 0.25f * sum.z;
      put_rows(shown, values, stride, rows, &count);

      // What is torn off goes on as its photon's neighbours on the other side tell.
      const Mask has_sides = (side[0].joined | side[1].joined) & (side[2].joined | side[3].joined);
      const Mask is_torn = on_lattice & has_sides & (torn_quadrants > 0.0f);
      alone &= (on_lattice & has_sides) == 0;
      if (ANY(is_torn)) {
        Vec3 along[2];
        for (uint axis = 0; axis < 2; ++axis) {
          const Neighbour ahead = side[2 * axis];
          const Neighbour back = side[2 * axis + 1];
          const Vec3 forward = subtract3(ahead.place, place);
          const Vec3 backward = subtract3(place, back.place);
          const Float forward2 = dot3(forward, forward);
          const Float backward2 = dot3(backward, backward);
          const Mask nearer_ahead = ahead.joined & ((back.joined == 0) | (forward2 < backward2));
          const Vec3 step = select3(nearer_ahead, forward, backward);
          const Float length = sqrt(nearer_ahead ? forward2 : backward2);
          const Float most = FOOTPRINT_MOST_PARTS * LEVEL_RATIO * limits.largest;
          along[axis] = scale3(length > most ? most / length : (Float)1.0f, step);
        }
        const Float low_u = (torn[1] | torn[3]) ? (Float)-0.5f : (Float)0.0f;
        const Float high_u = (torn[0] | torn[2]) ? (Float)0.5f : (Float)0.0f;
        const Float low_v = (torn[2] | torn[3]) ? (Float)-0.5f : (Float)0.0f;
        const Float high_v = (torn[0] | torn[1]) ? (Float)0.5f : (Float)0.0f;
        const Vec3 low = along3(place, low_u, along[0]);
        const Vec3 high = along3(place, high_u, along[0]);
        const Vec3 rest[4] = {along3(low, low_v, along[1]), along3(high, low_v, along[1]), along3(high, high_v, along[1]),
                              along3(low, high_v, along[1])};
        shown = project_corners(camera, rest, normal, is_torn, values, &behind);
        torn_power = 0.25f * torn_quadrants;
        values[PATCH_POWER + 0] = torn_power * power.x;
        values[PATCH_POWER + 1] = torn_power * power.y;
        values[PATCH_POWER + 2] = torn_power * power.z;
        put_rows(shown, values, stride, rows, &count);
      }
    }

    // By itself, it is spread over as much as a footprint would be, along the picture's rows and columns.
    if (ANY(alone)) {
      const Seen seen = seen_at(camera, place);
      const Float apart = on_lattice ? larger(spacing, (Float)LEVEL_RATIO) : spacing;
      const Float side = limits.largest * smaller(apart, (Float)FOOTPRINT_MOST_PARTS) / seen.depth;
      const Frame frame = frame_around(normal);
      const Vec3 d = scale3(1.0f / seen.depth, subtract3(place, uniform3(camera->eye)));
      const Vec3 across = along3(uniform3(camera->right), -dot3(d, uniform3(camera->right)), uniform3(camera->forward));
      const Vec3 down = along3(uniform3(camera->up), -dot3(d, uniform3(camera->up)), uniform3(camera->forward));
      const Float across_x = dot3(across, frame.x);
      const Float across_y = dot3(across, frame.y);
      const Float down_x = dot3(down, frame.x);
      const Float down_y = dot3(down, frame.y);
      const Float wide = side * sqrt(fma(across_x, across_x, across_y * across_y)) / camera->step_x;
      const Float high = side * sqrt(fma(down_x, down_x, down_y * down_y)) / camera->step_y;
      values[PATCH_CORNER + 0] = seen.x;
      values[PATCH_CORNER + 1] = seen.y;
      values[PATCH_CORNER + 2] = larger(wide, (Float)1e-3f);
      values[PATCH_CORNER + 3] = larger(high, (Float)1e-3f);
      for (uint k = 4; k < 8; ++k) values[PATCH_CORNER + k] = k % 2 == 0 ? seen.x : seen.y;
      values[PATCH_SCALE] =
          fabs(dot3(normal, d)) / (seen.depth * seen.depth * (camera->step_x * camera->step_y));
      values[PATCH_SCALE + 1] = PATCH_TENT;
      values[PATCH_POWER + 0] = power.x;
      values[PATCH_POWER + 1] = power.y;
      values[PATCH_POWER + 2] = power.z;
      const Mask near_view = (seen.x + wide > 0.0f) & (seen.x - wide < (float)camera->width) & (seen.y + high > 0.0f) &
                             (seen.y - high < (float)camera->height);
      put_rows(alone & seen.clear & near_view, values, stride, rows, &count);
    }
  }

  for (uint first = 0; first < count; first += PATCH_BLOCK) {
    float4 box = (float4)(INFINITY, INFINITY, -INFINITY, -INFINITY);
    for (uint i = first; i < min(first + PATCH_BLOCK, count); ++i) {
      __global const float* row = rows + i;
      const float2 corner = (float2)(row[0], row[stride]);
      if (row[(PATCH_SCALE + 1) * stride] == PATCH_TENT) {
        const float2 half_width = (float2)(row[2 * stride], row[3 * stride]);
        box = (float4)(fmin(box.lo, corner - half_width), fmax(box.hi, corner + half_width));
        continue;
      }
      for (uint k = 0; k < 4; ++k) {
        const float2 other = (float2)(row[2 * k * stride], row[(2 * k + 1) * stride]);
        box = (float4)(fmin(box.lo, other), fmax(box.hi, other));
      }
    }
    vstore4(box, first / PATCH_BLOCK, boxes);
  }
  report->rows = count;
  report->behind = ANY(behind);
}

// Runs [first_run, first_run + n_runs) of photons to runs [0, n_runs) of patches.
KERNEL void project_patches(__global const CameraData* camera, const uint first_run, const uint n_runs,
                            const uint run_length, const LatticeData lattice, const FootprintLimits limits,
                            __global const float* photons, __global const float* landings,
                            __global const PhotonRunData* runs, __global float* rows, __global float* boxes,
                            __global PatchRunData* reports) {
  const uint i = get_global_id(0);
  if (i >= n_runs) return;
  const uint run = first_run + i;
  project_run(camera, runs[run].photons[OUTCOME_STORED], run_length,
              photons + photon_in_run(run_length, run, 0, FOOTPRINT_ROW), landings, lattice, limits,
              rows + (ulong)i * PATCH_FIELDS * patches_stride(run_length), boxes + 4u * i * patch_boxes(run_length),
              &reports[i]);
}

// What patches are drawn to: a tile of the picture. Its sides, and the picture's rows, hold whole packets.
typedef struct {
  int left, top, right, bottom;        // [pixels], the last two outside
  uint pitch;                          // of rows
  uint stride;                         // of planes
  __global const float* planes;        // by pixel, VIEW_...
  __global float* irradiance;          // 3 planes [W/m2]
} Tile;

// Adds `power` times `shares` to the packet of pixels from (x, y) on, where they show the patch's plane.
FUNCTION void add_to_pixels(const Tile tile, const float4 plane, const float3 power, const Float shares, const int x,
                            const int y) {
  const uint i = (uint)y * tile.pitch + (uint)x;
  const Vec3 normal = make_vec3(LOAD(tile.planes, VIEW_NORMAL * tile.stride + i),
                                LOAD(tile.planes, (VIEW_NORMAL + 1) * tile.stride + i),
                                LOAD(tile.planes, (VIEW_NORMAL + 2) * tile.stride + i));
  const Float off = fabs(LOAD(tile.planes, VIEW_OFFSET * tile.stride + i) - plane.w);
  const Mask shown = (normal.x * plane.x + normal.y * plane.y + normal.z * plane.z > 0.9999f) &
                     (off <= LOAD(tile.planes, VIEW_TOLERANCE * tile.stride + i));
  if (!ANY(shown)) return;
  const Float share = shown ? shares : (Float)0.0f;
  __global float* to = tile.irradiance + i;
  STORE(to, 0, LOAD(to, 0) + power.x * share);
  STORE(to, tile.stride, LOAD(to, tile.stride) + power.y * share);
  STORE(to, 2 * tile.stride, LOAD(to, 2 * tile.stride) + power.z * share);
}

FUNCTION void add_to_pixel(const Tile tile, const float4 plane, const float3 power, const float2 place) {
  const int x = (int)floor(place.x);
  const int y = (int)floor(place.y);
  if (x < tile.left || x >= tile.right || y < tile.top || y >= tile.bottom) return;
  const uint i = (uint)y * tile.pitch + (uint)x;
  __global const float* seen = tile.planes + i;
  const float along = seen[VIEW_NORMAL * tile.stride] * plane.x + seen[(VIEW_NORMAL + 1) * tile.stride] * plane.y +
                      seen[(VIEW_NORMAL + 2) * tile.stride] * plane.z;
  if (!(along > 0.9999f && fabs(seen[VIEW_OFFSET * tile.stride] - plane.w) <= seen[VIEW_TOLERANCE * tile.stride])) return;
  tile.irradiance[i] += power.x;
  tile.irradiance[tile.stride + i] += power.y;
  tile.irradiance[2 * tile.stride + i] += power.z;
}

// Of the packet that pixel x of a tile is in, the first.
FUNCTION int packet_of(const Tile tile, const int x) { return tile.left + (max(x, tile.left) - tile.left) / WIDTH * WIDTH; }

// Of pixels whose left sides are at `left`, the share that lies left of an edge, which goes from a to b, a <= b, over as
// many rows as it does: the mean over it of clamp(x - left, 0, 1). `inverse`: of b - a.
FUNCTION Float share_left_of(const float a, const float b, const float inverse, const Float left) {
  const Float from = a - left;
  const Float to = b - left;
  const Float zero = 0.0f;
  const Float one = 1.0f;
  const Float beyond = smaller(larger((to - 1.0f) * inverse, zero), one);
  const Float before = smaller(larger(-from * inverse, zero), one);
  const Float middle = 0.5f * (smaller(larger(from, zero), one) + smaller(larger(to, zero), one));
  return fma(1.0f - beyond - before, middle, beyond);
}

// The share of a triangle's area up to fraction t of its longest side, its corner at fraction `middle` of it.
FUNCTION float share_below(const float t, const float middle) {
  return t < middle ? t * t / middle : 1.0f - (1.0f - t) * (1.0f - t) / (1.0f - middle);
}

// Adds `power` along a triangle that is thinner than areas of pixels can tell, pixel by pixel (Amanatides and Woo, A Fast
// Voxel Traversal Algorithm for Ray Tracing, 1987).
FUNCTION void draw_line(const Tile tile, const float4 plane, const float3 power, const float2 a, const float2 b,
                        const float2 c) {
  const float2 ab = b - a;
  const float2 bc = c - b;
  const float2 ca = a - c;
  const float ab2 = ab.x * ab.x + ab.y * ab.y;
  const float bc2 = bc.x * bc.x + bc.y * bc.y;
  const float ca2 = ca.x * ca.x + ca.y * ca.y;
  const float longest2 = max(ab2, max(bc2, ca2));
  const float2 from = ab2 == longest2 ? a : bc2 == longest2 ? b : c;
  const float2 along = ab2 == longest2 ? ab : bc2 == longest2 ? bc : ca;
  const float2 corner = (ab2 == longest2 ? c : bc2 == longest2 ? a : b) - from;
  const float middle = clamp((corner.x * along.x + corner.y * along.y) / longest2, 0.0f, 1.0f);
  float2 pixel = floor(from);
  const float2 last = floor(from + along);
  const float2 step = (float2)(along.x < 0.0f ? -1.0f : 1.0f, along.y < 0.0f ? -1.0f : 1.0f);
  const float2 size = 1.0f / fmax(fabs(along), 1e-9f);
  float2 next = (step * (pixel - from) + (float2)(along.x < 0.0f ? 0.0f : 1.0f, along.y < 0.0f ? 0.0f : 1.0f)) * size;
  const uint borders = (uint)(fabs(last.x - pixel.x) + fabs(last.y - pixel.y));
  float done = 0.0f;
  for (uint border = 0; border <= borders; ++border) {
    const float share = border < borders ? share_below(clamp(min(next.x, next.y), 0.0f, 1.0f), middle) : 1.0f;
    add_to_pixel(tile, plane, max(share - done, 0.0f) * power, pixel + 0.5f);
    done = max(share, done);
    if (next.x < next.y) {
      pixel.x += step.x;
      next.x += size.x;
    } else {
      pixel.y += step.y;
      next.y += size.y;
    }
  }
}

// Adds `power` by the area of triangle a, b, c that is in each pixel.
FUNCTION void draw_triangle(const Tile tile, const float4 plane, const float3 power, const float2 a, const float2 b,
                            const float2 c) {
  const float2 low = fmin(a, fmin(b, c));
  const float2 high = fmax(a, fmax(b, c));
  const float4 pixels = floor((float4)(low, high));
  if (pixels.x == pixels.z && pixels.y == pixels.w) {
    add_to_pixel(tile, plane, power, low);
    return;
  }
  // From the tile's corner, where numbers are small.
  const float2 origin = (float2)((float)tile.left, (float)tile.top);
  const float2 corners[4] = {a - origin, b - origin, c - origin, a - origin};
  const float2 u = corners[1] - corners[0];
  const float2 v = corners[2] - corners[0];
  const float twice_area = u.x * v.y - u.y * v.x;
  const float2 size = high - low;
  const float longest = max(size.x, size.y);
  if (!(fabs(twice_area) > 2e-3f * longest)) {
    draw_line(tile, plane, power, a, b, c);
    return;
  }
  const float3 density = (2.0f / twice_area) * power;
  float slope[3];
  for (uint k = 0; k < 3; ++k) slope[k] = (corners[k + 1].x - corners[k].x) / (corners[k + 1].y - corners[k].y);
  const int last_row = min((int)ceil(high.y), tile.bottom);
  for (int y = max((int)pixels.y, tile.top); y < last_row; ++y) {
    const float above = (float)(y - tile.top);
    const float below = above + 1.0f;
    float left[3], right[3], inverse[3], rows[3];
    float first = INFINITY;
    float last = -INFINITY;
    for (uint k = 0; k < 3; ++k) {
      const float2 from = corners[k];
      const float2 to = corners[k + 1];
      const float start = clamp(from.y, above, below);
      const float end = clamp(to.y, above, below);
      rows[k] = end - start;
      if (rows[k] == 0.0f) continue;
      const float2 range = (float2)(min(from.x, to.x), max(from.x, to.x));
      const float x_start = start == from.y ? from.x : clamp(from.x + (start - from.y) * slope[k], range.x, range.y);
      const float x_end = end == to.y ? to.x : clamp(from.x + (end - from.y) * slope[k], range.x, range.y);
      left[k] = min(x_start, x_end);
      right[k] = max(x_start, x_end);
      inverse[k] = 1.0f / max(right[k] - left[k], 1e-9f);
      first = min(first, left[k]);
      last = max(last, right[k]);
    }
    const int end = min(tile.left + (int)ceil(min(last, 1e6f)), tile.right);
    for (int x = packet_of(tile, tile.left + (int)floor(max(first, 0.0f))); x < end; x += WIDTH) {
      const Float left_sides = TO_FLOAT(AS_INT(LANES) + (x - tile.left));
      Float share = 0.0f;
      for (uint k = 0; k < 3; ++k)
        if (rows[k] != 0.0f) share += rows[k] * share_left_of(left[k], right[k], inverse[k], left_sides);
      add_to_pixels(tile, plane, density, share, x, y);
    }
  }
}

// The integral of a tent of area 1 from -1 to 1 up to t.
FUNCTION Float tent_below(const Float t) {
  const Float one = 1.0f;
  const Float zero = 0.0f;
  const Float rising = larger(smaller(1.0f + t, one), zero);
  const Float falling = larger(smaller(t, one), zero);
  return 0.5f * rising * rising + falling * (1.0f - 0.5f * falling);
}

FUNCTION void draw_tent(const Tile tile, const float4 plane, const float3 power, const float2 middle,
                        const float2 half_width) {
  const int first_row = max((int)floor(max(middle.y - half_width.y, -1.0f)), tile.top);
  const int last_row = min((int)ceil(min(middle.y + half_width.y, 1e6f)), tile.bottom);
  const int first_column = packet_of(tile, (int)floor(max(middle.x - half_width.x, 0.0f)));
  const int last_column = min((int)ceil(min(middle.x + half_width.x, 1e6f)), tile.right);
  for (int y = first_row; y < last_row; ++y) {
    const Float lower = ((float)(y + 1) - middle.y) / half_width.y;
    const Float upper = ((float)y - middle.y) / half_width.y;
    const Float in_row = tent_below(lower) - tent_below(upper);
    for (int x = first_column; x < last_column; x += WIDTH) {
      const Float left = (TO_FLOAT(AS_INT(LANES) + x) - middle.x) / half_width.x;
      const Float share = in_row * (tent_below(left + 1.0f / half_width.x) - tent_below(left));
      add_to_pixels(tile, plane, power, share, x, y);
    }
  }
}

BODY draw_run(const Tile tile, const uint count, const uint stride, __global const float* restrict rows,
              __global const float* restrict boxes) {
  for (uint first = 0; first < count; first += PATCH_BLOCK) {
    const float4 box = vload4(first / PATCH_BLOCK, boxes);
    if (!(box.x < (float)tile.right && box.z > (float)tile.left && box.y < (float)tile.bottom && box.w > (float)tile.top))
      continue;
    const uint last = min(first + PATCH_BLOCK, count);
    for (uint i = first; i < last; ++i) {
      __global const float* row = rows + i;
      const float2 a = (float2)(row[0], row[stride]);
      const float2 b = (float2)(row[2 * stride], row[3 * stride]);
      const float2 c = (float2)(row[4 * stride], row[5 * stride]);
      const float2 d = (float2)(row[6 * stride], row[7 * stride]);
      const float3 power = (float3)(row[PATCH_POWER * stride], row[(PATCH_POWER + 1) * stride],
                                    row[(PATCH_POWER + 2) * stride]);
      const float4 plane = (float4)(row[PATCH_NORMAL * stride], row[(PATCH_NORMAL + 1) * stride],
                                    row[(PATCH_NORMAL + 2) * stride], row[PATCH_OFFSET * stride]);
      const float scale = row[PATCH_SCALE * stride];
      const float other_scale = row[(PATCH_SCALE + 1) * stride];
      if (other_scale == PATCH_TENT) {
        draw_tent(tile, plane, scale * power, a, b);
        continue;
      }
      const float2 low = fmin(fmin(a, b), fmin(c, d));
      const float2 high = fmax(fmax(a, b), fmax(c, d));
      if (!(low.x < (float)tile.right && high.x > (float)tile.left && low.y < (float)tile.bottom && high.y > (float)tile.top))
        continue;
      const float4 pixels = floor((float4)(low, high));
      if (pixels.x == pixels.z && pixels.y == pixels.w) {
        add_to_pixel(tile, plane, 0.5f * (scale + other_scale) * power, low);
        continue;
      }
      draw_triangle(tile, plane, 0.5f * scale * power, a, b, c);
      draw_triangle(tile, plane, 0.5f * other_scale * power, a, c, d);
    }
  }
}

// Adds n_runs runs of patches to tiles of `tile_size` pixels' side, row by row of
// tiles. `tile_size` and `pitch` are multiples of every WIDTH.
KERNEL void draw_patches(__global const CameraData* camera, const uint n_runs, const uint run_length, const uint tile_size,
                         __global const float* rows, __global const float* boxes, __global const PatchRunData* reports,
                         const uint pitch, const uint stride, __global const float* planes, __global float* irradiance) {
  const uint across = (camera->width + tile_size - 1u) / tile_size;
  const uint down = (camera->height + tile_size - 1u) / tile_size;
  const uint i = get_global_id(0);
  if (i >= across * down) return;
  Tile tile;
  tile.left = (int)(i % across * tile_size);
  tile.top = (int)(i / across * tile_size);
  tile.right = min(tile.left + (int)tile_size, (int)pitch);
  tile.bottom = min(tile.top + (int)tile_size, (int)camera->height);
  tile.pitch = pitch;
  tile.stride = stride;
  tile.planes = planes;
  tile.irradiance = irradiance;
  for (uint run = 0; run < n_runs; ++run)
    draw_run(tile, reports[run].rows, patches_stride(run_length),
             rows + (ulong)run * PATCH_FIELDS * patches_stride(run_length), boxes + 4u * run * patch_boxes(run_length));
}
