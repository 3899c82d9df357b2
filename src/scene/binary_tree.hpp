#pragma once
// A binary tree over boxes, by Embree's builder: what the tree that rays go through is made of.

#include <embree3/rtcore.h>

#include <array>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <vector>

#include "scene/tree.hpp"

namespace vitrum {

/// Lies in memory of Embree's, in an order that hangs on the threads.
struct BinaryNode {
  uint32_t triangles = 0;                    ///< of a leaf; 0: a node
  uint32_t triangle[TREE_LEAF_WIDTH];        ///< of a leaf: indices of primitives
  // A leaf ends here.
  BinaryNode* child[2];
  RTCBounds bounds[2];                       ///< the children's
  // For wide_nodes.hpp.
  float cost[TREE_WIDTH];
  uint8_t to_first[TREE_WIDTH];
  uint8_t height;

  bool is_leaf() const { return triangles != 0; }
};

/// Levels of nodes that a binary tree may have: as many as three to a level of nodes of TREE_WIDTH = 2^3.
constexpr int binary_max_height = 3 * TREE_MAX_DEPTH;

class BinaryTree {
 public:
  /// Builds it with `threads` threads, 0: all, leaves of up to TREE_LEAF_WIDTH of the boxes. The same boxes give the
  /// same tree whatever the number of threads. Throws Error where Embree cannot, and std::bad_alloc where memory runs
  /// out.
  BinaryTree(std::vector<RTCBuildPrimitive> boxes, unsigned threads);

  /// nullptr: no boxes.
  BinaryNode* root() const { return root_; }

 private:
  /// nullptr: Embree's error tells why.
  BinaryNode* built(std::vector<RTCBuildPrimitive>& boxes, unsigned children, unsigned depth);

  struct Release {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCBVH bvh) const { rtcReleaseBVH(bvh); }
  };
  std::unique_ptr<std::remove_pointer_t<RTCDevice>, Release> device_;
  std::unique_ptr<std::remove_pointer_t<RTCBVH>, Release> bvh_;
  BinaryNode* root_ = nullptr;
};

}  // namespace vitrum
