#include "render/photon_tree.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <future>

#include "render/photon_pass.hpp"

namespace vitrum {
namespace {

constexpr size_t leaf_size = 8, node_size = 8;
constexpr size_t leaf_floats = PHOTON_FIELDS * leaf_size, node_floats = PHOTON_NODE_ROWS * node_size;
constexpr size_t leaves_worth_a_thread = 2048;
static_assert(most_nearest_photons == MAX_NEAREST);
constexpr int most_forks = 3;           // along each way down the tree

/// What the sort moves about; the index breaks ties and finds the rest.
struct Place {
  glm::vec3 position;
  uint32_t index;
};

struct Bounds {
  glm::vec3 low{PHOTON_OFF_TREE}, high{-PHOTON_OFF_TREE};
  glm::vec3 low_direction{PHOTON_OFF_TREE}, high_direction{-PHOTON_OFF_TREE};

  void add(const Bounds& other) {
    low = glm::min(low, other.low);
    high = glm::max(high, other.high);
    low_direction = glm::min(low_direction, other.low_direction);
    high_direction = glm::max(high_direction, other.high_direction);
  }
};

/// Orders places so that each leaf's stand together, and the leaves of each node of a left-balanced tree.
void sort_places(std::span<Place> places, int forks) {
  const size_t leaves = (places.size() + leaf_size - 1) / leaf_size;
  if (leaves < 2) return;
  glm::vec3 low = places[0].position, high = low;
  for (const Place& place : places) {
    low = glm::min(low, place.position);
    high = glm::max(high, place.position);
  }
  const glm::vec3 extent = high - low;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  // The left half has a power of two of leaves, all full.
  const size_t left = std::bit_ceil(leaves) / 2 * leaf_size;
  std::nth_element(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(left), places.end(),
                   [axis](const Place& a, const Place& b) {
                     return a.position[axis] != b.position[axis] ? a.position[axis] < b.position[axis]
                                                                 : a.index < b.index;
                   });
  std::future<void> other;
  if (forks > 0 && leaves > leaves_worth_a_thread) {
    other = std::async(std::launch::async, sort_places, places.first(left), forks - 1);
  } else {
    sort_places(places.first(left), 0);
  }
  sort_places(places.subspan(left), forks - 1);
  if (other.valid()) other.get();
}

glm::vec3 unpacked_direction(float packed) {
  const int32_t bits = std::bit_cast<int32_t>(packed);
  return {static_cast<float>(bits << 22 >> 22), static_cast<float>(bits << 12 >> 22),
          static_cast<float>(bits << 2 >> 22)};
}

}  // namespace

PhotonTree build_photon_tree(std::span<const cl_float8> photons) {
  assert(!photons.empty());
  std::vector<Place> places(photons.size());
  for (uint32_t i = 0; i < photons.size(); ++i)
    places[i] = {{photons[i].s[0], photons[i].s[1], photons[i].s[2]}, i};
  sort_places(places, most_forks);

  PhotonTree tree;
  std::vector<Bounds> bounds((photons.size() + leaf_size - 1) / leaf_size);  // of each leaf, later of each node
  tree.leaves.resize(bounds.size() * leaf_floats);
  for (size_t i = 0; i < bounds.size() * leaf_size; ++i) {
    float* leaf = &tree.leaves[i / leaf_size * leaf_floats + i % leaf_size];
    if (i >= places.size()) {
      for (size_t axis = 0; axis < 3; ++axis) leaf[(PHOTON_X + axis) * leaf_size] = PHOTON_OFF_TREE;
      continue;
    }
    const cl_float8& photon = photons[places[i].index];
    for (size_t field = 0; field < PHOTON_FIELDS; ++field) leaf[field * leaf_size] = photon.s[field];
    const glm::vec3 position = places[i].position, direction = unpacked_direction(photon.s[PHOTON_DIRECTION]);
    bounds[i / leaf_size].add({position, position, direction, direction});
  }

  while (bounds.size() > 1) {
    ++tree.shape.top;
    assert(tree.shape.top < PHOTON_TREE_LEVELS);
    const size_t first = tree.nodes.size() / node_floats;
    tree.shape.first_node[tree.shape.top] = static_cast<uint32_t>(first);
    std::vector<Bounds> parents((bounds.size() + node_size - 1) / node_size);
    bounds.resize(parents.size() * node_size);
    tree.nodes.resize((first + parents.size()) * node_floats);
    for (size_t i = 0; i < bounds.size(); ++i) {
      float* node = &tree.nodes[(first + i / node_size) * node_floats + i % node_size];
      for (int axis = 0; axis < 3; ++axis) {
        const auto row = static_cast<size_t>(axis);
        node[(PHOTON_NODE_LOW + row) * node_size] = bounds[i].low[axis];
        node[(PHOTON_NODE_HIGH + row) * node_size] = bounds[i].high[axis];
        node[(PHOTON_NODE_LOW_DIRECTION + row) * node_size] = bounds[i].low_direction[axis];
        node[(PHOTON_NODE_HIGH_DIRECTION + row) * node_size] = bounds[i].high_direction[axis];
      }
      parents[i / node_size].add(bounds[i]);
    }
    bounds = std::move(parents);
  }
  return tree;
}

void fill_photon_tree(Device& device, PhotonMap& map, std::span<const cl_float8> photons, double max_radius) {
  map.count = static_cast<uint32_t>(photons.size());
  map.radius = static_cast<float>(max_radius);
  if (map.count == 0) return;
  const PhotonTree tree = build_photon_tree(photons);
  map.tree = tree.shape;
  auto fill = [&device](Buffer<float>& buffer, const std::vector<float>& values) {
    if (buffer.size() < values.size()) buffer = device.allocate<float>(values.size(), "photon map");
    if (!values.empty()) device.write(buffer, values);
  };
  fill(map.leaves, tree.leaves);
  fill(map.nodes, tree.nodes);
}

}  // namespace vitrum
