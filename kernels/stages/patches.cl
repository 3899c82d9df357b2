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
    SET_LANE(plain, int, lane, material->surface == SURFACE_OPAQUE && is_diffuse(material) ? -1 : 0);
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

// What comes out of a run.
typedef struct {
  __global float* rows;
  uint count;
  uint most;                   // rows that there is room for
  uint too_many;               // 1: there were more
} Rows;

// Adds a row with one lane's power and plane.
FUNCTION __global float* next_row(Rows* rows, const Float* values, const uint lane) {
  if (rows->count >= rows->most) {
    rows->too_many = 1;
    --rows->count;
  }
  __global float* row = rows->rows + PATCH_ROW * rows->count++;
  for (uint field = 0; field < PATCH_FIELDS; ++field) row[field] = LANE(values[field], float, lane);
  return row;
}

// Writes the lanes of `which` as further rows.
FUNCTION void put_rows(const Mask which, const Float* values, Rows* rows) {
  FOR_LANES(lane, which) { next_row(rows, values, lane); }
}

// Of a triangle that reaches behind the eye, what is in front and near the view (Sutherland and Hodgman, Reentrant Polygon
// Clipping, 1974), as rows: a fan of quadrangles. Corners from the eye, along right, up and forward [m]; `density`: half of
// PATCH_SCALE by area in the picture; `nearest`: depth that no more is seen before.
BODY put_clipped(__global const CameraData* camera, const float detail, const float3* triangle, const float density,
                 const float nearest, const Float* values, const uint lane, Rows* rows) {
  float3 corners[8];
  for (uint k = 0; k < 3; ++k) corners[k] = triangle[k];
  uint n = 3;
  const float wide = -1.25f * camera->left;
  const float high = 1.25f * camera->top;
  for (uint side = 0; side < 5; ++side) {
    float3 inside[8];
    uint kept = 0;
    for (uint k = 0; k < n; ++k) {
      const float3 from = corners[k];
      const float3 to = corners[(k + 1) % n];
      const float sign = side & 1u ? 1.0f : -1.0f;
      const float d_from = side == 0 ? from.z - nearest : side < 3 ? wide * from.z + sign * from.x : high * from.z + sign * from.y;
      const float d_to = side == 0 ? to.z - nearest : side < 3 ? wide * to.z + sign * to.x : high * to.z + sign * to.y;
      if (d_from >= 0.0f) inside[kept++] = from;
      if ((d_from >= 0.0f) != (d_to >= 0.0f)) inside[kept++] = from + d_from / (d_from - d_to) * (to - from);
    }
    n = kept;
    for (uint k = 0; k < n; ++k) corners[k] = inside[k];
  }
  float2 seen[8];
  for (uint k = 0; k < n; ++k)
    seen[k] = detail * (float2)((corners[k].x / corners[k].z - camera->left) / camera->step_x,
                                (camera->top - corners[k].y / corners[k].z) / camera->step_y);
  for (uint k = 2; k < n; k += 2) {
    __global float* row = next_row(rows, values, lane);
    const float2 last = seen[min(k + 1, n - 1)];
    vstore8(joined4(joined2(seen[0], seen[k - 1]), joined2(seen[k], last)), 0, row + PATCH_CORNER);
    const float2 u = seen[k - 1] - seen[0];
    const float2 v = seen[k] - seen[0];
    const float2 w = last - seen[0];
    row[PATCH_SCALE] = density * fabs(u.x * v.y - u.y * v.x);
    row[PATCH_SCALE + 1] = density * fabs(v.x * w.y - v.y * w.x);
  }
}

