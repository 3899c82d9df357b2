#pragma once
// What every pass works with: the device, the scene on it, and the kernels built for it.

#include "device/device_scene.hpp"
#include "device/opencl.hpp"
#include "device/kernels.hpp"
#include "scene/features.hpp"
#include "scene/scene.hpp"

namespace vitrum {

/// How passes are cut into launches. Pictures do not depend on it but where photons are sampled independently, which draw
/// anew in each launch. With footprints, the photons of a light and a caster are one launch.
struct Launches {
  uint32_t photons = 1u << 16;  ///< a multiple of 1024; what so many leave fits a CPU's caches, until it is sorted
  uint32_t pixels = 1u << 16;   ///< a multiple of every WIDTH
  uint32_t samples = 0;         ///< of each pixel; 0: as many as take a tenth of a second, so that progress can be told
  bool last_pixels_first = false;
};

struct KernelContext {
  Device& device;
  const Kernels& kernels;
  const Scene& scene;
  const SceneData& data;
  const DeviceScene& device_scene;
  const Features& features;
  Launches launches{};
};

/// Stride for arrays of fields with room for `count` entries: whole SIMD lanes, and not a power of two, or all fields
/// of an entry would fall into the same few lines of a CPU's cache (a third of the photons' time was lost to that).
inline uint32_t padded(uint64_t count) { return static_cast<uint32_t>((count + 1023) / 1024 * 1024 + 16); }

}  // namespace vitrum
