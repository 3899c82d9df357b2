// Stage patches: the caustic where its receiver is seen directly (patch.h), as patches in the picture; patch_drawing.cl draws them.
// Reads: the scene and the camera; runs of photons, and where the points of the lattice landed. Writes: the planes that the
// picture shows; rows of patches.
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
      // By what of the light each triangle is, by area of the disc of emission, of which a point stands for pi over their number.
      const Float u0 = lies.step * TO_FLOAT(AS_INT(lies.column));
      const Float v0 = lies.step * TO_FLOAT(AS_INT(lies.row));
      const DiscPlace p = place_in_disc(lattice, u0, v0);
      const DiscPlace p_u = place_in_disc(lattice, u0 + lies.step, v0);
      const DiscPlace p_uv = place_in_disc(lattice, u0 + lies.step, v0 + lies.step);
      const DiscPlace p_v = place_in_disc(lattice, u0, v0 + lies.step);
      const Vec3 sum = add3(add3(scale3(1.0f / p.weight, power), scale3(1.0f / p_u.weight, side[0].power)),
                            add3(scale3(1.0f / p_uv.weight, opposite_power), scale3(1.0f / p_v.weight, side[2].power)));
      values[PATCH_POWER + 0] = 0.25f * sum.x;
      values[PATCH_POWER + 1] = 0.25f * sum.y;
      values[PATCH_POWER + 2] = 0.25f * sum.z;
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
      const Float side = side_alone(limits, on_lattice, spacing) / seen.depth;
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
              photons + photon_in_run(run_length, run, 0, RUN_ROW), landings, lattice, limits,
              rows + (ulong)i * PATCH_ROW * patches_stride(run_length), boxes + 4u * i * patch_boxes(run_length),
              &reports[i]);
}
