// Fresnel, Snell and Bouguer: what light does at a border between two media and inside an absorbing one.
// The one header shared by the kernels and by the tests on the host.
//
// Notation: eta = n_t / n_i is the index on the transmitted side relative to the incident side, cos_theta_i in [0,1] is
// the cosine between the direction back to where the light came from and the normal on the incident side. Light is
// unpolarised, media do not conduct.
#ifndef VITRUM_FRESNEL_CL
#define VITRUM_FRESNEL_CL

#include "portability.h"

// A border between two media as Fresnel's equations take it, made by the host in double (src/device/interface.hpp).
// k = eta^2 - 1 is carried in two floats: from two rounded indices alone, R is thousands of ulp off near the critical
// angle, and for indices that are nearly equal.
typedef struct {
  Float eta, eta_inverse;
  Float k_hi, k_lo;
} Interface;

typedef struct {
  Float R;       // reflectance, 1 at total internal reflection
  Float T;       // transmittance of the border (flux), by its own formula: 1 - R loses it at grazing angles
  Float r_perp;  // amplitude across the plane of incidence, (n_i cos_i - n_t cos_t) / (n_i cos_i + n_t cos_t)
  Float r_par;   // amplitude in the plane of incidence, (n_t cos_i - n_i cos_t) / (n_t cos_i + n_i cos_t)
  Float bend;    // cos_t - cos_i / eta: what refraction takes off the direction along the normal
  Mask total;    // total internal reflection, no refracted ray
} Fresnel;

// The journal cuts the code between [name] and [/name].
// [fresnel]
// Fresnel's equations (unpolarised) and Snell's law at cos_theta_i in [0,1]; above 1 counts as 1, NaN stays NaN.
// Born and Wolf, Principles of Optics, 1.5.2, with c = cos_theta_i and Q = eta cos_theta_t, in a form where nothing
// cancels for eta near 1: r_perp = -k / (c + Q)^2 and r_par = -b r_perp. Nor does it near the critical angle: c^2 and
// k_hi are nearly opposite there, and the one rounding of an fma leaves their small sum exact.
// Accuracy: R within 16 ulp, T within 16 ulp for cos_theta_i > 1e-30, of the border whose k is k_hi + k_lo.
FUNCTION Fresnel fresnel(const Interface border, const Float cos_theta_i) {
  const Float c = cos_theta_i > 1.0f ? 1.0f : cos_theta_i;
  const Float Q2 = fma(c, c, border.k_hi) + border.k_lo;
  const Mask total = Q2 < 0.0f;
  const Mask matched = border.k_hi == 0.0f;
  const Float Q = sqrt(total ? 0.0f : Q2);
  const Float sin2 = (1.0f - c) * (1.0f + c);
  const Float v = 1.0f / fma(c, Q, sin2);
  const Float b = v * fma(c, Q, -sin2);
  const Float e = v * border.eta;
  const Float w = 1.0f / ((matched | total) ? 1.0f : c + Q);
  const Float r = border.k_hi * (w * w);

  Fresnel f;
  f.total = total;
  f.r_perp = total ? 1.0f : -r;
  f.r_par = total ? 1.0f : b * r;
  f.R = total ? 1.0f : 0.5f * (r * r) * fma(b, b, 1.0f);
  f.T = total ? 0.0f : matched ? 1.0f : 2.0f * (c * Q) * (w * w) * fma(e, e, 1.0f);
  f.bend = border.k_hi * w * border.eta_inverse;
  return f;
}
// [/fresnel]

// [refract]
// Direction of the refracted ray: unit `direction` towards the border, unit `normal` on the incident side, `f` of the
// same border and angle. Unit length within rounding. Not to be called at total reflection.
FUNCTION Vec3 refracted_direction(const Interface border, const Fresnel f, const Vec3 direction, const Vec3 normal) {
  const Vec3 t = along3(scale3(border.eta_inverse, direction), -f.bend, normal);
  // One Newton step of 1 / sqrt(|t|^2) takes the roundings off the length; index-matched, t is already `direction`.
  const Float stretch = fma(-0.5f, dot3(t, t), 1.5f);
  return select3(border.k_hi == 0.0f, direction, scale3(stretch, t));
}

// Direction of the mirrored ray. Unit length within rounding.
FUNCTION Vec3 reflected_direction(const Vec3 direction, const Vec3 normal) {
  const Vec3 r = along3(direction, -2.0f * dot3(direction, normal), normal);
  return scale3(fma(-0.5f, dot3(r, r), 1.5f), r);
}
// [/refract]

// [bouguer]
// Fraction of the light left after `distance` [m] in a medium of absorption sigma_a [1/m] (Bouguer's law).
// sigma_a = INFINITY is opaque: nothing is left after any distance above 0; distance is finite. Relative error below
// 5e-7 down to the least normal float, 0 under it.
FUNCTION Float transmittance(const Float sigma_a, const Float distance) {
  const Mask opaque = sigma_a == INFINITY;
  const Float x = opaque ? 0.0f : sigma_a * distance;
  const Float t = exp(-x);
  // What the product lost in rounding, to first order; not where it is infinite.
  const Float corrected = fma(-t, fma(sigma_a, distance, -x), t);
  const Float left = ((x > 88.0f) | (corrected < 1.17549435e-38f)) ? 0.0f : corrected;
  return opaque ? (distance > 0.0f ? (Float)0.0f : (Float)1.0f) : left;
}

// Fraction absorbed, 1 - transmittance without its cancellation: a count of its own for the balance of power.
FUNCTION Float absorptance(const Float sigma_a, const Float distance) {
  const Mask opaque = sigma_a == INFINITY;
  const Float x = opaque ? 0.0f : sigma_a * distance;
  // Taylor series of 1 - exp(-x), cut where the next term is below 2^-25 for x < 1/4.
  Float series = fma(x, 1.0f / 5040.0f, -1.0f / 720.0f);
  series = fma(x, series, 1.0f / 120.0f);
  series = fma(x, series, -1.0f / 24.0f);
  series = fma(x, series, 1.0f / 6.0f);
  series = fma(x, series, -0.5f);
  series = fma(x, series, 1.0f);
  const Float absorbed = x < 0.25f ? x * series : 1.0f - exp(-x);
  return opaque ? (distance > 0.0f ? (Float)1.0f : (Float)0.0f) : absorbed;
}

// sigma_a [1/m] of the worksheet's reflectance rho_d in [0,1]: 1/rho_d - 1, in the form that does not cancel near 1.
// Its limit at 0 is opaque, by a conditional: no infinity is ever multiplied.
FUNCTION Float sigma_a_from_rho_d(const Float rho_d) {
  return rho_d < 1.17549435e-38f ? INFINITY : (1.0f - rho_d) / rho_d;
}
// [/bouguer]

#endif
