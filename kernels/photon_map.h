// The photon map: photons as they are stored, and the grid that they are sorted into.
//
// As they are stored, each run (stages/photons.cl) has a piece of a buffer of its own, field f of photon i of run r at
// [photon_in_run(run_length, r, f) + i].
//
// The map is divided into buckets of 2^bucket_shift neighbouring cells, each with room of its own, in which it is
// sorted. Until then its photons are rows of PHOTON_ROW floats; then they are in blocks of MAP_BLOCK, field by field in
// each, so that neighbours are read at once and are near each other in memory: field f of photon i of the bucket is at
// [MAP_BLOCK * start + map_place(i, f, fields)]. The last one fills up its block. Where a cell starts in its bucket is
// at first_of_cell[cell + bucket], since each bucket has one more entry: where its last cell ends.
//
// The grid wraps around: cell (ix, iy, iz) modulo its size, a power of two along each axis. So it needs no bounds, and
// far photons cost nothing but a failed test of distance. Cells are a radius wide along y and z, and half of it along
// x, where neighbours follow each other in memory; a row has at least 16 of them, and so has a bucket. Of the 3 x 3
// rows of cells around a place each is visited once, also where the grid has fewer.
//
// With footprints, cells are cubes, and a photon in the map has a kernel of its own, a tent over a parallelogram
// (footprint.h): rows and fields are those of MAP_ROW and MAP_FIELDS then, and power is in W/m2. A large footprint is
// cut into several, and each is an entry of all cells that it reaches into. What a run stores is where photons arrived.
//
// For the k nearest, photons are in a tree instead, eight in a leaf and eight children at a node: field f of photon j
// of leaf i at [(i * PHOTON_FIELDS + f) * 8 + j]. The tree is left-balanced (Jensen 2001, section 4.5.2), so that it
// needs no pointers: the children of node i of a level are 8 i to 8 i + 7 of the level below, level 0 the leaves.
#ifndef VITRUM_PHOTON_MAP_H
#define VITRUM_PHOTON_MAP_H

#include "portability.h"

#define PHOTON_X 0
#define PHOTON_Y 1
#define PHOTON_Z 2
#define PHOTON_DIRECTION 3     // uint: packed
#define PHOTON_POWER 4         // 3 floats [W]
#define PHOTON_FIELDS 7
#define PHOTON_CELL 7          // uint: of the grid; for the sort
#define PHOTON_ROW 8
// With footprints, in the map:
#define FOOTPRINT_U 7          // 3 floats [1/m]: across the parallelogram's first side, from -1 to 1 where the tent ends
#define FOOTPRINT_V 10         // 3 floats [1/m]: and its second
#define FOOTPRINT_FLAGS 13     // uint: level, and IN_OTHER_CELL
#define FOOTPRINT_FIELDS 14
#define FOOTPRINT_CELL 15
#define FOOTPRINT_ROW 16
// Where patches are drawn (patch.h), in a run:
#define ARRIVED_POINT 7        // uint: of the lattice of emission; NO_POINT: none
#define ARRIVED_NORMAL 8       // 3 floats
#define ARRIVED_SPACING 11     // how much farther than all photons those are apart that went its way by chance
#define ARRIVED_CELL 12        // uint: of the grid, as PHOTON_CELL; for the sort
#define ARRIVED_FIELDS 13
#define ARRIVED_ROW 16
#define NO_POINT 0xffffffffu
// Where a point of the lattice arrived, at [LANDING_ROW * point]: its place (3 floats), and
#define LANDING_WAY 3          // uint: hash of its way; 0: it did not arrive
#define LANDING_POWER 4        // 3 floats [W]
#define LANDING_ROW 8u

