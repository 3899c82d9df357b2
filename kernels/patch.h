// Patches: what photons that are neighbours on a lattice of emission, and went one way, light up between them where they land.
// The picture of the receiver takes them by area: a triangle of a patch has the power that left the light in it, and a pixel
// the share of that which lies within it. Heckbert and Hanrahan, Beam Tracing Polygonal Objects, 1984; Watt, Light-Water
// Interaction Using Backward Beam Tracing, 1990. Nothing is blurred by it, so that its error falls faster than that of
// kernels about each photon (footprint.h), which are for what is not seen directly.
//
// It is taken in square spots, of which a pixel has `detail` along each side: 1 where the receiver's reflectance is one, else
// more, since the product of both is wanted and not that of their means.
//
// Rows of patches, by runs of photons, field f of row i of a run at [PATCH_ROW * i + f].
#ifndef VITRUM_PATCH_H
#define VITRUM_PATCH_H

#include "portability.h"

#define PATCH_CORNER 0         // x and y of four corners in turn [spots]; of a tent: its middle, then its half widths
#define PATCH_POWER 8          // 3 floats [W]
#define PATCH_SCALE 11         // of triangles (0, 1, 2) and (0, 2, 3): their area in the picture by their area [spots / m2]
#define PATCH_NORMAL 13        // 3 floats: of the receiver, to the side that is lit
#define PATCH_OFFSET 16        // the receiver's plane along it [m]
#define PATCH_FIELDS 17
#define PATCH_ROW 20u
#define PATCH_TENT -1.0f       // PATCH_SCALE + 1 of a photon by itself, which is spread over a tent

// A photon on a lattice may leave a patch and what of it is torn off, another is a tent: of four neighbours in a column, three
// may leave 3 rows, and the one that branches by the lattice 9.
FUNCTION uint patches_stride(uint run_length) { return 5u * run_length + 16u; }
#define PATCH_BLOCK 16u        // rows that have a box in common: {low x, low y, high x, high y}
FUNCTION uint patch_boxes(uint run_length) { return (patches_stride(run_length) + PATCH_BLOCK - 1u) / PATCH_BLOCK; }

typedef struct {
  uint rows;
  uint too_many;               // 1: there was no room for some, since many reach behind the eye and are cut
} PatchRunData;

// The plane that a pixel shows all over, field f of pixel i at [f * stride + i].
#define VIEW_NORMAL 0          // 3 floats, to the side that is seen; NaN: not one plane, or no plain surface
#define VIEW_OFFSET 3          // along it [m]
#define VIEW_TOLERANCE 4       // how far off places on it may be for their roundings [m]
#define VIEW_FIELDS 5
#define VIEW_SAME_NORMAL 0.9999f  // cosine between normals of one plane

// Where pixels and spots lie in their buffers.
typedef struct {
  uint detail;                 // spots along a pixel's side: 1, 2 or 4
  uint plane_stride;           // of fields of pixels
  uint pitch;                  // of rows of spots
  uint spot_stride;            // of red, green and blue
} ViewLayout;

#ifdef __OPENCL_VERSION__
#include "switches.h"
#include "scene.h"

// A kernel that shows what was drawn lists `PATCH_VIEW_PARAMETERS` and starts with `const PatchView view = PATCH_VIEW;`. The
// host sets the arguments in the same order (src/render/patch_view.cpp).
#if HAS_PATCHES
#define PATCH_VIEW_PARAMETERS , const ViewLayout view_layout, __global const float *view_planes, __global const float *spots
#define PATCH_VIEW { view_layout, view_planes, spots }
typedef struct {
  ViewLayout layout;
  __global const float* planes;
  __global const float* spots;         // their irradiance, 3 planes [W/m2]
} PatchView;

// What pixels show all over.
typedef struct {
  Vec3 normal;                 // NaN: not one plane
  Float offset, tolerance;
} ShownPlane;

FUNCTION ShownPlane plane_shown(const PatchView view, const Uint pixel) {
  const uint stride = view.layout.plane_stride;
  ShownPlane shown;
  shown.normal = make_vec3(GATHER(Float, view.planes, pixel), GATHER(Float, view.planes + stride, pixel),
                           GATHER(Float, view.planes + 2 * stride, pixel));
  shown.offset = GATHER(Float, view.planes + VIEW_OFFSET * stride, pixel);
  shown.tolerance = GATHER(Float, view.planes + VIEW_TOLERANCE * stride, pixel);
  return shown;
}

// At (x, y) from 0 to 1 in pixels.
FUNCTION Vec3 irradiance_shown(const PatchView view, const Uint column, const Uint row, const Float x, const Float y) {
  const uint detail = view.layout.detail;
  const uint stride = view.layout.spot_stride;
  const Uint spot_column = column * detail + AS_UINT(TO_INT(x * (float)detail));
  const Uint spot = (row * detail + AS_UINT(TO_INT(y * (float)detail))) * view.layout.pitch + spot_column;
  return make_vec3(GATHER(Float, view.spots, spot), GATHER(Float, view.spots + stride, spot),
                   GATHER(Float, view.spots + 2 * stride, spot));
}

FUNCTION Mask is_on(const ShownPlane* shown, const Vec3 place, const Vec3 normal) {
  return (dot3(shown->normal, normal) > VIEW_SAME_NORMAL) & (fabs(dot3(shown->normal, place) - shown->offset) <= shown->tolerance);
}
#else
typedef struct {
  uint detail;                 // 0: there are no patches
} PatchView;
#define PATCH_VIEW_PARAMETERS
#define PATCH_VIEW { 0 }
#endif
#endif

#endif