// Puts out quadrangles in a plane, the corners of each in turn, with the power and plane in `values`. `weights`: of triangles
// (0, 1, 2) and (0, 2, 3), 1 where each has half of the power.
FUNCTION void put_quadrangles(__global const CameraData* camera, const float detail, const Vec3* corners, const Vec3 normal,
                              const Mask which, const Float* weights, Float* values, Rows* rows) {
  Seen seen[4];
  for (uint k = 0; k < 4; ++k) seen[k] = seen_at(camera, corners[k]);
  const Mask in_view = which & ((seen[0].outside & seen[1].outside & seen[2].outside & seen[3].outside) == 0);
  const Mask clear = seen[0].clear & seen[1].clear & seen[2].clear & seen[3].clear;
  for (uint k = 0; k < 4; ++k) {
    values[PATCH_CORNER + 2 * k] = detail * seen[k].x;
    values[PATCH_CORNER + 2 * k + 1] = detail * seen[k].y;
  }
  const float spot = camera->step_x * camera->step_y / (detail * detail);
  const Float height = fabs(dot3(normal, subtract3(corners[0], uniform3(camera->eye))));
  const Float shared = seen[0].depth * seen[2].depth * spot;
  values[PATCH_SCALE] = weights[0] * height / (shared * seen[1].depth);
  values[PATCH_SCALE + 1] = weights[1] * height / (shared * seen[3].depth);
  put_rows(in_view & clear, values, rows);
  FOR_LANES(lane, in_view & (clear == 0)) {
    float3 from_eye[4];
    for (uint k = 0; k < 4; ++k) {
      const Vec3 d = subtract3(corners[k], uniform3(camera->eye));
      const Vec3 at = make_vec3(dot3(d, uniform3(camera->right)), dot3(d, uniform3(camera->up)), seen[k].depth);
      from_eye[k] = LANE3(at, lane);
    }
    // What is in the view is at least as far off as the plane, and no farther to the side than the picture's corner.
    const float across = camera->left * camera->left + camera->top * camera->top;
    const float nearest = 0.5f * LANE(height, float, lane) / sqrt(1.0f + across);
    for (uint k = 0; k < 2; ++k) {
      const float3 triangle[3] = {from_eye[0], from_eye[1 + k], from_eye[2 + k]};
      const float3 twice_area = lane_cross3(triangle[1] - triangle[0], triangle[2] - triangle[0]);
      const float area = 0.5f * sqrt(lane_dot3(twice_area, twice_area));
      if (area > 0.0f)
        put_clipped(camera, detail, triangle, 0.5f * LANE(weights[k], float, lane) / area, nearest, values, lane, rows);
    }
  }
}

