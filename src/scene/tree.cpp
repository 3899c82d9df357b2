#include "scene/tree.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>
#include <cmath>
#include <new>
#include <string>

#include "scene/wide_nodes.hpp"

namespace vitrum {

namespace {

using kernel::TreeLeaf;
using kernel::TreeNode;

[[noreturn]] void out_of_memory(size_t triangles) {
  throw Error({}, "not enough memory for the tree over " + std::to_string(triangles) + " triangles",
              "use meshes with fewer triangles");
}

/// Can a ray hit it, and has it a normal? False for what is not finite.
bool usable(const TreeTriangle& t) {
  for (const glm::vec3& p : {t.a, t.b, t.c})
    for (int axis = 0; axis < 3; ++axis)
      if (!(std::abs(p[axis]) <= TREE_MAX_COORDINATE)) return false;
  const glm::dvec3 a(t.a);
  return glm::cross(glm::dvec3(t.b) - a, glm::dvec3(t.c) - a) != glm::dvec3(0.0);
}

std::vector<RTCBuildPrimitive> build_primitives(std::span<const TreeTriangle> triangles) {
  std::vector<RTCBuildPrimitive> primitives;
  primitives.reserve(triangles.size());
  for (size_t i = 0; i < triangles.size(); ++i) {
    const TreeTriangle& t = triangles[i];
    if (!usable(t)) continue;
    const glm::vec3 low = glm::min(t.a, glm::min(t.b, t.c)), high = glm::max(t.a, glm::max(t.b, t.c));
    primitives.push_back({low.x, low.y, low.z, 0, high.x, high.y, high.z, static_cast<uint32_t>(i)});
  }
  return primitives;
}

/// Puts wide nodes and leaves into the flat arrays, depth first, so that the result hangs on the tree alone.
class Flattener {
 public:
  Flattener(std::span<const TreeTriangle> triangles, Tree& tree) : triangles_(triangles), tree_(tree) {}

  void flatten(const BinaryNode* root) {
    if (root == nullptr || root->is_leaf()) {
      tree_.nodes.push_back(empty_node());
      tree_.statistics.depth = 1;
      tree_.statistics.stack = 1;
      if (root != nullptr) set_child(0, 0, bounds_of(*root), leaf(*root));
      return;
    }
    node(*root, 1, 0);
  }

 private:
  static TreeNode empty_node() {
    TreeNode node;
    for (auto& axis : node.planes) {
      std::ranges::fill(axis[0], INFINITY);
      std::ranges::fill(axis[1], -INFINITY);
    }
    std::ranges::fill(node.child, TREE_EMPTY);
    return node;
  }

  void set_child(uint32_t parent, int slot, const RTCBounds& b, uint32_t child) {
    const std::array low{b.lower_x, b.lower_y, b.lower_z}, high{b.upper_x, b.upper_y, b.upper_z};
    float reach = 0;
    for (int axis = 0; axis < 3; ++axis) reach = std::max({reach, std::abs(low[axis]), std::abs(high[axis])});
    TreeNode& node = tree_.nodes[parent];
    for (int axis = 0; axis < 3; ++axis) {
      node.planes[axis][0][slot] = low[axis] - TREE_PADDING * reach;
      node.planes[axis][1][slot] = high[axis] + TREE_PADDING * reach;
    }
    node.child[slot] = child;
  }

  RTCBounds bounds_of(const BinaryNode& leaf) const {
    glm::vec3 low(INFINITY), high(-INFINITY);
    for (uint32_t i = 0; i < leaf.triangles; ++i) {
      const TreeTriangle& t = triangles_[leaf.triangle[i]];
      low = glm::min(low, glm::min(t.a, glm::min(t.b, t.c)));
      high = glm::max(high, glm::max(t.a, glm::max(t.b, t.c)));
    }
    return {low.x, low.y, low.z, 0, high.x, high.y, high.z, 0};
  }

