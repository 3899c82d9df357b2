// The photon map's tree: every photon once, leaves full, boxes tight, the same bits every time.
#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <random>

#include "render/photon_tree.hpp"

using namespace vitrum;

namespace {

std::vector<cl_float8> random_photons(size_t count, bool in_one_place = false) {
  std::mt19937 bits(3);
  std::uniform_real_distribution<float> place(-1.0f, 1.0f);
  std::vector<cl_float8> photons(count);
  for (size_t i = 0; i < count; ++i) {
    cl_float8& p = photons[i];
    for (size_t axis = 0; axis < 3; ++axis) p.s[axis] = in_one_place ? 0.5f : place(bits);
    p.s[PHOTON_DIRECTION] = std::bit_cast<float>(static_cast<uint32_t>(bits() & 0x3fffffff));
    for (size_t channel = 0; channel < 3; ++channel) p.s[PHOTON_POWER + channel] = static_cast<float>(3 * i + channel);
  }
  return photons;
}

float field(const PhotonTree& tree, size_t photon, size_t f) {
  return tree.leaves[(photon / 8 * PHOTON_FIELDS + f) * 8 + photon % 8];
}

/// Photons of `tree` below child `child` of node `node` of `level`, as a range.
std::pair<size_t, size_t> photons_below(size_t level, size_t node, size_t child, size_t count) {
  const size_t photons_per_child = size_t{8} << (3 * (level - 1));
  const size_t first = (8 * node + child) * photons_per_child;
  return {std::min(first, count), std::min(first + photons_per_child, count)};
}

void check_tree(const std::vector<cl_float8>& photons) {
  const size_t count = photons.size(), leaves = (count + 7) / 8;
  CAPTURE(count);
  const PhotonTree tree = build_photon_tree(photons);

  REQUIRE(tree.leaves.size() == leaves * 8 * PHOTON_FIELDS);
  std::vector<bool> found(count, false);
  size_t wrong_photons = 0;
  for (size_t i = 0; i < leaves * 8; ++i) {
    if (i >= count) {
      wrong_photons += field(tree, i, PHOTON_X) != PHOTON_OFF_TREE;
      continue;
    }
    const size_t original = static_cast<size_t>(field(tree, i, PHOTON_POWER)) / 3;
    REQUIRE(original < count);
    wrong_photons += found[original];
    found[original] = true;
    for (size_t f = 0; f < PHOTON_FIELDS; ++f)
      wrong_photons += std::bit_cast<uint32_t>(field(tree, i, f)) != std::bit_cast<uint32_t>(photons[original].s[f]);
  }
  CHECK(wrong_photons == 0);

  size_t width = leaves, nodes = 0;
  uint32_t level = 0;
  size_t wrong_boxes = 0;
  while (width > 1) {
    width = (width + 7) / 8;
    ++level;
    REQUIRE(level <= tree.shape.top);
    CHECK(tree.shape.first_node[level] == nodes);
    for (size_t node = 0; node < width; ++node)
      for (size_t child = 0; child < 8; ++child) {
        glm::vec3 low(PHOTON_OFF_TREE), high(-PHOTON_OFF_TREE), low_direction = low, high_direction = high;
        const auto [first, last] = photons_below(level, node, child, count);
        for (size_t i = first; i < last; ++i) {
          const int32_t d = std::bit_cast<int32_t>(field(tree, i, PHOTON_DIRECTION));
          const glm::vec3 p(field(tree, i, PHOTON_X), field(tree, i, PHOTON_Y), field(tree, i, PHOTON_Z));
          const glm::vec3 direction(d << 22 >> 22, d << 12 >> 22, d << 2 >> 22);
          low = glm::min(low, p);
          high = glm::max(high, p);
          low_direction = glm::min(low_direction, direction);
          high_direction = glm::max(high_direction, direction);
        }
        for (int axis = 0; axis < 3; ++axis) {
          auto row = [&](size_t r) {
            return tree.nodes[((nodes + node) * PHOTON_NODE_ROWS + r + static_cast<size_t>(axis)) * 8 + child];
          };
          wrong_boxes += row(PHOTON_NODE_LOW) != low[axis];
          wrong_boxes += row(PHOTON_NODE_HIGH) != high[axis];
          wrong_boxes += row(PHOTON_NODE_LOW_DIRECTION) != low_direction[axis];
          wrong_boxes += row(PHOTON_NODE_HIGH_DIRECTION) != high_direction[axis];
        }
      }
    nodes += width;
  }
  CHECK(level == tree.shape.top);
  CHECK(tree.nodes.size() == nodes * 8 * PHOTON_NODE_ROWS);
  CHECK(wrong_boxes == 0);
}

}  // namespace

TEST_CASE("the photon tree holds every photon once, in full leaves and tight boxes") {
  for (size_t count : {1, 7, 8, 9, 63, 64, 65, 512, 513, 4097, 100'000}) check_tree(random_photons(count));
  check_tree(random_photons(5000, true));
}

TEST_CASE("the photon tree keeps apart what lies apart") {
  // Of two clusters of 64, each child of the root has photons of one alone.
  std::vector<cl_float8> photons = random_photons(128);
  for (size_t i = 0; i < 128; ++i) photons[i].s[1] += i % 2 == 0 ? 10.0f : -10.0f;
  const PhotonTree tree = build_photon_tree(photons);
  for (size_t i = 0; i < 128; ++i) CHECK(field(tree, i, PHOTON_Y) * (i < 64 ? -1.0f : 1.0f) > 0.0f);
}

TEST_CASE("the photon tree is the same every time") {
  const std::vector<cl_float8> photons = random_photons(100'000);
  const PhotonTree a = build_photon_tree(photons), b = build_photon_tree(photons);
  CHECK(a.leaves.size() == b.leaves.size());
  CHECK(std::equal(a.leaves.begin(), a.leaves.end(), b.leaves.begin(), [](float x, float y) {
    return std::bit_cast<uint32_t>(x) == std::bit_cast<uint32_t>(y);
  }));
  CHECK(a.nodes == b.nodes);
}