#ifdef __OPENCL_VERSION__
#include "switches.h"
#if CAUSTICS == CAUSTICS_FOOTPRINTS
#define MAP_FIELDS FOOTPRINT_FIELDS
#define MAP_CELL FOOTPRINT_CELL
#define MAP_ROW FOOTPRINT_ROW
#else
#define MAP_FIELDS PHOTON_FIELDS
#define MAP_CELL PHOTON_CELL
#define MAP_ROW PHOTON_ROW
#endif
#if HAS_PATCHES
#define RUN_CELL ARRIVED_CELL
#define RUN_FIELDS ARRIVED_FIELDS
#define RUN_ROW ARRIVED_ROW
#else
#define RUN_CELL PHOTON_CELL
#define RUN_FIELDS PHOTON_ROW
#define RUN_ROW PHOTON_ROW
#endif
#endif

// Footprints that are large are listed by larger cells, level by level, so that few cells list each. All levels share
// the grid, the cells of a place a quarter of it away from those of the level below, where there is less of a crowd; an
// entry's flags tell which level it is of, and the entry of the cell about its own middle from its others.
#define LEVELS 4u
#define LEVEL_RATIO 4.0f
FUNCTION float level_scale(uint level) { return (float)(1u << 2u * level); }
#define IN_OTHER_CELL 0x80000000u

#define MAP_BLOCK 16u          // photons; a bucket starts at so many floats, too
FUNCTION uint map_place(uint photon, uint field, uint fields) {
  return (photon / MAP_BLOCK * fields + field) * MAP_BLOCK + photon % MAP_BLOCK;
}
typedef struct {
  uint start;                  // of its photons, in floats / MAP_BLOCK
  // Boxes around its photons [m] and around their packed directions; not with footprints.
  float low[3], high[3];
  float low_direction[3], high_direction[3];
} BucketData;
// Floats of a sorted bucket.
FUNCTION uint map_floats(uint photons, uint fields) { return (photons + MAP_BLOCK - 1u) / MAP_BLOCK * MAP_BLOCK * fields; }

// A run may store two photons for each that it shoots, since one may branch off; on a lattice, where up to five do at
// one in sixteen, but at every fourth of a column, it is three. And there is room for a packet beyond, so that packets
// may be written whole.
FUNCTION uint photons_stride(uint run_length) { return 3u * run_length + 16u; }
// `row`: PHOTON_ROW, or ARRIVED_ROW where patches are drawn.
FUNCTION ulong photon_in_run(uint run_length, uint run, uint field, uint row) {
  return ((ulong)run * row + field) * photons_stride(run_length);
}

// A lattice of emission: its points are at (column + shift_u) / columns, (row + shift_v) / rows of the unit square,
// numbered column by column; the number of rows is a power of two.
typedef struct {
  uint columns;                // 0: there is no lattice
  uint log2_rows;              // at least BRANCH_LOG2
  float shift_u, shift_v;      // in [0, 1)
} LatticeData;

// Of every fourth row and column, two lattices of what branches off the photons there, numbered in the same way one
// after the other behind the whole lattice.
#define BRANCH_LOG2 2u
#define BRANCH_STEP 4.0f
FUNCTION uint lattice_points(LatticeData lattice) { return lattice.columns << lattice.log2_rows; }
FUNCTION uint branch_columns(LatticeData lattice) { return (lattice.columns + (1u << BRANCH_LOG2) - 1u) >> BRANCH_LOG2; }
FUNCTION uint branch_points(LatticeData lattice) {
  return lattice.columns == 0u ? 0u : branch_columns(lattice) << (lattice.log2_rows - BRANCH_LOG2);
}

// How large footprints may be.
typedef struct {
  float eye[3];                // of the camera [m]
  float sharpness;             // least size by distance from the eye: what lies between two samples of a pixel
  float largest;               // sides beyond that are cut [m]
} FootprintLimits;

// Cell size [m] as its inverse, along x and along y and z; log2 of the number of cells along each axis, and of those in
// a bucket.
#define CELLS_ALONG_X 2        // to one along y or z; not with footprints
#define LEAST_LOG2_BUCKET 4u   // of a row too: the cells of one that are looked at are in two ranges at most
typedef struct {
  float inverse_cell_x, inverse_cell;
  uint log2_x, log2_y, log2_z;
  uint bucket_shift;
} GridData;

