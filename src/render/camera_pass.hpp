#pragma once
// One pass of camera rays: generated, traced, shaded, split at glass, and added to the film.

#include <functional>
#include <memory>

#include "render/kernel_context.hpp"

namespace vitrum {

struct PhotonMap;

/// Rays by what they are, and what was gathered for them.
struct CameraCounts {
  uint64_t camera = 0;          ///< rays from the eye
  uint64_t secondary = 0;       ///< rays reflected and refracted
  uint64_t shadow = 0;
  uint64_t gathered = 0;        ///< photons, summed over all estimates of irradiance
  uint64_t gathered_pairs = 0;  ///< sum of k (k - 1) over all estimates of k photons
};

/// Traces camera rays pass by pass; keeps its buffers between passes.
class CameraPass {
 public:
  /// `first_hits`: albedo, normal and depth are wanted.
  CameraPass(const KernelContext& context, bool first_hits);
  ~CameraPass();

  /// Adds samples [first, first + count) of every pixel, out of `total` of the whole picture, to the film's sums.
  /// `map`: the photons to gather; nullptr where the scene has no caustics. Reports the fraction done.
  void run(uint32_t replicate, uint32_t first, uint32_t count, uint32_t total, const PhotonMap* map,
           const std::function<void(double)>& progress);

  /// The film's sums since the last call, plane after plane of width * height values (kernels/film.h), and clears them.
  std::vector<float> take_film();

  CameraCounts counts() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vitrum
