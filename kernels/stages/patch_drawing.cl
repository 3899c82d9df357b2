// Stage patch_drawing: patches (patch.h) into the picture, by area.
// Reads: rows of patches, the planes that the picture shows. Adds to: the irradiance of spots that show a plane.
#include "patch.h"

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
  return along > VIEW_SAME_NORMAL && fabs(shown[VIEW_OFFSET * stride] - plane.w) <= shown[VIEW_TOLERANCE * stride];
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

FUNCTION float least16(const float16 v) { return least8(fmin(v.lo, upper8(v))); }

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
    const int first = (int)clamp(least16(firsts), 0.0f, size.x) / SPOTS * SPOTS;
    const int last = (int)clamp(1.0f - least16(lasts), 0.0f, size.x);
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
