#pragma once
// Photon passes by themselves, so that a check can look at every photon that is stored.

#include <memory>
#include <vector>

#include "render/photon_pass.hpp"
#include "scene/features.hpp"

namespace vitrum {

/// A scene on a device, ready to shoot photons.
class PhotonRun {
 public:
  PhotonRun(const Scene& scene, Device& device, const KernelFiles& files = {})
      : scene_(scene),
        device_(device),
        features_(scene_features(scene)),
        data_(scene_data(scene, features_)),
        tree_(features_.mesh ? build_tree(data_.tree_triangles) : Tree{}),
        kernels_(device, files, photon_stages_for(features_), features_.build_options()),
        device_scene_(upload(device, data_, features_, features_.mesh ? &tree_ : nullptr)),
        pass_(KernelContext{device_, kernels_, scene_, data_, device_scene_, features_}) {}

  /// Shoots `count` photons of `replicate`, behind `before` of them, as pass number `pass` of a picture.
  void run(uint64_t pass, uint32_t replicate, uint64_t before, uint64_t count) {
    pass_.run({pass, replicate, before, count, static_cast<double>(count) / static_cast<double>(scene_.photons.count),
               scene_.render.samples},
              nullptr, true, [](double) {});
  }
  const PhotonMap& map() const { return pass_.map(); }

  /// Shoots `count` photons of `replicate`, behind `before` of them, and returns those that were stored: x, y, z, -,
  /// power r, g, b, - each.
  std::vector<cl_float8> shoot(uint32_t replicate, uint64_t count, uint64_t before = 0) {
    run(0, replicate, before, count);
    return read_photons(device_, map());
  }

  /// Sum over all shots.
  const PhotonBalance& balance() const { return pass_.balance(); }

 private:
  const Scene& scene_;
  Device& device_;
  Features features_;
  SceneData data_;
  Tree tree_;
  Kernels kernels_;
  DeviceScene device_scene_;
  PhotonPass pass_;
};

}  // namespace vitrum
