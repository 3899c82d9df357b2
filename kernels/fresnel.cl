// Fresnel, Snell and Bouguer: what light does at a border between two media and inside an absorbing one.
// The one header shared by the kernels and by the tests on the host.
//
// Notation: n_i, n_t are the indices on the incident and on the transmitted side, cos_theta_i in [0,1] is the cosine
// between the direction back to where the light came from and the normal on the incident side, P = n_i cos_theta_i and
// Q = n_t cos_theta_t the two normal components. Light is unpolarised, media do not conduct.
#ifndef VITRUM_FRESNEL_CL
#define VITRUM_FRESNEL_CL

#include "portability.h"

// A border between two media as Fresnel's equations take it. k = (n_t - n_i)(n_t + n_i) is carried in two floats,
// made by the host in double: from two rounded indices alone, R is thousands of ulp off near the critical angle.
typedef struct {
  Float n_i, n_t;
  Float k_hi, k_lo;
} Interface;

typedef struct {
  Float R;       // reflectance, 1 at total internal reflection
  Float T;       // transmittance of the border (flux), by its own formula: 1 - R loses it at grazing angles
  Float r_perp;  // amplitude across the plane of incidence, (P - Q) / (P + Q)
  Float r_par;   // amplitude in the plane of incidence, (n_t cos_i - n_i cos_t) / (n_t cos_i + n_i cos_t)
  Float bend;    // (n_t cos_t - n_i cos_i) / n_t: what refraction takes off the direction along the normal
  Mask total;    // total internal reflection, no refracted ray
} Fresnel;

// The journal cuts the code between [name] and [/name].
// [fresnel]
// Fresnel's equations (unpolarised) and Snell's law at cos_theta_i in [0,1]; above 1 counts as 1, NaN stays NaN.
// Born and Wolf, Principles of Optics, 1.5.2, in a form where nothing cancels for n_t near n_i (r_perp = -k / q^2) nor
// near the critical angle (Q^2 = P^2 + k in two floats: Dekker 1971, Knuth's TwoSum).
// Accuracy for n_t / n_i from 1/4 to 4: R within 16 ulp, T within 16 ulp for cos_theta_i > 1e-30.
FUNCTION Fresnel fresnel(const Interface border, const Float cos_theta_i) {
  const Float c = cos_theta_i > 1.0f ? 1.0f : cos_theta_i;
  const Float P = border.n_i * c;
  const Float P_lo = fma(border.n_i, c, -P);

  const Float A = P * P;
  const Float A_lo = fma(P, P, -A);
  const Float s = A + border.k_hi;
  const Float s_k = s - A;
  const Float s_lo = (A - (s - s_k)) + (border.k_hi - s_k);
  const Float Q2 = s + (s_lo + (A_lo + fma(2.0f * P, P_lo, border.k_lo)));

  const Mask matched = border.k_hi == 0.0f;
  const Mask total = Q2 < 0.0f;
  const Float Q = sqrt(total ? 0.0f : Q2);
  const Float q = matched ? 1.0f : P + Q;
  const Float S2 = border.n_i * border.n_i * ((1.0f - c) * (1.0f + c));
  const Float PQ = P * Q;
  const Float b = (PQ - S2) / (PQ + S2);
  const Float r = border.k_hi / (q * q);
  const Float m = fma(border.n_t * border.n_t, P, border.n_i * border.n_i * Q);
  const Float ratio = border.n_i * border.n_t / m;

  Fresnel f;
  f.total = total;
  f.r_perp = total ? 1.0f : -r;
  f.r_par = total ? 1.0f : matched ? 0.0f : b * r;
  f.R = total ? 1.0f : matched ? 0.0f : 0.5f * (r * r) * fma(b, b, 1.0f);
  f.T = total ? 0.0f : matched ? 1.0f : 2.0f * PQ * (1.0f / (q * q) + ratio * ratio);
  f.bend = border.k_hi / (q * border.n_t);
  return f;
}
// [/fresnel]

// [refract]
// Direction of the refracted ray: unit `direction` towards the border, unit `normal` on the incident side, `f` of the
// same border and angle. Unit length within rounding. Not to be called at total reflection.
FUNCTION Vec3 refracted_direction(const Interface border, const Fresnel f, const Vec3 direction, const Vec3 normal) {
  const Vec3 t = along3(scale3(border.n_i / border.n_t, direction), -f.bend, normal);
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
// sigma_a = INFINITY is opaque: nothing is left after any distance above 0. Relative error below 4e-6 down to the
// least normal float, 0 under it.
FUNCTION Float transmittance(const Float sigma_a, const Float distance) {
  const Mask opaque = sigma_a == INFINITY;
  const Float x = opaque ? 0.0f : sigma_a * distance;
  const Float t = exp(-x);
  // What the product lost in rounding, to first order; past 88 the result is 0 anyway.
  const Float left = x > 87.33f ? 0.0f : fma(-t, fma(sigma_a, distance, -x), t);
  return opaque ? (distance > 0.0f ? (Float)0.0f : (Float)1.0f) : left;
}

// Fraction absorbed, 1 - transmittance without its cancellation: a count of its own for the balance of power.
FUNCTION Float absorptance(const Float sigma_a, const Float distance) {
  const Mask opaque = sigma_a == INFINITY;
  const Float x = opaque ? 0.0f : sigma_a * distance;
  // x (1 - x/2 (1 - x/3 (1 - x/4 ...))), cut where the next term is below 2^-25 for x < 1/4.
  Float series = 1.0f - x / 7.0f;
  series = fma(-x / 6.0f, series, 1.0f);
  series = fma(-x / 5.0f, series, 1.0f);
  series = fma(-x / 4.0f, series, 1.0f);
  series = fma(-x / 3.0f, series, 1.0f);
  series = fma(-x / 2.0f, series, 1.0f);
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
