#pragma once
// What every pass works with: the device, the scene on it, and the kernels built for it.

#include "device/device_scene.hpp"
#include "device/opencl.hpp"
#include "device/kernels.hpp"
#include "scene/features.hpp"
#include "scene/scene.hpp"

namespace vitrum {

struct KernelContext {
  Device& device;
  const Kernels& kernels;
  const Scene& scene;
  const SceneData& data;
  const DeviceScene& device_scene;
  const Features& features;

  /// Work-items for `count` entries of a kernel that takes WIDTH of them at a time.
  size_t packets(size_t count) const { return (count + device.width() - 1) / device.width(); }
};

/// Stride for arrays of fields with room for `count` entries: whole SIMD lanes, and not a power of two, or all fields
/// of an entry would fall into the same few lines of a CPU's cache (a third of the photons' time was lost to that).
inline uint32_t padded(uint64_t count) { return static_cast<uint32_t>((count + 1023) / 1024 * 1024 + 16); }

}  // namespace vitrum
