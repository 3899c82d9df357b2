#include "scene/binary_tree.hpp"

#include <cassert>
#include <cstddef>
#include <new>
#include <string>

namespace vitrum {

namespace {

void* create_node(RTCThreadLocalAllocator allocator, unsigned int, void*) {
  auto* node = static_cast<BinaryNode*>(rtcThreadLocalAlloc(allocator, sizeof(BinaryNode), alignof(BinaryNode)));
  node->triangles = 0;
  return node;
}

void set_children(void* node, void** children, unsigned int count, void*) {
  for (unsigned int i = 0; i < count; ++i)
    static_cast<BinaryNode*>(node)->child[i] = static_cast<BinaryNode*>(children[i]);
}

void set_bounds(void* node, const RTCBounds** bounds, unsigned int count, void*) {
  for (unsigned int i = 0; i < count; ++i) static_cast<BinaryNode*>(node)->bounds[i] = *bounds[i];
}

void* create_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, size_t count, void*) {
  assert(count <= TREE_LEAF_WIDTH);
  auto* node =
      static_cast<BinaryNode*>(rtcThreadLocalAlloc(allocator, offsetof(BinaryNode, child), alignof(BinaryNode)));
  node->triangles = static_cast<uint32_t>(count);
  for (size_t i = 0; i < count; ++i) node->leaf.triangle[i] = primitives[i].primID;
  return node;
}

/// Throws unless `made`, with what Embree says about it.
void check(bool made, RTCDevice device) {
  if (made) return;
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  throw Error({}, "Embree failed with its error " + std::to_string(error) + " at building the tree",
              "check that Debian's libembree3 fits this machine");
}

}  // namespace

BinaryTree::BinaryTree(std::vector<RTCBuildPrimitive> boxes, unsigned threads)
    : device_(rtcNewDevice(("threads=" + std::to_string(threads)).c_str())) {
  check(device_ != nullptr, nullptr);
  bvh_.reset(rtcNewBVH(device_.get()));
  check(bvh_ != nullptr, device_.get());
  if (boxes.empty()) return;

  RTCBuildArguments arguments = rtcDefaultBuildArguments();
  arguments.buildQuality = RTC_BUILD_QUALITY_MEDIUM;
  arguments.maxBranchingFactor = 2;
  arguments.maxDepth = binary_max_height;
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
  root_ = static_cast<BinaryNode*>(rtcBuildBVH(&arguments));
  check(root_ != nullptr, device_.get());
}

}  // namespace vitrum
