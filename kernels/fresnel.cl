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
// T is the mean of 4 c Q / (c + Q)^2 and 4 c Q eta^2 / (eta^2 c + Q)^2.
// Accuracy: R within 16 ulp, T within 8 ulp for cos_theta_i > 1e-30, of the border whose k is k_hi + k_lo.
FUNCTION Fresnel fresnel(const Interface border, const Float cos_theta_i) {
  const Float c = cos_theta_i > 1.0f ? 1.0f : cos_theta_i;
  const Float Q2 = fma(c, c, border.k_hi) + border.k_lo;
  const Mask total = Q2 < 0.0f;
  const Mask matched = border.k_hi == 0.0f;
  const Mask plain = (matched | total) == 0;  // else the quotients do not matter, and might be 0 / 0
  const Float Q = sqrt(total ? 0.0f : Q2);
  const Float sin2 = (1.0f - c) * (1.0f + c);
  const Float b = fma(c, Q, -sin2) / fma(c, Q, sin2);
  const Float w = 1.0f / (plain ? c + Q : 1.0f);
  const Float e = border.eta / (plain ? fma(border.eta * border.eta, c, Q) : 1.0f);
  const Float r = border.k_hi * (w * w);

  Fresnel f;
  f.total = total;
  f.r_perp = total ? 1.0f : -r;
  f.r_par = total ? 1.0f : b * r;
  f.R = total ? 1.0f : 0.5f * (r * r) * fma(b, b, 1.0f);
  f.T = total ? 0.0f : matched ? 1.0f : 2.0f * (c * Q) * fma(e, e, w * w);
  f.bend = border.k_hi * w * border.eta_inverse;
  return f;
}
// [/fresnel]

// [refract]
// scale * direction + along * normal, which is of unit length but for roundings: one Newton step of 1 / sqrt(|d|^2) takes
// those off.
FUNCTION Vec3 deflected(const Float scale, const Vec3 direction, const Float along, const Vec3 normal) {
  const Vec3 d = along3(scale3(scale, direction), along, normal);
  return scale3(fma(-0.5f, dot3(d, d), 1.5f), d);
}

// Direction of the refracted ray: unit `direction` towards the border, unit `normal` on the incident side, `f` of the
// same border and angle. Unit length within rounding. Not to be called at total reflection.
FUNCTION Vec3 refracted_direction(const Interface border, const Fresnel f, const Vec3 direction, const Vec3 normal) {
  const Vec3 refracted = deflected(border.eta_inverse, direction, -f.bend, normal);
  return select3(border.k_hi == 0.0f, direction, refracted);
}

// Direction of the mirrored ray. Unit length within rounding.
FUNCTION Vec3 reflected_direction(const Vec3 direction, const Vec3 normal) {
  return deflected(1.0f, direction, -2.0f * dot3(direction, normal), normal);
}

// The one or the other, lane by lane, bit by bit the same.
FUNCTION Vec3 chosen_direction(const Interface border, const Fresnel f, const Mask reflect, const Vec3 direction,
                               const Vec3 normal) {
  const Vec3 chosen = deflected(reflect ? (Float)1.0f : border.eta_inverse, direction,
                                reflect ? -2.0f * dot3(direction, normal) : -f.bend, normal);
  return select3((border.k_hi == 0.0f) & (reflect == 0), direction, chosen);
}
// [/refract]

// [bouguer]
typedef struct {
  Float left;                  // fraction of the light that is left
  Float taken;                 // fraction absorbed, 1 - left without its cancellation: for the balance of power
} Attenuation;

// Bouguer's law: light after `distance` [m] in a medium of absorption sigma_a [1/m]. sigma_a = INFINITY is opaque:
// nothing is left after any distance above 0; distance is finite. Relative error of what is left below 5e-7 down to the
// least normal float, 0 under it. The same bits on every device.
// exp(-x) = 2^-k exp(y) with x = k ln 2 - y, |y| <= ln 2 / 2 (Cody and Waite 1980), exp(y) - 1 by Cephes' polynomial of
// expf; y takes up what the product sigma_a * distance lost in rounding.
FUNCTION Attenuation attenuation(const Float sigma_a, const Float distance) {
  const Mask opaque = sigma_a == INFINITY;
  const Float product = opaque ? 0.0f : sigma_a * distance;
  const Float x = product < 88.0f ? product : 88.0f;  // exp(-88) is below the least normal float
  const Float lost = fma(sigma_a, distance, -product);
  const Float k = rint(x * 1.44269504088896341f);
  const Float y = fma(k, -2.12194440e-4f, fma(k, 0.693359375f, -x)) - lost;
  Float p = fma(y, 1.9875691500e-4f, 1.3981999507e-3f);
  p = fma(p, y, 8.3334519073e-3f);
  p = fma(p, y, 4.1665795894e-2f);
  p = fma(p, y, 1.6666665459e-1f);
  p = fma(p, y, 5.0000001201e-1f);
  const Float less_one = fma(p, y * y, y);
  const Float t = AS_FLOAT(TO_INT(127.0f - k) << 23) * (less_one + 1.0f);
  const Float left = t >= 1.17549435e-38f ? t : 0.0f;  // no number, where the product overflowed, counts as 0

  Attenuation a;
  a.left = opaque ? (distance > 0.0f ? (Float)0.0f : (Float)1.0f) : left;
  a.taken = opaque ? (distance > 0.0f ? (Float)1.0f : (Float)0.0f) : k == 0.0f ? -less_one : 1.0f - left;
  return a;
}

FUNCTION Float transmittance(const Float sigma_a, const Float distance) { return attenuation(sigma_a, distance).left; }

// sigma_a [1/m] of the worksheet's reflectance rho_d in [0,1]: 1/rho_d - 1, in the form that does not cancel near 1.
// Its limit at 0 is opaque, by a conditional: no infinity is ever multiplied.
FUNCTION Float sigma_a_from_rho_d(const Float rho_d) {
  return rho_d < 1.17549435e-38f ? INFINITY : (1.0f - rho_d) / rho_d;
}
// [/bouguer]

#endif
