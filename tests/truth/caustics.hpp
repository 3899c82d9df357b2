#pragma once
// Renders of caustics alone.

#include "render/render.hpp"

namespace vitrum {

/// A render of the view `caustics`. What else the estimate takes is as the scene has it.
inline RenderResult caustics_of(Scene scene, uint64_t photons, int samples, PhotonEstimate estimate, Device& device) {
  scene.photons.estimate = estimate;
  scene.photons.count = photons;
  scene.render.samples = samples;
  RenderOptions options;
  options.views = {View::caustics};
  return render(scene, device, options);
}

}  // namespace vitrum
