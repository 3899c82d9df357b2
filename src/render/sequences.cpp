#include "render/sequences.hpp"

#include <cmath>

namespace vitrum {
namespace {

/// frac(x) in 64-bit fixed point.
uint64_t fixed_point(long double x) {
  return static_cast<uint64_t>(std::ldexp(x - std::floor(x), 64));
}

/// The root of x^(d+1) = x + 1 above 1: the golden ratio for d = 1, the plastic number for d = 2, ...
long double generalised_golden_ratio(int d) {
  long double x = 1.5L;
  for (int i = 0; i < 100; ++i) x = std::pow(1.0L + x, 1.0L / (d + 1));
  return x;
}

// Once each: every sample of a picture and every launch of photons asks for them.
const long double golden_ratio = generalised_golden_ratio(1), ratio_of_2 = generalised_golden_ratio(2),
                  ratio_of_4 = generalised_golden_ratio(4);

}  // namespace

uint64_t mix_bits(uint64_t a, uint64_t b) {
  uint64_t x = a + 0x9e3779b97f4a7c15u * (b + 1);
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

std::array<kernel::SequenceData, PHOTON_DIMENSIONS> photon_sequences(Sampling sampling, uint64_t seed,
                                                                     uint32_t replicate, uint32_t sequence,
                                                                     uint64_t first, bool area_light) {
  std::array<kernel::SequenceData, PHOTON_DIMENSIONS> dimensions{};
  const uint64_t key = mix_bits(mix_bits(seed, replicate), sequence);
  // Direction and place on an area light are spread evenly together, in the plane or in four dimensions. Choices along
  // the path (2) and of a mesh light's face (5) run by themselves: their projections would cost the others evenness.
  const long double ratio = area_light ? ratio_of_4 : ratio_of_2;
  const std::array<long double, PHOTON_DIMENSIONS> steps = {1 / ratio,
                                                            1 / (ratio * ratio),
                                                            std::sqrt(2.0L),
                                                            1 / (ratio * ratio * ratio),
                                                            1 / (ratio * ratio * ratio * ratio),
                                                            std::sqrt(3.0L)};
  for (size_t d = 0; d < PHOTON_DIMENSIONS; ++d) {
    kernel::SequenceData& data = dimensions[d];
    const uint64_t shift = mix_bits(key, d + 1);
    if (sampling == Sampling::independent) {
      data.start = mix_bits(shift, first);
      data.alpha = 0;
    } else {
      data.alpha = fixed_point(steps[d]);
      data.start = shift + first * data.alpha;
    }
  }
  return dimensions;
}

std::array<float, 2> r2_point(uint64_t index) {
  const auto coordinate = [&](long double step) {
    return static_cast<float>(fixed_point(step) * index >> 40) * 0x1p-24f;
  };
  return {coordinate(1 / ratio_of_2), coordinate(1 / (ratio_of_2 * ratio_of_2))};
}

float golden_point(uint64_t index) {
  return static_cast<float>(fixed_point(1 / golden_ratio) * index >> 40) * 0x1p-24f;
}

}  // namespace vitrum
