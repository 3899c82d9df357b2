#include "scene/wide_nodes.hpp"

#include <algorithm>
#include <cmath>

namespace vitrum {

namespace {

// A wide node and a leaf take about the same time.
constexpr float node_cost = 1.0f, leaf_cost = 1.0f;

/// The probability that a ray enters goes by it (Goldsmith and Salmon, Automatic Creation of Object Hierarchies for Ray
/// Tracing, 1987).
float half_area(const RTCBounds& b) {
  const float x = b.upper_x - b.lower_x, y = b.upper_y - b.lower_y, z = b.upper_z - b.lower_z;
  return x * y + y * z + z * x;
}

int height_of(const BinaryNode& node) { return node.is_leaf() ? 0 : node.height; }

/// What a node costs that becomes up to `count` children of a wide one.
float cost_of(const BinaryNode& node, float area, int count) {
  return node.is_leaf() ? area * leaf_cost : node.cost[count - 1];
}

/// By dynamic programming from the leaves upwards (Ylitie, Karras and Laine, Efficient Incoherent Ray Traversal on GPUs
/// Through Compressed Wide BVHs, 2017): cost[i - 1] is the least cost of the node as up to i children of a wide one, of
/// which to_first[i - 1] are its first child's; 0: i - 1 children are no dearer. A node that is one child is the root
/// of a wide node itself, for which cost[TREE_WIDTH - 1] and to_first[TREE_WIDTH - 1] stand.
void weigh(BinaryNode& node, float area) {
  float areas[2];
  for (int k = 0; k < 2; ++k) {
    areas[k] = half_area(node.bounds[k]);
    if (!node.child[k]->is_leaf()) weigh(*node.child[k], areas[k]);
  }
  node.height = static_cast<uint8_t>(1 + std::max(height_of(*node.child[0]), height_of(*node.child[1])));
  for (int i = 2; i <= TREE_WIDTH; ++i) {
    float& least = node.cost[i - 1] = INFINITY;
    for (int first = 1; first < i; ++first) {
      const float cost = cost_of(*node.child[0], areas[0], first) + cost_of(*node.child[1], areas[1], i - first);
      if (cost < least || first == 1) {
        least = cost;
        node.to_first[i - 1] = static_cast<uint8_t>(first);
      }
    }
  }
  node.cost[0] = area * node_cost + node.cost[TREE_WIDTH - 1];
  for (int i = 2; i < TREE_WIDTH; ++i)
    if (node.cost[i - 2] <= node.cost[i - 1]) {
      node.cost[i - 1] = node.cost[i - 2];
      node.to_first[i - 1] = 0;
    }
}

void open(const BinaryNode& node, int count, std::vector<WideChild>& children);

/// Adds a node as up to `count` children.
void add(const WideChild& child, int count, std::vector<WideChild>& children) {
  if (!child.node->is_leaf())
    while (count > 1 && child.node->to_first[count - 1] == 0) --count;
  if (child.node->is_leaf() || count == 1)
    children.push_back(child);
  else
    open(*child.node, count, children);
}

void open(const BinaryNode& node, int count, std::vector<WideChild>& children) {
  const int first = node.to_first[count - 1];
  add({node.child[0], node.bounds[0]}, first, children);
  add({node.child[1], node.bounds[1]}, count - first, children);
}

/// The tallest nodes are opened first. Of the height of `node` and one and two less there are at most seven, so that
/// all of them are.
std::vector<WideChild> flattest(const BinaryNode& node) {
  std::vector<WideChild> children{{node.child[0], node.bounds[0]}, {node.child[1], node.bounds[1]}};
  while (children.size() < TREE_WIDTH) {
    const auto tallest = std::ranges::max_element(
        children, [](const WideChild& a, const WideChild& b) { return height_of(*a.node) < height_of(*b.node); });
    const BinaryNode& opened = *tallest->node;
    if (opened.is_leaf()) break;
    *tallest = {opened.child[0], opened.bounds[0]};
    children.push_back({opened.child[1], opened.bounds[1]});
  }
  return children;
}

}  // namespace

void weigh(BinaryNode& root) {
  weigh(root, 0.0f);  // whatever the root's own area is, it is entered once
}

std::vector<WideChild> wide_children(const BinaryNode& node, int levels) {
  if (node.height - 1 > 3 * (levels - 1)) return flattest(node);
  std::vector<WideChild> children;
  open(node, TREE_WIDTH, children);
  return children;
}

}  // namespace vitrum
