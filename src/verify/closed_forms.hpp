#pragma once
// Radiance of glass in closed form: concentric shells in a white surround, and a stack of layers. Scalar: at each
// border light is unpolarised again, as the renderer has it.

#include <glm/glm.hpp>
#include <algorithm>
#include <cmath>
#include <vector>

#include "reference/fresnel.hpp"

namespace vitrum {

/// The other leg of a right triangle; 0 where `other` is longer than the hypotenuse.
inline double leg(double hypotenuse, double other) {
  return std::sqrt(std::max((hypotenuse - other) * (hypotenuse + other), 0.0));
}

/// Rays are floats: a truth is that of any ray which misses its place by so much of the scene's size, as 8 roundings
/// do.
constexpr double ray_error = 8 * 0x1p-24;

/// Radiance that a truth allows: the least and the greatest over rays next to the pixel's.
struct Range {
  glm::dvec3 low{1e300}, high{-1e300};
  void add(const glm::dvec3& value) {
    low = glm::min(low, value);
    high = glm::max(high, value);
  }
};

/// Share of the light that comes back from a ball met at `cosine` from index `n_i`, whose glass of index `n_t` leaves
/// `tau` of it on the way from the entry to the next border: R + T^2 tau / (1 - R tau).
inline glm::dvec3 returned(double n_i, double n_t, double cosine, const glm::dvec3& tau) {
  const reference::Fresnel f = reference::fresnel(n_i, n_t, std::clamp(cosine, 0.0, 1.0));
  if (f.total_reflection) return glm::dvec3(1.0);
  return f.R + f.T * f.T * tau / (1.0 - f.R * tau);
}

struct Shell {
  double radius, index;
  glm::dvec3 sigma_a;
};

/// Radiance of concentric shells from the `k`th on, the outermost first, in a surround of radiance 1 and index
/// `outside`, along a ray whose distance from the centre times its index is `p`. That product is the same along all the
/// path.
inline glm::dvec3 shells_radiance(const std::vector<Shell>& shells, double p, size_t k = 0, double outside = 1.0) {
  const Shell& shell = shells[k];
  if (p >= outside * shell.radius) return glm::dvec3(1.0);
  const double cosine = leg(1.0, p / (outside * shell.radius));
  if (p >= shell.index * shell.radius) return glm::dvec3(1.0);  // total reflection
  const double half = leg(shell.radius, p / shell.index);
  if (k + 1 == shells.size() || p >= shell.index * shells[k + 1].radius)
    return returned(outside, shell.index, cosine, reference::transmittance(shell.sigma_a, 2 * half));
  const double way = half - leg(shells[k + 1].radius, p / shell.index);
  const glm::dvec3 tau = reference::transmittance(shell.sigma_a, way);
  return returned(outside, shell.index, cosine, tau * tau * shells_radiance(shells, p, k + 1, shell.index));
}

/// The same around the origin, seen in `direction` from `eye` outside.
inline Range shells_seen(const std::vector<Shell>& shells, const glm::dvec3& eye, const glm::dvec3& direction) {
  const double p = glm::length(glm::cross(eye, direction)), error = ray_error * glm::length(eye);
  Range range;
  for (const double q : {std::max(p - error, 0.0), p, p + error}) range.add(shells_radiance(shells, q));
  return range;
}

struct Layer {
  double index, thickness;
  glm::dvec3 sigma_a;
};

/// Shares of the light from above that a stack reflects, and lets through.
struct Stack {
  glm::dvec3 R{0.0}, T{1.0};
};

/// Layers in air, the uppermost first, met at `cosine`, by the adding method: what lies under a border of R and
/// T = 1 - R and a layer of transmittance tau, with R' and T', becomes R + T^2 tau^2 R' / (1 - R R' tau^2) and
/// T tau T' / (1 - R R' tau^2). All indices are at least 1: nothing is reflected totally.
inline Stack layers_in_air(const std::vector<Layer>& layers, double cosine) {
  const double sine = leg(1.0, cosine);  // times the index: the same in all layers
  Stack below;
  for (size_t k = layers.size() + 1; k-- > 0;) {
    const double above_index = k == 0 ? 1.0 : layers[k - 1].index;
    const double index = k == layers.size() ? 1.0 : layers[k].index;
    const reference::Fresnel f = reference::fresnel(above_index, index, leg(1.0, sine / above_index));
    glm::dvec3 tau(1.0);
    if (k < layers.size()) tau = reference::transmittance(layers[k].sigma_a, layers[k].thickness / f.cos_theta_t);
    const glm::dvec3 among = 1.0 - f.R * below.R * tau * tau;
    below = {f.R + f.T * f.T * tau * tau * below.R / among, f.T * tau * below.T / among};
  }
  return below;
}

/// The same seen in `direction` from above, with the light of lit_from_both_sides (truth_pictures.hpp).
inline Range layers_seen(const std::vector<Layer>& layers, const glm::dvec3& direction) {
  Range range;
  for (const double error : {-ray_error, 0.0, ray_error}) {
    const Stack stack = layers_in_air(layers, std::clamp(-direction.y + error, 0.0, 1.0));
    range.add({stack.R.x, stack.T.y, stack.R.z + stack.T.z});
  }
  return range;
}

}  // namespace vitrum
