// kernels/fresnel.cl by itself, for `vitrum verify` and the tests: each lane of a work-item one input. Reads `in`, writes
// `out`: fields of `count` floats that follow each other. `count` is a multiple of WIDTH.
#include "fresnel.cl"

#define INPUT(field) LOAD(in + (field) * (ulong)count, i)
#define OUTPUT(field, value) STORE(out + (field) * (ulong)count, i, value)

KERNEL void border(__global const float* in, __global float* out, const uint count) {
  const uint i = get_global_id(0) * WIDTH;
  if (i >= count) return;
  Interface b;
  b.eta = INPUT(0);
  b.eta_inverse = INPUT(1);
  b.k_hi = INPUT(2);
  b.k_lo = INPUT(3);
  const Vec3 direction = make_vec3(INPUT(5), INPUT(6), INPUT(7)), normal = make_vec3(INPUT(8), INPUT(9), INPUT(10));
  const Fresnel f = fresnel(b, INPUT(4));
  const Vec3 refracted = refracted_direction(b, f, direction, normal);
  const Vec3 reflected = reflected_direction(direction, normal);
  OUTPUT(0, f.R);
  OUTPUT(1, f.T);
  OUTPUT(2, f.r_perp);
  OUTPUT(3, f.r_par);
  OUTPUT(4, f.bend);
  OUTPUT(5, f.total ? (Float)1.0f : (Float)0.0f);
  OUTPUT(6, refracted.x);
  OUTPUT(7, refracted.y);
  OUTPUT(8, refracted.z);
  OUTPUT(9, reflected.x);
  OUTPUT(10, reflected.y);
  OUTPUT(11, reflected.z);
}

// R and T of the border {eta, 1 / eta, k_hi, k_lo} at the cosines whose bits are first, first + 1, ...
KERNEL void cosines(const float eta, const float eta_inverse, const float k_hi, const float k_lo, const uint first,
                    __global float* out, const uint count) {
  const uint i = get_global_id(0) * WIDTH;
  if (i >= count) return;
  Interface b;
  b.eta = eta;
  b.eta_inverse = eta_inverse;
  b.k_hi = k_hi;
  b.k_lo = k_lo;
  const Fresnel f = fresnel(b, AS_FLOAT(LANES + (first + i)));
  OUTPUT(0, f.R);
  OUTPUT(1, f.T);
}

KERNEL void medium(__global const float* in, __global float* out, const uint count) {
  const uint i = get_global_id(0) * WIDTH;
  if (i >= count) return;
  OUTPUT(0, transmittance(INPUT(0), INPUT(1)));
  OUTPUT(1, attenuation(INPUT(0), INPUT(1)).taken);
  OUTPUT(2, sigma_a_from_rho_d(INPUT(2)));
}
