#pragma once
// The passes that a picture is made of: photons, and camera rays that gather them.

#include <chrono>
#include <future>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "device/device_scene.hpp"
#include "render/camera_pass.hpp"
#include "render/patch_view.hpp"
#include "render/photon_pass.hpp"
#include "render/view.hpp"

namespace vitrum {

/// Sums of samples, by the film's plane that they belong to.
struct PlaneSums {
  std::string name;
  int channels = 3;
  std::vector<float> values;    ///< width * height * channels, interleaved
};

/// What a pass of camera rays in two halves gave, and how sure that is.
struct HalvedPass {
  std::vector<PlaneSums> means; ///< over each pixel's samples
  std::vector<double> variance; ///< of one sample, by pixel, all channels together: by the difference of the halves
  double error = 0.0;           ///< mean squared error of the radiance by camera rays, over all values
};

/// Runs the passes of one picture, one after the other.
class Passes {
 public:
  /// `textures_ready`: when the scene's textures have their texels, or invalid where they have them.
  Passes(const KernelContext& context, DeviceScene& device_scene, const std::vector<View>& views,
         std::shared_future<void> textures_ready);

  /// Whether there is light that photons are to bring.
  bool has_photons() const { return photons_ != nullptr; }
  /// Samples of a pixel that are summed in float on the device before they are handed over.
  static constexpr uint32_t samples_per_batch = 32;
  /// The same where some pixels get many, whose noise is far above what the sums are rounded by.
  static constexpr uint32_t samples_per_noisy_batch = 256;

  /// Shoots the photons that the next camera passes gather. Reports the fraction done.
  void shoot(const PhotonPassPlan& plan, const std::function<void(double)>& progress);
  /// Starts a pass of camera rays: as CameraPass::start.
  void start(uint32_t replicate, uint32_t first, SampleCounts counts, uint32_t parts, bool is_only);
  /// Samples [first, last) of each pixel, not many more than a batch: as CameraPass::run. Returns their sums in all
  /// planes that the views want.
  std::vector<PlaneSums> trace(uint32_t part, uint32_t first, uint32_t last, const std::function<void(double)>& progress);

  /// A whole pass in two halves of `counts` each, which go on in the sequence of `replicate` from sample `first` on.
  HalvedPass trace_halves(uint32_t replicate, uint32_t first, const SampleCounts& counts,
                          const std::function<void(double)>& progress);

  /// White dots where photons of the last shot lie, for View::photons; empty if that is not wanted.
  std::vector<float> dots() const;

  /// Of all passes so far. Radius: its sum over the shots [m].
  const PhotonBalance& balance() const { return photons_->balance(); }
  double radius_sum() const { return radius_sum_; }
  CameraCounts counts() const { return camera_.counts(); }
  /// CPU time of the process, all threads, in "photon" and "camera" passes [s].
  const std::map<std::string, double>& cpu_seconds() const { return cpu_seconds_; }
  /// When the first pixels were there.
  std::chrono::steady_clock::time_point first_pixels() const { return first_pixels_; }

 private:
  bool wants(View view) const;
  const PhotonMap* map() const { return photons_ ? &photons_->map() : nullptr; }

  KernelContext context_;
  DeviceScene& device_scene_;
  std::vector<View> views_;
  std::shared_future<void> textures_ready_;
  bool textures_there_ = false;
  CameraPass camera_;
  std::unique_ptr<CameraPass> narrow_camera_;  ///< gathers within a smaller radius, for View::bias
  std::unique_ptr<PhotonPass> photons_;
  std::unique_ptr<PatchView> patches_;         ///< where there are footprints
  double radius_sum_ = 0.0;
  std::map<std::string, double> cpu_seconds_;
  std::chrono::steady_clock::time_point first_pixels_{};
};

}  // namespace vitrum