BODY project_run(__global const CameraData* camera, const float detail, const uint stored, const uint run_length,
                 __global const float* restrict fields, __global const float* restrict landings, const LatticeData lattice,
                 const FootprintLimits limits, __global float* restrict rows, __global float* restrict boxes,
                 __global PatchRunData* restrict report) {
  const uint from_stride = photons_stride(run_length);
  Rows out;
  out.rows = rows;
  out.count = out.too_many = 0;
  out.most = patches_stride(run_length);
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
      Mask any_torn = 0;
      Vec3 opposite = place;
      Vec3 opposite_power = power;
      for (uint k = 0; k < 4; ++k) {
        const uint u = k & 1u;
        const uint v = 2u + (k >> 1);
        const Neighbour corner = neighbour_at(landings, at[u] + at[v] - own, is_there[u] & is_there[v], way, place, normal);
        torn[k] = (side[u].joined & side[v].joined & corner.joined) == 0;
        any_torn |= torn[k];
        if (k == 0) opposite = corner.place;
        if (k == 0) opposite_power = corner.power;
      }

      const Vec3 corners[4] = {place, side[0].place, opposite, side[2].place};
      const Vec3 sum = add3(add3(power, side[0].power), add3(opposite_power, side[2].power));
      values[PATCH_POWER + 0] = 0.25f * sum.x;
      values[PATCH_POWER + 1] = 0.25f * sum.y;
      values[PATCH_POWER + 2] = 0.25f * sum.z;
      // By what of the light each triangle is, by area of the disc of emission, of which a point stands for pi over their number.
      const Float u0 = lies.step * TO_FLOAT(AS_INT(lies.column));
      const Float v0 = lies.step * TO_FLOAT(AS_INT(lies.row));
      const DiscPlace p = place_in_disc(lattice, u0, v0);
      const DiscPlace p_u = place_in_disc(lattice, u0 + lies.step, v0);
      const DiscPlace p_uv = place_in_disc(lattice, u0 + lies.step, v0 + lies.step);
      const DiscPlace p_v = place_in_disc(lattice, u0, v0 + lies.step);
      const Float x = p_uv.x - p.x;
      const Float y = p_uv.y - p.y;
      const Float each = 0.318309886f * (float)lattice_points(lattice) / (lies.step * lies.step);
      Float weights[2] = {each * fabs((p_u.x - p.x) * y - (p_u.y - p.y) * x), each * fabs((p_v.x - p.x) * y - (p_v.y - p.y) * x)};
      put_quadrangles(camera, detail, corners, normal, on_lattice & (torn[0] == 0), weights, values, &out);

      // What is torn off goes on as its photon's neighbours on the other side tell.
      const Mask has_sides = (side[0].joined | side[1].joined) & (side[2].joined | side[3].joined);
      const Mask is_torn = on_lattice & has_sides & any_torn;
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
          const Float most = FOOTPRINT_MOST_SIDE * limits.largest;
          along[axis] = scale3(length > most ? most / length : (Float)1.0f, step);
        }
        // Half way to what is torn off, and no farther than the lattice's border. What is beyond that is left out, for where
        // rays graze their neighbours do not tell where it goes; its share falls as 1 / photons.
        const Float half_step = 0.5f;
        const Float rows = (float)(1u << lattice.log2_rows);
        const Float width[4] = {smaller(((float)lattice.columns - lattice.shift_u - u0) / lies.step, half_step),
                                smaller((u0 + lattice.shift_u) / lies.step, half_step),
                                smaller((rows - lattice.shift_v - v0) / lies.step, half_step),
                                smaller((v0 + lattice.shift_v) / lies.step, half_step)};
        Float torn_area = 0.0f;
        for (uint k = 0; k < 4; ++k) torn_area += torn[k] ? width[k & 1u] * width[2u + (k >> 1)] : (Float)0.0f;
        const Float low_u = (torn[1] | torn[3]) ? -width[1] : (Float)0.0f;
        const Float high_u = (torn[0] | torn[2]) ? width[0] : (Float)0.0f;
        const Float low_v = (torn[2] | torn[3]) ? -width[3] : (Float)0.0f;
        const Float high_v = (torn[0] | torn[1]) ? width[2] : (Float)0.0f;
        const Vec3 low = along3(place, low_u, along[0]);
        const Vec3 high = along3(place, high_u, along[0]);
        const Vec3 rest[4] = {along3(low, low_v, along[1]), along3(high, low_v, along[1]), along3(high, high_v, along[1]),
                              along3(low, high_v, along[1])};
        values[PATCH_POWER + 0] = torn_area * power.x;
        values[PATCH_POWER + 1] = torn_area * power.y;
        values[PATCH_POWER + 2] = torn_area * power.z;
        weights[0] = weights[1] = 1.0f;
        put_quadrangles(camera, detail, rest, normal, is_torn, weights, values, &out);
      }
    }

    // By itself, it is spread over as much as a footprint would be, along the picture's rows and columns.
    if (ANY(alone)) {
      const Seen seen = seen_at(camera, place);
      const Float apart = on_lattice ? larger(spacing, (Float)LEVEL_RATIO) : spacing;
      const Float side = limits.largest * smaller(apart, (Float)FOOTPRINT_MOST_APART) / seen.depth;
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
      values[PATCH_CORNER + 0] = detail * seen.x;
      values[PATCH_CORNER + 1] = detail * seen.y;
      values[PATCH_CORNER + 2] = detail * larger(wide, (Float)1e-3f);
      values[PATCH_CORNER + 3] = detail * larger(high, (Float)1e-3f);
      for (uint k = 4; k < 8; ++k) values[PATCH_CORNER + k] = values[PATCH_CORNER + k % 2];
      values[PATCH_SCALE] = fabs(dot3(normal, d)) * (detail * detail) /
                            (seen.depth * seen.depth * (camera->step_x * camera->step_y));
      values[PATCH_SCALE + 1] = PATCH_TENT;
      values[PATCH_POWER + 0] = power.x;
      values[PATCH_POWER + 1] = power.y;
      values[PATCH_POWER + 2] = power.z;
      const Mask near_view = (seen.x + wide > 0.0f) & (seen.x - wide < (float)camera->width) & (seen.y + high > 0.0f) &
                             (seen.y - high < (float)camera->height);
      put_rows(alone & seen.clear & near_view, values, &out);
    }
  }

  for (uint first = 0; first < out.count; first += PATCH_BLOCK) {
    float4 box = (float4)(INFINITY, INFINITY, -INFINITY, -INFINITY);
    for (uint i = first; i < min(first + PATCH_BLOCK, out.count); ++i) {
      __global const float* row = rows + PATCH_ROW * i;
      const float8 corners = vload8(0, row + PATCH_CORNER);
      const float4 own = row[PATCH_SCALE + 1] == PATCH_TENT
                             ? joined2(corners.s01 - corners.s23, corners.s01 + corners.s23)
                             : joined2(fmin(fmin(corners.s01, corners.s23), fmin(corners.s45, corners.s67)),
                                       fmax(fmax(corners.s01, corners.s23), fmax(corners.s45, corners.s67)));
      box = joined2(fmin(box.lo, own.lo), fmax(box.hi, own.hi));
    }
    vstore4(box, first / PATCH_BLOCK, boxes);
  }
  report->rows = out.count;
  report->too_many = out.too_many;
}

