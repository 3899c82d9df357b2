#pragma once
// Renders a scene: passes of photons and camera rays, summed in a film.

#include <chrono>
#include <future>
#include <map>
#include <string>
#include <vector>

#include "device/opencl.hpp"
#include "device/kernels.hpp"
#include "film/film.hpp"
#include "render/camera_pass.hpp"
#include "render/photon_pass.hpp"
#include "render/radiance_limit.hpp"
#include "scene/features.hpp"
#include "scene/scene.hpp"

namespace vitrum {

/// What a picture shows.
enum class View {
  beauty,
  photons,                      ///< the photon map as white dots
  caustics,                     ///< what of the beauty the photon map gives
  albedo, normal, depth,        ///< of what the eye meets first
  error,                        ///< standard error of each value of the beauty, from the scatter of the replicates
  cut,                          ///< radiance that the limits of depth and weight took, at most (radiance_limit.hpp)
  bias,                         ///< by how much the radius of the photon estimate makes the caustics too bright
};

/// Name of a view, as after --view; and the view of a name. The latter throws Error for a name that is none.
const char* view_name(View view);
View view_of_name(const std::string& name);

struct RenderOptions {
  std::vector<View> views = {View::beauty};
  KernelFiles kernels;
  Launches launches;
  /// Ready when the scene's textures have their texels (scene/textures.hpp), or has failed; none: they have them.
  std::shared_future<void> textures_ready;
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

  /// Standard error of each value of the beauty, from the scatter of the replicates; empty of a single one.
  std::vector<double> standard_error() const;
  /// Photons in an estimate of irradiance, all passes together: the mean over all estimates, weighted by their photons.
  /// It is pairs over photons, k (k - 1) over k, unbiased for photons that are independent. 0 if there are none.
  double photons_in_estimate() const;
};

/// Renders `scene` on `device`. The views error and bias take a pass for each replicate, if there are samples for so many.
/// The scene's textures' texels may be decoded by another thread meanwhile. The same scene, passes and seed give the same
/// bits, whatever the threads and the group size. Throws Error.
RenderResult render(const Scene& scene, Device& device, const RenderOptions& options);

}  // namespace vitrum
