#pragma once
// Renders a scene: passes of photons and camera rays, summed in a film.

#include <chrono>
#include <future>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "device/opencl.hpp"
#include "device/kernels.hpp"
#include "film/film.hpp"
#include "render/camera_pass.hpp"
#include "render/photon_pass.hpp"
#include "render/radiance_limit.hpp"
#include "render/rounds.hpp"
#include "render/view.hpp"
#include "scene/features.hpp"
#include "scene/scene.hpp"

namespace vitrum {

struct RenderOptions {
  std::vector<View> views = {View::beauty};
  KernelFiles kernels;
  Launches launches;
  /// Ready when the scene's textures have their texels (scene/textures.hpp), or has failed; none: they have them.
  std::shared_future<void> textures_ready;
  /// From when on RenderSettings::time_limit counts.
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
};

/// What a render gave and what it took.
struct RenderResult {
  Film film{1, 1};              ///< planes "radiance", "cut" (weight), and what the views want
  RadianceLimit limit;          ///< of what was cut
  uint64_t rejected_values = 0; ///< sums of up to 32 samples in a channel of a pixel that were not finite; none expected
  PhotonBalance photons;
  CameraCounts rays;
  Features features;
  double photon_radius = 0.0;   ///< of the estimate, mean over the passes [m]; for the k nearest, the greatest
  std::map<std::string, double> seconds;    ///< wall time by stage: tree, build, upload, and the kernels' own
  std::map<std::string, double> cpu_seconds;  ///< CPU time of the process, all threads, in "photon" and "camera" passes
  std::chrono::steady_clock::time_point first_pixels;  ///< when the first of them were there
  std::map<std::string, uint64_t> memory;   ///< device buffers by purpose [bytes]
  int passes = 0;
  double samples = 0.0;         ///< of a pixel, mean
  std::optional<RoundsResult> rounds;       ///< where RenderSettings::target_error or time_limit asked for them

  /// Standard error of each value of the beauty, from the scatter of the replicates; empty of a single one.
  std::vector<double> standard_error() const;
  /// Photons in an estimate of irradiance, all passes together: the mean over all estimates, weighted by their photons.
  /// It is pairs over photons, k (k - 1) over k, unbiased for photons that are independent. 0 if there are none.
  double photons_in_estimate() const;
};

/// Renders `scene` on `device`. The views error and bias take a pass for each replicate, if there are samples for so many.
/// The scene's textures' texels may be decoded by another thread meanwhile. The same scene, passes and seed give the same
/// bits, whatever the threads and the group size; where a time limit ended it, with as many rounds. Throws
/// Error.
RenderResult render(const Scene& scene, Device& device, const RenderOptions& options);

}  // namespace vitrum