// Runs [first_run, first_run + n_runs) of photons to runs [0, n_runs) of patches.
KERNEL void project_patches(__global const CameraData* camera, const uint detail, const uint first_run, const uint n_runs,
                            const uint run_length, const LatticeData lattice, const FootprintLimits limits,
                            __global const float* photons, __global const float* landings,
                            __global const PhotonRunData* runs, __global float* rows, __global float* boxes,
                            __global PatchRunData* reports) {
  const uint i = get_global_id(0);
  if (i >= n_runs) return;
  const uint run = first_run + i;
  project_run(camera, (float)detail, runs[run].photons[OUTCOME_STORED], run_length,
              photons + photon_in_run(run_length, run, 0, FOOTPRINT_ROW), landings, lattice, limits,
              rows + (ulong)i * PATCH_ROW * patches_stride(run_length), boxes + 4u * i * patch_boxes(run_length),
              &reports[i]);
}

// What patches are drawn to: a tile of the picture, in packets of SPOTS. Its sides, and the picture's rows, hold whole ones.
#define SPOTS 4
typedef struct {
  int left, top, right, bottom;        // [spots], the last two outside
  uint width;                          // of the picture [pixels]
  int is_one;                          // all pixels show the plane of the first
  ViewLayout layout;
  __global const float* planes;        // by pixel, VIEW_...
  __global float* irradiance;          // by spot, 3 planes [W/m2]
} Tile;

// Does the pixel of spot (x, y) show a plane?
FUNCTION int shows_plane(const Tile tile, const float4 plane, const int x, const int y) {
  const uint column = (uint)x / tile.layout.detail;
  if (column >= tile.width) return 0;
  __global const float* shown = tile.planes + (uint)y / tile.layout.detail * tile.width + column;
  const uint stride = tile.layout.plane_stride;
  const float along = shown[VIEW_NORMAL * stride] * plane.x + shown[(VIEW_NORMAL + 1) * stride] * plane.y +
                      shown[(VIEW_NORMAL + 2) * stride] * plane.z;
  return along > 0.9999f && fabs(shown[VIEW_OFFSET * stride] - plane.w) <= shown[VIEW_TOLERANCE * stride];
}

// Adds `power` times `shares` to the packet of spots from (x, y) on.
FUNCTION void add_to_spots(const Tile tile, const float4 plane, const float3 power, const float4 shares, const int x,
                           const int y) {
  float4 share = shares;
  if (!tile.is_one)
    for (int k = 0; k < SPOTS; ++k)
      if (!shows_plane(tile, plane, x + k, y)) ((float*)&share)[k] = 0.0f;
  const uint stride = tile.layout.spot_stride;
  __global float* to = tile.irradiance + (uint)y * tile.layout.pitch + (uint)x;
  vstore4(vload4(0, to) + power.x * share, 0, to);
  vstore4(vload4(0, to + stride) + power.y * share, 0, to + stride);
  vstore4(vload4(0, to + 2 * stride) + power.z * share, 0, to + 2 * stride);
}

FUNCTION void add_to_spot(const Tile tile, const float4 plane, const float3 power, const float2 place) {
  const int x = (int)floor(place.x);
  const int y = (int)floor(place.y);
  if (x < tile.left || x >= tile.right || y < tile.top || y >= tile.bottom) return;
  if (!tile.is_one && !shows_plane(tile, plane, x, y)) return;
  const uint stride = tile.layout.spot_stride;
  __global float* to = tile.irradiance + (uint)y * tile.layout.pitch + (uint)x;
  to[0] += power.x;
  to[stride] += power.y;
  to[2 * stride] += power.z;
}

// Of spots whose left sides are at `left`, four of a row and four of the next, the share that lies left of an edge: the mean
// over the edge's piece from a to b, a <= b, in each row of clamp(x - left, 0, 1). `inverse`: of b - a.
FUNCTION float8 share_left_of(const float8 a, const float8 b, const float8 inverse, const float8 left) {
  const float8 from = a - left;
  const float8 to = b - left;
  const float8 beyond = clamp((to - 1.0f) * inverse, 0.0f, 1.0f);
  const float8 before = clamp(-from * inverse, 0.0f, 1.0f);
  const float8 middle = 0.5f * (clamp(from, 0.0f, 1.0f) + clamp(to, 0.0f, 1.0f));
  return (1.0f - beyond - before) * middle + beyond;
}

