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
#include "scene/features.hpp"
#include "scene/scene.hpp"

namespace vitrum {

/// What a picture shows.
enum class View { beauty, photons, caustics, albedo, normal, depth };

/// Name of a view, as after --view; and the view of a name. The latter throws Error for a name that is none.
const char* view_name(View view);
View view_of_name(const std::string& name);

struct RenderOptions {
  std::vector<View> views = {View::beauty};
  KernelFiles kernels;
  /// Ready when the scene's textures have their texels (scene/textures.hpp), or has failed; none: they have them.
  std::shared_future<void> textures_ready;
};

/// What a render gave and what it took.
struct RenderResult {
  Film film{1, 1};              ///< planes "radiance", "caustics", "cut", and what the views want
  PhotonBalance photons;
  RayCounts rays;
  Features features;
  double photon_radius = 0.0;   ///< of the last pass [m]
  std::map<std::string, double> seconds;    ///< wall time by stage: tree, build, upload, and the kernels' own
  std::map<std::string, double> cpu_seconds;  ///< CPU time of the process, all threads, in "photon" and "camera" passes
  std::chrono::steady_clock::time_point first_pixels;  ///< when the first of them were there
  std::map<std::string, uint64_t> memory;   ///< device buffers by purpose [bytes]
  int passes = 0;
};

/// Renders `scene` on `device`. Its textures' texels may be decoded by another thread meanwhile. The same scene and seed give the same bits, whatever the threads and the group size.
/// Throws Error.
RenderResult render(const Scene& scene, Device& device, const RenderOptions& options);

}  // namespace vitrum
