#pragma once
// The photon map's tree, for the k nearest photons: built on the host, searched on the device.

#include <span>

#include "render/kernel_context.hpp"

namespace vitrum {

struct PhotonMap;

/// A left-balanced tree of eight photons a leaf and eight children a node, laid out as kernels/photon_map.h says.
struct PhotonTree {
  kernel::PhotonTreeData shape{};
  std::vector<float> leaves, nodes;
};

/// Sorts at least one photon, as it is stored unsorted, into a tree: each half where the box around its photons is
/// longest. The same photons in the same order give the same tree, bit by bit.
PhotonTree build_photon_tree(std::span<const cl_float8> photons);

/// Makes `map` the tree of `photons`, reusing its buffers. `max_radius` is that of the estimate [m].
void fill_photon_tree(Device& device, PhotonMap& map, std::span<const cl_float8> photons, double max_radius);

}  // namespace vitrum