// The share of a triangle's area up to fraction t of its longest side, its corner at fraction `middle` of it.
FUNCTION float share_below(const float t, const float middle) {
  return t < middle ? t * t / middle : 1.0f - (1.0f - t) * (1.0f - t) / (1.0f - middle);
}

// Adds `power` along a triangle that is thinner than areas of spots can tell, spot by spot (Amanatides and Woo, A Fast
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
  float2 spot = floor(from);
  const float2 last = floor(from + along);
  const float2 step = (float2)(along.x < 0.0f ? -1.0f : 1.0f, along.y < 0.0f ? -1.0f : 1.0f);
  const float2 size = 1.0f / fmax(fabs(along), (float2)(1e-9f));
  float2 next = (step * (spot - from) + (float2)(along.x < 0.0f ? 0.0f : 1.0f, along.y < 0.0f ? 0.0f : 1.0f)) * size;
  const uint borders = (uint)(fabs(last.x - spot.x) + fabs(last.y - spot.y));
  float done = 0.0f;
  for (uint border = 0; border <= borders; ++border) {
    const float share = border < borders ? share_below(clamp(min(next.x, next.y), 0.0f, 1.0f), middle) : 1.0f;
    add_to_spot(tile, plane, max(share - done, 0.0f) * power, spot + 0.5f);
    done = max(share, done);
    if (next.x < next.y) {
      spot.x += step.x;
      next.x += size.x;
    } else {
      spot.y += step.y;
      next.y += size.y;
    }
  }
}

FUNCTION float least_of(const float8 v) {
  const float4 of_four = fmin(v.lo, v.hi);
  const float2 of_two = fmin(of_four.lo, of_four.hi);
  return min(of_two.x, of_two.y);
}

