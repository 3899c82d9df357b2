#pragma once
// One pass of camera rays: generated, traced, shaded, split at glass, and added to the film.

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "render/kernel_context.hpp"

namespace vitrum {

class PatchView;
struct PhotonMap;

/// Rays by what they are, and what was gathered for them.
struct CameraCounts {
  uint64_t camera = 0;          ///< rays from the eye
  uint64_t secondary = 0;       ///< rays reflected and refracted
  uint64_t shadow = 0;
  uint64_t gathered = 0;        ///< photons, summed over all estimates of irradiance
  uint64_t gathered_pairs = 0;  ///< sum of k (k - 1) over all estimates of k photons
};

/// How many samples each pixel gets of a pass.
struct SampleCounts {
  std::vector<uint32_t> pixel_of_slot;  ///< those with the most samples first
  std::vector<uint32_t> of_group;       ///< samples of a pixel, by groups of SLOT_GROUP slots, falling; at least 1
  /// The same number, at least 1, for all of `pixels`.
  static SampleCounts uniform(uint32_t pixels, uint32_t samples);
  /// About `wanted` for each pixel; none gets less.
  static SampleCounts of(std::span<const uint32_t> wanted);
  uint32_t most() const { return of_group.front(); }
  uint32_t in_slot(size_t slot) const { return of_group[slot / SLOT_GROUP]; }
  uint64_t total() const;
};

/// Traces camera rays pass by pass; keeps its buffers between passes.
class CameraPass {
 public:
  /// `first_hits`: albedo, normal and depth are wanted.
  CameraPass(const KernelContext& context, bool first_hits);
  ~CameraPass();

  /// Starts a pass: its samples, in `parts` parts of `counts` each, go on in the sequence of `replicate` from sample `first`
  /// on. `is_only`: the picture's only one, which is at the pixel's centre.
  void start(uint32_t replicate, uint32_t first, SampleCounts counts, uint32_t parts, bool is_only);

  /// Adds samples [first, last) of each pixel, as far as it has so many, of a part of the pass to the film's sums.
  /// `map`: the photons to gather; nullptr where the scene has no caustics. `patches`: what is drawn of them; nullptr where
  /// there are no footprints. Reports the fraction done.
  void run(uint32_t part, uint32_t first, uint32_t last, const PhotonMap* map, const PatchView* patches,
           const std::function<void(double)>& progress);

  /// The film's sums since the last call, plane after plane of width * height values (kernels/film.h), and clears them.
  std::vector<float> take_film();

  CameraCounts counts() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vitrum
