// What checks/geometry.cl takes and gives. Host and device compile the same text.
#ifndef VITRUM_GEOMETRY_TYPES_H
#define VITRUM_GEOMETRY_TYPES_H

// Where rays come from and what they aim at: points of edges, or the ball about the mesh.
typedef struct {
  float centre[3];             // of the mesh
  float distance;              // [m] from the point aimed at; 0: from inside
  float slant;                 // how far rays from outside come from aside: .7: within 45 degrees, 5: mostly grazing, 50: all
  float spread;                // [m], edges: rays pass them by at most so much; else the radius of the ball aimed at
  uint tangential;             // 1: aside is along the tangent, so that a large slant makes all of them graze
  uint crossings;              // of the surface that a chain may have: 2 straight through a convex mesh
  uint edges;                  // 1: edges, every eighth time their ends
  uint seed;
} AimData;

// What a work-item found.
typedef struct {
  uint rays;
  uint wrong;                  // rays that missed, or chains that were in the wrong medium
  uint events;                 // surfaces met
  uint sum;                    // of a hash of every hit, in any order
  float origin[3], direction[3];  // of the first ray that went wrong
} GeometryResult;

#endif
