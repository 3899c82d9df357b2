#pragma once
// Which nodes of a binary tree become the children of nodes that are TREE_WIDTH wide.

#include <vector>

#include "scene/binary_tree.hpp"

namespace vitrum {

struct WideChild {
  BinaryNode* node;                 ///< a leaf, or the root of another wide node
  RTCBounds bounds;
};

/// Finds out for `root`, no leaf, and all below it how many of a wide node's children they best become, by what a ray
/// is expected to spend.
void weigh(BinaryNode& root);

/// The children of the wide node whose root is `node`, which has been weighed: two to TREE_WIDTH. `levels` is how many
/// levels of wide nodes there may be from this one on; if the height of `node` is at most 3 * levels, those of the
/// children are at most 3 * (levels - 1).
std::vector<WideChild> wide_children(const BinaryNode& node, int levels);

}  // namespace vitrum
