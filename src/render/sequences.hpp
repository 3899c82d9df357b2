#pragma once
// The sequences of numbers behind photons and camera rays: which one in which dimension, and where it stands.

#include <array>
#include <cstdint>

#include "device/kernel_headers.hpp"
#include "scene/scene.hpp"

namespace vitrum {

/// The dimensions of one photon sequence from photon `first` on. `sequence` tells apart pairs of light and caster,
/// `replicate` the randomised copies of the same sequence. `area_light`: places on the light are needed too, so that
/// four dimensions are spread evenly together instead of two.
std::array<kernel::SequenceData, PHOTON_DIMENSIONS> photon_sequences(Sampling sampling, uint64_t seed,
                                                                     uint32_t replicate, uint32_t sequence,
                                                                     uint64_t first, bool area_light);

/// Point `index` of the two-dimensional R2 sequence (Roberts 2018), in [0,1)^2.
std::array<float, 2> r2_point(uint64_t index);

/// Point `index` of the golden ratio's sequence, in [0,1).
float golden_point(uint64_t index);

/// Well-mixed 64 bits of two numbers (splitmix64's finaliser; Steele, Lea and Flood 2014).
uint64_t mix_bits(uint64_t a, uint64_t b);

}  // namespace vitrum
