#pragma once
// Borders, angles and absorbing media for the checks and tests of kernels/fresnel.cl: all binades, and the cases that
// break the usual formulas. The same seed gives the same inputs.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <random>

namespace vitrum {

/// Spacing of floats at `value`'s size, of denormals where it is below the normal ones.
inline double float_ulp(double value) {
  const double size = std::max(std::abs(value), 0x1p-126);
  return std::ldexp(1.0, std::ilogb(size) - 23);
}

/// How many floats lie from `a` to `b`; neither is NaN. -0 equals 0.
inline int64_t floats_between(float a, float b) {
  const auto place = [](float x) {
    const auto bits = std::bit_cast<int32_t>(x);
    return bits < 0 ? int64_t{std::numeric_limits<int32_t>::min()} - bits : int64_t{bits};
  };
  return std::abs(place(a) - place(b));
}

struct Indices {
  double n_i = 1.0, n_t = 1.0;
};

class FresnelInputs {
 public:
  explicit FresnelInputs(uint64_t seed) : random_(seed) {}

  double uniform() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  uint32_t below(uint32_t count) { return static_cast<uint32_t>((random_() >> 32) * count >> 32); }

  /// Two indices from 1 to 4, ratios down to 1 + 2^-23, either the larger.
  Indices glass() {
    constexpr std::array known = {1.0, 1.00028, 1.333, 1.5, 2.4, 4.0};
    const double n = below(3) == 0   ? 1 + 3 * uniform()
                     : below(2) == 0 ? 1 + std::exp2(-23 * uniform())
                                     : known[1 + below(known.size() - 1)];
    const double other = below(4) == 0 ? known[below(known.size())] : 1.0;
    return below(2) == 0 ? Indices{n, other} : Indices{other, n};
  }

  /// Any two indices that a material can have.
  Indices any_indices() {
    const auto any = [this] { return std::pow(10.0, -3 + 4 * uniform()); };
    const double n = any();
    switch (below(4)) {
      case 0: return {n, n};
      case 1: return {n, std::nextafter(n, 0.0)};
      default: return {n, any()};
    }
  }

  /// A cosine in [0, 1] (one in some hundreds is a float above 1): uniform, of any binade, within 1e-6 of the critical
  /// angle or within 8 floats of it, and the ends.
  float cosine(Indices n) {
    constexpr std::array ends = {0.0f, 1.0f, 1.0f + 0x1p-23f, 1.0f - 0x1p-24f, 0x1p-149f, 0x1p-126f, 0x1p-127f, 1e-30f};
    const uint32_t kind = below(64);
    if (kind == 0) return ends[below(ends.size())];
    if (kind < 24) return static_cast<float>(uniform());
    if (kind < 40 || n.n_i <= n.n_t) return std::bit_cast<float>(below(0x3f800001u));
    const double ratio = n.n_t / n.n_i;
    const double critical = std::sqrt((1 - ratio) * (1 + ratio));
    if (kind < 52) return static_cast<float>(std::clamp(critical + 2e-6 * (uniform() - 0.5), 0.0, 1.0));
    const auto bits = std::bit_cast<uint32_t>(static_cast<float>(critical)) + 8;
    return std::min(std::bit_cast<float>(bits < 16 ? 0 : bits - below(17)), 1.0f);
  }

  glm::dvec3 unit_vector() {
    const double z = 2 * uniform() - 1, angle = 2 * std::acos(-1.0) * uniform(), r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }

  /// sigma_a [1/m] and distance [m]: products of all sizes up to past the least float, no absorption, opaque, distance
  /// 0 and the longest that the renderer has.
  std::array<float, 2> absorbing_path() {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    constexpr std::array<float, 6> sigmas = {0.0f, infinity, 0x1p-149f, 1.0f, 1e30f, 3e38f};
    constexpr std::array<float, 6> distances = {0.0f, 3e38f, 0x1p-149f, 1.0f, 1e-6f, 88.0f};
    const uint32_t kind = below(16);
    if (kind == 0) return {sigmas[below(sigmas.size())], distances[below(distances.size())]};
    const double distance = std::exp2(40 * uniform() - 20);
    const double depth = kind < 4   ? std::exp2(130 * uniform() - 123)
                         : kind < 6 ? 87.3 + 0.1 * uniform()
                         : kind < 8 ? 0.25 + 0.01 * (uniform() - 0.5)
                                    : std::exp2(16 * uniform() - 9);
    return {static_cast<float>(depth / distance), static_cast<float>(distance)};
  }

  /// rho_d in [0, 1]: any binade, uniform, close to 1, the ends.
  float reflectance() {
    constexpr std::array ends = {0.0f, 1.0f, 0x1p-149f, 0x1p-127f, 0x1p-126f, 1.0f - 0x1p-24f, 0.5f};
    switch (below(8)) {
      case 0: return ends[below(ends.size())];
      case 1: return 1.0f - static_cast<float>(below(1u << 20)) * 0x1p-24f;
      case 2:
      case 3: return static_cast<float>(uniform());
      default: return std::bit_cast<float>(below(0x3f800001u));
    }
  }

 private:
  std::mt19937_64 random_;
};

}  // namespace vitrum
