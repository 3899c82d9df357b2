#include "scene/bodies.hpp"

#include <bit>
#include <unordered_map>

namespace vitrum {
namespace {

/// Finaliser of SplitMix64 (Steele, Lea and Flood 2014).
uint64_t mixed(uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

uint64_t hash_of(const glm::vec3& p) {
  uint64_t hash = 0;
  for (int axis = 0; axis < 3; ++axis) hash = mixed(hash + 0x9e3779b97f4a7c15u + std::bit_cast<uint32_t>(p[axis] + 0.0f));
  return hash;
}

}  // namespace

std::vector<Body> bodies_of(const Mesh& mesh) {
  std::vector<uint64_t> corners(mesh.positions.size());
  for (size_t i = 0; i < corners.size(); ++i) corners[i] = hash_of(mesh.positions[i]);

  // Edges of the one direction less those of the other, as a sum of hashes: 0 where they are the same set, and otherwise
  // in one case of 2^64.
  std::vector<Body> bodies;
  std::vector<uint64_t> open;
  std::unordered_map<uint32_t, size_t> numbers;
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto [place, is_new] = numbers.try_emplace(mesh.materials[i], bodies.size());
    if (is_new) {
      const glm::vec3 corner = mesh.positions[mesh.triangles[i].x];
      bodies.push_back({mesh.materials[i], corner, corner});
      open.push_back(0);
    }
    const glm::uvec3 t = mesh.triangles[i];
    Body& body = bodies[place->second];
    for (int k = 0; k < 3; ++k) {
      const uint64_t a = corners[t[k]], b = corners[t[(k + 1) % 3]];
      body.low = glm::min(body.low, mesh.positions[t[k]]);
      body.high = glm::max(body.high, mesh.positions[t[k]]);
      open[place->second] += mixed(a + 3 * b) - mixed(b + 3 * a);
    }
  }
  for (size_t k = 0; k < bodies.size(); ++k) bodies[k].closed = open[k] == 0;
  return bodies;
}

}  // namespace vitrum