// A node: for each child, the box around its photons and that around their packed directions; row r of child j at
// [(node * PHOTON_NODE_ROWS + r) * 8 + j]. The box of a child that is not there is empty: low above high.
#define PHOTON_NODE_LOW 0            // x, y, z [m]
#define PHOTON_NODE_HIGH 3
#define PHOTON_NODE_LOW_DIRECTION 6  // x, y, z, in steps of packed_direction
#define PHOTON_NODE_HIGH_DIRECTION 9
#define PHOTON_NODE_ROWS 12
#define PHOTON_TREE_LEVELS 10        // enough for 2^30 photons
#define PHOTON_OFF_TREE 1e30f        // coordinates of the photons that fill up the last leaf

// Level `top` is the root alone; the nodes of level l > 0 start at first_node[l].
typedef struct {
  uint top;
  uint first_node[PHOTON_TREE_LEVELS];
} PhotonTreeData;

// The largest k of the k nearest.
#define MAX_NEAREST 64

#ifdef __OPENCL_VERSION__

// Far away, cells are told apart no longer, which only makes candidates.
FUNCTION int cell_coordinate(float x, float inverse_cell) {
  const float cell = clamp(x * inverse_cell, -1e9f, 1e9f);
  const int towards_zero = (int)cell;  // PoCL's floor of a scalar is slow
  return towards_zero - ((float)towards_zero > cell);
}
FUNCTION Uint cell_coordinates(Float x, float inverse_cell) {
  const Float cell = floor(x * inverse_cell);
  return AS_UINT(TO_INT(cell > 1e9f ? 1e9f : cell < -1e9f ? -1e9f : cell));
}

// The first cell of a row; coordinates are uints of any width.
#define ROW_OF_CELLS(grid, iy, iz)                                                                   \
  (((((iz) & ((1u << (grid).log2_z) - 1u)) << (grid).log2_y) | ((iy) & ((1u << (grid).log2_y) - 1u))) \
   << (grid).log2_x)

FUNCTION uint cell_of_level(const GridData grid, uint level, int ix, int iy, int iz) {
  const uint x = ((uint)ix + (level << grid.log2_x >> 2)) & ((1u << grid.log2_x) - 1u);
  const uint y = (uint)iy + (level << grid.log2_y >> 2);
  const uint z = (uint)iz + (level << grid.log2_z >> 2);
  return ROW_OF_CELLS(grid, y, z) | x;
}

FUNCTION Uint cells_of(const GridData grid, const Vec3 p) {
  const Uint ix = cell_coordinates(p.x, grid.inverse_cell_x) & ((1u << grid.log2_x) - 1u);
  const Uint iy = cell_coordinates(p.y, grid.inverse_cell);
  const Uint iz = cell_coordinates(p.z, grid.inverse_cell);
  return ROW_OF_CELLS(grid, iy, iz) | ix;
}

// Steps to the first and to the last of the cells around one along an axis of 2^log2 cells, each cell once.
FUNCTION int first_neighbour(uint log2) { return log2 >= 2 ? -1 : 0; }
FUNCTION int last_neighbour(uint log2) { return log2 >= 1 ? 1 : 0; }

// Unit directions in 10 bits a component, enough to tell which side of a surface they come from.
FUNCTION Uint packed_component(Float x) { return AS_UINT(TO_INT(rint(x * 511.0f))) & 1023u; }
FUNCTION Uint packed_direction(const Vec3 d) {
  return packed_component(d.x) | packed_component(d.y) << 10 | packed_component(d.z) << 20;
}
// A component of packed directions, int or of any width.
#define DIRECTION_X(packed) ((packed) << 22 >> 22)
#define DIRECTION_Y(packed) ((packed) << 12 >> 22)
#define DIRECTION_Z(packed) ((packed) << 2 >> 22)

// A photon counts for a surface if it came to the surface's front, and lies within this share of the radius off its
// plane: on curved surfaces and in corners, the rest lies on something else.
#define PLANE_SHARE 0.25f
// The same for footprints, of both planes, whose cells it makes thicker.
#define FOOTPRINT_OFF_PLANE 0.125f

#endif

#endif
