// kernels/footprint.h by itself, for the tests: each lane of a work-item a photon that arrived. Reads `in`, writes
// `out`: fields of `count` floats that follow each other. `count` is a multiple of WIDTH.
#include "footprint.h"

#define INPUT(field) LOAD(in + (field) * count, i)
#define OUTPUT(field, value) STORE(out + (field) * count, i, value)
#define OUTPUT3(field, vector) OUTPUT(field, (vector).x), OUTPUT((field) + 1, (vector).y), OUTPUT((field) + 2, (vector).z)

KERNEL void footprints(const LatticeData lattice, const FootprintLimits limits, __global const float* landings,
                       __global const float* in, __global float* out, const uint count) {
  const uint i = get_global_id(0) * WIDTH;
  if (i >= count) return;
  const Footprint f = footprint_of(lattice, landings, limits, AS_UINT(INPUT(0)), INPUT(1),
                                   make_vec3(INPUT(2), INPUT(3), INPUT(4)), make_vec3(INPUT(5), INPUT(6), INPUT(7)));
  OUTPUT3(0, f.side_u);
  OUTPUT3(3, f.side_v);
  OUTPUT3(6, f.across_u);
  OUTPUT3(9, f.across_v);
  OUTPUT(12, f.area);
  OUTPUT(13, TO_FLOAT(AS_INT(f.parts_u)));
  OUTPUT(14, TO_FLOAT(AS_INT(f.parts_v)));
  OUTPUT(15, TO_FLOAT(AS_INT(f.level)));
}
