#pragma once
// The caustic where its receiver is seen directly: patches of light, drawn into the picture by area (kernels/patch.h).

#include "render/kernel_context.hpp"

namespace vitrum {

struct PhotonRuns;

/// Which pixels show one plane, and the irradiance that the photons of a pass throw on it there. Keeps its buffers.
class PatchView {
 public:
  /// Looks at the scene. Features must have patches.
  explicit PatchView(const KernelContext& context);

  /// Whether each pixel shows one plain plane, so that nothing else wants photons.
  bool is_all() const { return is_all_; }
  /// Starts a pass: no light.
  void start();
  /// Adds all photons of a lattice, or those of a launch without one. Returns false if there is no room for all: so many
  /// patches of light reach from the view behind the eye, and are cut.
  bool add(const PhotonRuns& runs, const kernel::FootprintLimits& limits);
  /// From now on no pixel is drawn into.
  void give_up();
  /// Sets the arguments of PATCH_VIEW_PARAMETERS of a kernel, from `first` on; returns the next.
  unsigned set_arguments_of(cl::Kernel& kernel, unsigned first) const;

 private:
  KernelContext context_;
  bool is_all_ = false;
  kernel::ViewLayout layout_{};
  Buffer<float> planes_, irradiance_, rows_, boxes_;
  Buffer<kernel::PatchRunData> reports_;
};

}  // namespace vitrum
