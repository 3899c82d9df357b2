#pragma once
// Fresnel and Bouguer in float as textbooks have them and many renderers use them: what vitrum's forms are compared with.
// No picture is made with them.

#include <cmath>

namespace vitrum::textbook {

/// Reflectance by the angles' cosines: Snell gives the sine of the other angle, r_s and r_p follow. Born and Wolf,
/// Principles of Optics, 1.5.2.
inline float reflectance_by_cosines(float n_i, float n_t, float cos_i) {
  const float sin_t = n_i / n_t * std::sqrt(std::fmax(1.0f - cos_i * cos_i, 0.0f));
  if (sin_t >= 1.0f) return 1.0f;
  const float cos_t = std::sqrt(std::fmax(1.0f - sin_t * sin_t, 0.0f));
  const float r_s = (n_i * cos_i - n_t * cos_t) / (n_i * cos_i + n_t * cos_t);
  const float r_p = (n_t * cos_i - n_i * cos_t) / (n_t * cos_i + n_i * cos_t);
  return 0.5f * (r_s * r_s + r_p * r_p);
}

/// Reflectance by g = sqrt(eta^2 - 1 + c^2): Cook and Torrance, A reflectance model for computer graphics (1982).
inline float reflectance_by_g(float n_i, float n_t, float c) {
  const float eta = n_t / n_i, g2 = eta * eta - 1.0f + c * c;
  if (g2 < 0.0f) return 1.0f;
  const float g = std::sqrt(g2), a = (g - c) / (g + c), b = (c * (g + c) - 1.0f) / (c * (g - c) + 1.0f);
  return 0.5f * a * a * (1.0f + b * b);
}

/// Transmittance after `distance` [m], and what is absorbed.
inline float transmittance(float sigma_a, float distance) { return std::exp(-(sigma_a * distance)); }
inline float absorptance(float sigma_a, float distance) { return 1.0f - transmittance(sigma_a, distance); }

/// sigma_a [1/m] of the reflectance rho_d.
inline float sigma_a_from_rho_d(float rho_d) { return 1.0f / rho_d - 1.0f; }

}  // namespace vitrum::textbook