  /// `waiting` is how many entries lie on the stack at worst when a traversal comes to this node.
  uint32_t node(const BinaryNode& built, int depth, int waiting) {
    const std::vector<WideChild> children = wide_children(built, TREE_MAX_DEPTH - depth + 1);
    const int count = static_cast<int>(children.size());
    tree_.statistics.depth = std::max(tree_.statistics.depth, depth);
    tree_.statistics.stack = std::max(tree_.statistics.stack, waiting + count);
    const auto index = static_cast<uint32_t>(tree_.nodes.size());
    tree_.nodes.push_back(empty_node());
    for (int i = 0; i < count; ++i) {
      const BinaryNode& child = *children[i].node;
      const uint32_t reference = child.is_leaf() ? leaf(child) : node(child, depth + 1, waiting + count - 1);
      set_child(index, i, children[i].bounds, reference);
    }
    return index;
  }

  uint32_t leaf(const BinaryNode& built) {
    std::array<uint32_t, TREE_LEAF_WIDTH> order;
    const auto last = std::copy_n(built.triangle, built.triangles, order.begin());
    std::sort(order.begin(), last);
    TreeLeaf& leaf = tree_.leaves.emplace_back();
    for (auto& corner : leaf.corners)
      for (auto& axis : corner) std::ranges::fill(axis, NAN);
    std::ranges::fill(leaf.shape, TREE_EMPTY);
    std::ranges::fill(leaf.primitive, TREE_EMPTY);
    for (uint32_t i = 0; i < built.triangles; ++i) {
      const TreeTriangle& t = triangles_[order[i]];
      for (int axis = 0; axis < 3; ++axis) {
        leaf.corners[0][axis][i] = t.a[axis];
        leaf.corners[1][axis][i] = t.b[axis];
        leaf.corners[2][axis][i] = t.c[axis];
      }
      leaf.shape[i] = t.shape;
      leaf.primitive[i] = t.primitive;
    }
    return static_cast<uint32_t>(tree_.leaves.size() - 1) | TREE_LEAF_BIT;
  }

  std::span<const TreeTriangle> triangles_;
  Tree& tree_;
};

}  // namespace

std::vector<TreeTriangle> tree_triangles(const Scene& scene) {
  std::vector<TreeTriangle> triangles;
  for (size_t s = 0; s < scene.shapes.size(); ++s) {
    const Shape& shape = scene.shapes[s];
    const auto* mesh = std::get_if<Mesh>(&shape.geometry);
    if (mesh == nullptr) continue;
    for (const glm::vec3& p : mesh->positions)
      if (glm::any(glm::greaterThan(glm::abs(p), glm::vec3(TREE_MAX_COORDINATE))))
        throw Error(shape.where, "shape '" + shape.name + "' reaches further than 1e12 m from the origin",
                    "check its unit, its transform and its file");
    triangles.reserve(triangles.size() + mesh->triangles.size());
    for (size_t i = 0; i < mesh->triangles.size(); ++i) {
      const glm::uvec3 t = mesh->triangles[i];
      triangles.push_back({mesh->positions[t.x], mesh->positions[t.y], mesh->positions[t.z],
                           static_cast<uint32_t>(s), static_cast<uint32_t>(i)});
    }
  }
  return triangles;
}

Tree build_tree(std::span<const TreeTriangle> triangles, unsigned threads) {
  const auto start = std::chrono::steady_clock::now();
  if (triangles.size() >= TREE_MAX_TRIANGLES)
    throw Error({}, std::to_string(triangles.size()) + " triangles are more than a ray can name",
                "use meshes with fewer than 2^29 triangles");
  Tree tree;
  try {
    std::vector<RTCBuildPrimitive> primitives = build_primitives(triangles);
    tree.statistics.triangles = primitives.size();
    tree.statistics.dropped = triangles.size() - primitives.size();
    const BinaryTree binary(std::move(primitives), threads);
    if (binary.root() != nullptr && !binary.root()->is_leaf()) weigh(*binary.root());
    Flattener(triangles, tree).flatten(binary.root());
    assert(tree.statistics.depth <= TREE_MAX_DEPTH && tree.statistics.stack <= TREE_STACK_SIZE);
  } catch (const std::bad_alloc&) {
    out_of_memory(triangles.size());
  }
  tree.statistics.bytes = tree.nodes.size() * sizeof(TreeNode) + tree.leaves.size() * sizeof(TreeLeaf);
  tree.statistics.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return tree;
}

}  // namespace vitrum
