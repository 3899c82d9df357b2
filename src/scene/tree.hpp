#pragma once
// The tree over triangles: made here once for a scene, traversed on the device (kernels/tree.h).

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "scene/scene.hpp"

namespace vitrum {

namespace kernel {
#include "tree_types.h"
}

/// A triangle as the tree takes it; hits name it by (shape, primitive).
struct TreeTriangle {
  glm::vec3 a{0}, b{0}, c{0};   ///< corners [m]
  uint32_t shape = 0;           ///< index into the scene's shapes
  uint32_t primitive = 0;       ///< triangle of a mesh
};

/// What building the tree took and gave.
struct TreeStatistics {
  size_t triangles = 0;         ///< in the tree
  size_t dropped = 0;           ///< not in the tree: no area, or not finite, or beyond TREE_MAX_COORDINATE
  int depth = 0;                ///< nodes on the longest path from the root, at most TREE_MAX_DEPTH
  int stack = 0;                ///< entries that a traversal needs at worst, at most TREE_STACK_SIZE
  size_t bytes = 0;             ///< of the nodes and leaves
  double seconds = 0;           ///< wall time of build_tree
};

/// Flat arrays, ready for upload. There is always a root; a tree of no triangles has no leaves.
struct Tree {
  std::vector<kernel::TreeNode> nodes;
  std::vector<kernel::TreeLeaf> leaves;
  TreeStatistics statistics;
};

/// The triangles of every mesh, and no other shape, in the order of the scene. Throws Error at the shape that reaches
/// beyond TREE_MAX_COORDINATE.
std::vector<TreeTriangle> tree_triangles(const Scene& scene);

/// Builds the tree with `threads` threads, 0: all. The same triangles give the same bits whatever their number.
/// Throws Error where there are TREE_MAX_TRIANGLES or more, or memory runs out.
Tree build_tree(std::span<const TreeTriangle> triangles, unsigned threads = 0);

}  // namespace vitrum
