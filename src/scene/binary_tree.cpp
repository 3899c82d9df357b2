#include "scene/binary_tree.hpp"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <new>
#include <string>

namespace vitrum {

namespace {

/// A node of Embree's is a balanced tree of one node less than it has children, the root first.
void* create_node(RTCThreadLocalAllocator allocator, unsigned int children, void*) {
  auto* nodes = static_cast<BinaryNode*>(
      rtcThreadLocalAlloc(allocator, (children - 1) * sizeof(BinaryNode), alignof(BinaryNode)));
  for (unsigned int i = 0; i + 1 < children; ++i) nodes[i].triangles = 0;
  return nodes;
}

/// Hands children [first, last) and nodes[0] to nodes[last - first - 2] out: `one(node, which, child)` for each child,
/// `two(node, which, below)` for each node below another.
template <typename One, typename Two>
void deal_out(BinaryNode* nodes, unsigned int first, unsigned int last, const One& one, const Two& two) {
  const unsigned int middle = (first + last + 1) / 2;
  const auto half = [&](int which, unsigned int begin, unsigned int end, BinaryNode* below) {
    if (end - begin == 1) {
      one(*nodes, which, begin);
    } else {
      deal_out(below, begin, end, one, two);
      two(*nodes, which, below);
    }
  };
  half(0, first, middle, nodes + 1);
  half(1, middle, last, nodes + (middle - first));
}

void set_children(void* node, void** children, unsigned int count, void*) {
  deal_out(
      static_cast<BinaryNode*>(node), 0, count,
      [&](BinaryNode& parent, int which, unsigned int i) { parent.child[which] = static_cast<BinaryNode*>(children[i]); },
      [](BinaryNode& parent, int which, BinaryNode* below) { parent.child[which] = below; });
}

RTCBounds both(const RTCBounds& a, const RTCBounds& b) {
  return {std::min(a.lower_x, b.lower_x), std::min(a.lower_y, b.lower_y), std::min(a.lower_z, b.lower_z), 0,
          std::max(a.upper_x, b.upper_x), std::max(a.upper_y, b.upper_y), std::max(a.upper_z, b.upper_z), 0};
}

void set_bounds(void* node, const RTCBounds** bounds, unsigned int count, void*) {
  deal_out(
      static_cast<BinaryNode*>(node), 0, count,
      [&](BinaryNode& parent, int which, unsigned int i) { parent.bounds[which] = *bounds[i]; },
      [](BinaryNode& parent, int which, BinaryNode* below) {
        parent.bounds[which] = both(below->bounds[0], below->bounds[1]);
      });
}

void* create_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, size_t count, void*) {
  assert(count <= TREE_LEAF_WIDTH);
  auto* node =
      static_cast<BinaryNode*>(rtcThreadLocalAlloc(allocator, offsetof(BinaryNode, child), alignof(BinaryNode)));
  node->triangles = static_cast<uint32_t>(count);
  for (size_t i = 0; i < count; ++i) node->triangle[i] = primitives[i].primID;
  return node;
}

[[noreturn]] void fail(RTCError error) {
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  throw Error({}, "Embree failed with its error " + std::to_string(error) + " at building the tree",
              "check that Debian's libembree3 fits this machine");
}

}  // namespace

BinaryTree::BinaryTree(std::vector<RTCBuildPrimitive> boxes, unsigned threads)
    : device_(rtcNewDevice(("threads=" + std::to_string(threads)).c_str())) {
  if (!device_) fail(rtcGetDeviceError(nullptr));
  if (boxes.empty()) return;
  // Where boxes lie in each other so deep that Embree gives up, it still makes wide nodes.
  root_ = built(boxes, 2, binary_max_height);
  if (root_ == nullptr)
    if (const RTCError error = rtcGetDeviceError(device_.get()); error != RTC_ERROR_UNKNOWN) fail(error);
  if (root_ == nullptr) root_ = built(boxes, TREE_WIDTH, TREE_MAX_DEPTH);
  if (root_ == nullptr) fail(rtcGetDeviceError(device_.get()));
}

BinaryNode* BinaryTree::built(std::vector<RTCBuildPrimitive>& boxes, unsigned children, unsigned depth) {
  bvh_.reset(rtcNewBVH(device_.get()));
  if (!bvh_) fail(rtcGetDeviceError(device_.get()));
  RTCBuildArguments arguments = rtcDefaultBuildArguments();
  arguments.buildQuality = RTC_BUILD_QUALITY_MEDIUM;
  arguments.maxBranchingFactor = children;
  arguments.maxDepth = depth;
  arguments.sahBlockSize = TREE_LEAF_WIDTH;
  arguments.minLeafSize = TREE_LEAF_WIDTH;  // a leaf costs the same however many of its lanes are full
  arguments.maxLeafSize = TREE_LEAF_WIDTH;
  arguments.bvh = bvh_.get();
  arguments.primitives = boxes.data();
  arguments.primitiveCount = arguments.primitiveArrayCapacity = boxes.size();
  arguments.createNode = create_node;
  arguments.setNodeChildren = set_children;
  arguments.setNodeBounds = set_bounds;
  arguments.createLeaf = create_leaf;
  return static_cast<BinaryNode*>(rtcBuildBVH(&arguments));
}

}  // namespace vitrum