// Adds `power` times `scales` of triangles a, b, c and a, c, d by their areas in each spot.
FUNCTION void draw_triangles(const Tile tile, const float4 plane, const float3 power, const float2 scales, const float2 a,
                             const float2 b, const float2 c, const float2 d) {
  const float2 low = fmin(fmin(a, b), fmin(c, d));
  const float2 high = fmax(fmax(a, b), fmax(c, d));
  // From the tile's corner, where numbers are small.
  const float2 origin = (float2)((float)tile.left, (float)tile.top);
  const float8 from_x = (float8)(a.x, b.x, c.x, d.x, a.x, a.x, a.x, a.x) - origin.x;
  const float8 from_y = (float8)(a.y, b.y, c.y, d.y, a.y, a.y, a.y, a.y) - origin.y;
  const float8 to_x = (float8)(b.x, c.x, d.x, a.x, c.x, a.x, a.x, a.x) - origin.x;
  const float8 to_y = (float8)(b.y, c.y, d.y, a.y, c.y, a.y, a.y, a.y) - origin.y;
  const float2 twice_area =
      (float2)((from_x.s1 - from_x.s0) * (from_y.s2 - from_y.s0) - (from_y.s1 - from_y.s0) * (from_x.s2 - from_x.s0),
               (from_x.s2 - from_x.s0) * (from_y.s3 - from_y.s0) - (from_y.s2 - from_y.s0) * (from_x.s3 - from_x.s0));
  const float longest = max(high.x - low.x, high.y - low.y);
  // Those thinner than areas of spots can tell are lines.
  const int2 has_area = fabs(twice_area) > 2e-3f * longest;
  if (!has_area.x) draw_line(tile, plane, 0.5f * scales.x * power, a, b, c);
  if (!has_area.y) draw_line(tile, plane, 0.5f * scales.y * power, a, c, d);
  if (!any(has_area)) return;
  const float2 densities = has_area ? scales / twice_area : (float2)(0.0f);
  // Of the edges, the last of them both triangles'.
  const float8 density = (float8)(densities.x, densities.x, densities.y, densities.y, densities.y - densities.x, 0.0f, 0.0f, 0.0f);
  const float8 height = to_y - from_y;
  const float8 slope = height == 0.0f ? (float8)(0.0f) : (to_x - from_x) / height;
  const float2 size = (float2)((float)(tile.right - tile.left), (float)(tile.bottom - tile.top));
  const float16 from_x2 = joined8(from_x, from_x);
  const float16 from_y2 = joined8(from_y, from_y);
  const float16 to_x2 = joined8(to_x, to_x);
  const float16 to_y2 = joined8(to_y, to_y);
  const float16 slope2 = joined8(slope, slope);
  const float16 low_x = fmin(from_x2, to_x2);
  const float16 high_x = fmax(from_x2, to_x2);
  const float16 density2 = joined8(density, density);
  const int end_row = (int)clamp(high.y - origin.y + 1.0f, 0.0f, size.y);
  // Two rows at a time, the second of which may be another tile's.
  for (int row = (int)clamp(low.y - origin.y, 0.0f, size.y); row < end_row; row += 2) {
    const float16 above = (float)row + joined8((float8)(0.0f), (float8)(1.0f));
    const float16 start = clamp(from_y2, above, above + 1.0f);
    const float16 end = clamp(to_y2, above, above + 1.0f);
    const float16 x_start = clamp(from_x2 + (start - from_y2) * slope2, low_x, high_x);
    const float16 x_end = end == to_y2 ? to_x2 : clamp(from_x2 + (end - from_y2) * slope2, low_x, high_x);
    const int16 passes = start != end;
    const float16 left = fmin(x_start, x_end);
    const float16 right = fmax(x_start, x_end);
    const float16 inverse = 1.0f / fmax(right - left, (float16)(1e-9f));
    const float16 weight = density2 * (end - start);
    const float16 firsts = passes ? left : (float16)(INFINITY);
    const float16 lasts = passes ? -right : (float16)(INFINITY);
    const int first = (int)clamp(least_of(fmin(firsts.lo, firsts.hi)), 0.0f, size.x) / SPOTS * SPOTS;
    const int last = (int)clamp(1.0f - least_of(fmin(lasts.lo, lasts.hi)), 0.0f, size.x);
    for (int column = first; column < last; column += SPOTS) {
      const float8 left_sides = (float8)(0.0f, 1.0f, 2.0f, 3.0f, 0.0f, 1.0f, 2.0f, 3.0f) + (float)column;
      float8 share = 0.0f;
#define ADD_EDGE(k, l)                                                                                                 \
  share += joined4((float4)(weight.k), (float4)(weight.l)) *                                                           \
           share_left_of(joined4((float4)(left.k), (float4)(left.l)), joined4((float4)(right.k), (float4)(right.l)),   \
                         joined4((float4)(inverse.k), (float4)(inverse.l)), left_sides)
      ADD_EDGE(s0, s8);
      ADD_EDGE(s1, s9);
      ADD_EDGE(s2, sa);
      ADD_EDGE(s3, sb);
      ADD_EDGE(s4, sc);
#undef ADD_EDGE
      add_to_spots(tile, plane, power, share.lo, tile.left + column, tile.top + row);
      if (row + 1 < end_row) add_to_spots(tile, plane, power, share.hi, tile.left + column, tile.top + row + 1);
    }
  }
}

// The integral of a tent of area 1 from -1 to 1 up to t.
FUNCTION float4 tent_below(const float4 t) {
  const float4 rising = clamp(1.0f + t, 0.0f, 1.0f);
  const float4 falling = clamp(t, 0.0f, 1.0f);
  return 0.5f * rising * rising + falling * (1.0f - 0.5f * falling);
}

FUNCTION void draw_tent(const Tile tile, const float4 plane, const float3 power, const float2 middle,
                        const float2 half_width) {
  const int first_row = max((int)floor(max(middle.y - half_width.y, -1.0f)), tile.top);
  const int last_row = min((int)ceil(min(middle.y + half_width.y, 1e6f)), tile.bottom);
  const int first_column = tile.left + max((int)floor(clamp(middle.x - half_width.x, 0.0f, 1e6f)) - tile.left, 0) / SPOTS * SPOTS;
  const int last_column = min((int)ceil(min(middle.x + half_width.x, 1e6f)), tile.right);
  for (int y = first_row; y < last_row; ++y) {
    const float4 borders = tent_below(((float)y + (float4)(0.0f, 1.0f, 0.0f, 0.0f) - middle.y) / half_width.y);
    const float in_row = borders.y - borders.x;
    for (int x = first_column; x < last_column; x += SPOTS) {
      const float4 left = ((float4)(0.0f, 1.0f, 2.0f, 3.0f) + ((float)x - middle.x)) / half_width.x;
      add_to_spots(tile, plane, power, in_row * (tent_below(left + 1.0f / half_width.x) - tent_below(left)), x, y);
    }
  }
}

