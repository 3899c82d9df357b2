#pragma once
// The photon map's grid: how large its cells are, how wide the estimate's radius, and the sort into it.

#include <span>

#include "render/kernel_context.hpp"

namespace vitrum {

struct PhotonMap;

/// The radius within which about `wanted` of `count` photons lie around the median photon, judged from `sample`, some
/// of the photons' places [m]. The density is that on a surface.
float automatic_radius(std::span<const glm::vec3> sample, uint64_t count, int wanted);

/// A grid of cells a little larger than `radius` [m], as fine as the photons in `sample` need and no finer than their
/// number `count` makes worthwhile.
kernel::GridData choose_grid(std::span<const glm::vec3> sample, uint64_t count, float radius);

/// Sorts photon maps; keeps its buffers.
class PhotonGrid {
 public:
  explicit PhotonGrid(const KernelContext& context);
  /// Sorts the photons of the runs into the grid, and fills all that belongs to it.
  void sort(PhotonMap& map);

 private:
  KernelContext context_;
  Buffer<uint32_t> counts_, first_of_bucket_, next_of_cell_;
  Buffer<cl_float8> bounds_, bucketed_;
};

}  // namespace vitrum
