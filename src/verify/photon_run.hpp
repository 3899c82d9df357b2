#pragma once
// Photon passes by themselves, so that a check can look at every photon that is stored.

#include <memory>
#include <vector>

#include "render/photon_pass.hpp"
#include "scene/features.hpp"

namespace vitrum {

/// A scene that has no meshes, on a device, ready to shoot photons.
class PhotonRun {
 public:
  PhotonRun(const Scene& scene, Device& device, uint64_t largest_pass, const KernelFiles& files = {})
      : scene_(scene),
        device_(device),
        features_(scene_features(scene)),
        data_(scene_data(scene, features_)),
        kernels_(device, files, {"photons", "photon_sort"}, features_.build_options()),
        device_scene_(upload(device, data_, features_, nullptr)),
        pass_(KernelContext{device_, kernels_, scene_, data_, device_scene_, features_}, largest_pass) {}

  /// Shoots `count` photons of `replicate`, behind `before` of them, and returns those that were stored: x, y, z, -,
  /// power r, g, b, - each.
  std::vector<cl_float8> shoot(uint32_t replicate, uint64_t count, uint64_t before = 0) {
    pass_.run(replicate, before, count, [](double) {});
    return read_photons(device_, pass_.map());
  }

  /// Sum over all shots.
  const PhotonBalance& balance() const { return pass_.balance(); }

 private:
  const Scene& scene_;
  Device& device_;
  Features features_;
  SceneData data_;
  Kernels kernels_;
  DeviceScene device_scene_;
  PhotonPass pass_;
};

}  // namespace vitrum
