// Patches: what photons that are neighbours on a lattice of emission, and went one way, light up between them where they land.
// The picture of the receiver takes them by area: a triangle of a patch has the power that left the light in it, and a pixel
// the share of that which lies within it. Heckbert and Hanrahan, Beam Tracing Polygonal Objects, 1984; Watt, Light-Water
// Interaction Using Backward Beam Tracing, 1990. Nothing is blurred by it, so that its error falls faster than that of
// kernels about each photon (footprint.h), which are for what is not seen directly.
//
// Rows of patches, by runs of photons, field f of row i of a run at [PATCH_ROW * i + f].
#ifndef VITRUM_PATCH_H
#define VITRUM_PATCH_H

#include "portability.h"

#define PATCH_CORNER 0         // x and y of four corners in turn [pixels]; of a tent: its middle, then its half widths
#define PATCH_POWER 8          // 3 floats [W]
#define PATCH_SCALE 11         // of triangles (0, 1, 2) and (0, 2, 3): their area in the picture by their area [pixels / m2]
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
  uint behind;                 // 1: there is one in view that reaches behind the eye
} PatchRunData;

// The plane that a pixel shows all over, field f of pixel i at [f * stride + i].
#define VIEW_NORMAL 0          // 3 floats, to the side that is seen; NaN: not one plane, or no plain surface
#define VIEW_OFFSET 3          // along it [m]
#define VIEW_TOLERANCE 4       // how far off places on it may be for their roundings [m]
#define VIEW_FIELDS 5

#ifdef __OPENCL_VERSION__
#include "switches.h"
#include "scene.h"

// A kernel that shows what was drawn lists `PATCH_VIEW_PARAMETERS` and starts with `const PatchView view = PATCH_VIEW;`. The
// host sets the arguments in the same order (src/render/patch_view.cpp).
#if CAUSTICS == CAUSTICS_FOOTPRINTS
typedef struct {
  uint pitch;                  // of the picture's rows
  uint stride;                 // of planes of it
  __global const float* planes;
  __global const float* irradiance;    // 3 planes [W/m2]
} PatchView;
#define PATCH_VIEW_PARAMETERS                                                                                          \
  , const uint view_pitch, const uint view_stride, __global const float *view_planes, __global const float *view_irradiance
#define PATCH_VIEW { view_pitch, view_stride, view_planes, view_irradiance }

// What pixels show all over.
typedef struct {
  Vec3 normal;                 // NaN: not one plane
  Float offset, tolerance;
  Vec3 irradiance;
} ShownPlane;

FUNCTION ShownPlane plane_shown(const PatchView view, const Uint column, const Uint row) {
  const Uint i = row * view.pitch + column;
  ShownPlane shown;
  shown.normal = make_vec3(GATHER(Float, view.planes, i), GATHER(Float, view.planes + view.stride, i),
                           GATHER(Float, view.planes + 2 * view.stride, i));
  shown.offset = GATHER(Float, view.planes + VIEW_OFFSET * view.stride, i);
  shown.tolerance = GATHER(Float, view.planes + VIEW_TOLERANCE * view.stride, i);
  shown.irradiance = make_vec3(GATHER(Float, view.irradiance, i), GATHER(Float, view.irradiance + view.stride, i),
                               GATHER(Float, view.irradiance + 2 * view.stride, i));
  return shown;
}

FUNCTION Mask is_on(const ShownPlane* shown, const Vec3 place, const Vec3 normal) {
  return (dot3(shown->normal, normal) > 0.9999f) & (fabs(dot3(shown->normal, place) - shown->offset) <= shown->tolerance);
}
#else
typedef struct {
  uint pitch;                  // 0: there are no patches
} PatchView;
#define PATCH_VIEW_PARAMETERS
#define PATCH_VIEW { 0 }
#endif
#endif

#endif