BODY draw_run(const Tile tile, const uint count, __global const float* restrict rows, __global const float* restrict boxes) {
  const float4 sides = (float4)((float)tile.left, (float)tile.top, (float)tile.right, (float)tile.bottom);
  for (uint i = 0; i < count; ++i) {
    if (i % PATCH_BLOCK == 0) {
      const float4 box = vload4(i / PATCH_BLOCK, boxes);
      if (any(box.lo >= sides.hi) || any(box.hi <= sides.lo)) {
        i += PATCH_BLOCK - 1;
        continue;
      }
    }
    __global const float* row = rows + PATCH_ROW * i;
    const float8 corners = vload8(0, row + PATCH_CORNER);
    const float3 power = vload3(0, row + PATCH_POWER);
    const float2 scales = vload2(0, row + PATCH_SCALE);
    const float4 plane = vload4(0, row + PATCH_NORMAL);
    if (scales.y == PATCH_TENT) {
      if (!tile.is_one || shows_plane(tile, plane, tile.left, tile.top))
        draw_tent(tile, plane, scales.x * power, corners.s01, corners.s23);
      continue;
    }
    const float2 low = fmin(fmin(corners.s01, corners.s23), fmin(corners.s45, corners.s67));
    const float2 high = fmax(fmax(corners.s01, corners.s23), fmax(corners.s45, corners.s67));
    if (any(low >= sides.hi) || any(high <= sides.lo)) continue;
    if (tile.is_one && !shows_plane(tile, plane, tile.left, tile.top)) continue;
    if (all(floor(low) == floor(high)))
      add_to_spot(tile, plane, 0.5f * (scales.x + scales.y) * power, low);
    else
      draw_triangles(tile, plane, power, scales, corners.s01, corners.s23, corners.s45, corners.s67);
  }
}

// Adds n_runs runs of patches to tiles of `tile_size` spots' side, row by row of tiles. `tile_size` and the rows' pitch are
// multiples of SPOTS, and tile_size one of detail.
KERNEL void draw_patches(__global const CameraData* camera, const uint n_runs, const uint run_length, const uint tile_size,
                         __global const float* rows, __global const float* boxes, __global const PatchRunData* reports,
                         const ViewLayout layout, __global const float* planes, __global float* irradiance) {
  const uint across = (camera->width * layout.detail + tile_size - 1u) / tile_size;
  const uint down = (camera->height * layout.detail + tile_size - 1u) / tile_size;
  const uint i = get_global_id(0);
  if (i >= across * down) return;
  Tile tile;
  tile.left = (int)(i % across * tile_size);
  tile.top = (int)(i / across * tile_size);
  tile.right = min(tile.left + (int)tile_size, (int)layout.pitch);
  tile.bottom = min(tile.top + (int)tile_size, (int)(camera->height * layout.detail));
  tile.width = camera->width;
  tile.layout = layout;
  tile.planes = planes;
  tile.irradiance = irradiance;
  // One plane all over is asked once for each patch.
  const uint first = (uint)tile.top / layout.detail * tile.width + (uint)tile.left / layout.detail;
  __global const float* shown = planes + first;
  const uint stride = layout.plane_stride;
  const float4 plane = (float4)(shown[VIEW_NORMAL * stride], shown[(VIEW_NORMAL + 1) * stride],
                                shown[(VIEW_NORMAL + 2) * stride], shown[VIEW_OFFSET * stride]);
  const int right = min(tile.right, (int)(tile.width * layout.detail));
  int is_one = 1;
  int is_any = 0;
  for (int y = tile.top; y < tile.bottom; y += (int)layout.detail)
    for (int x = tile.left; x < right; x += (int)layout.detail) {
      const float normal = planes[(uint)y / layout.detail * tile.width + (uint)x / layout.detail];
      is_one &= shows_plane(tile, plane, x, y);
      is_any |= normal == normal;
    }
  tile.is_one = is_one;
  if (!is_any) return;
  for (uint run = 0; run < n_runs; ++run)
    draw_run(tile, reports[run].rows, rows + (ulong)run * PATCH_ROW * patches_stride(run_length),
             boxes + 4u * run * patch_boxes(run_length));
}
