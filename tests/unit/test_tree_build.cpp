// The builder of the tree: structure, bounds, determinism, bad triangles.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <set>

#include "scene/wide_nodes.hpp"

using namespace vitrum;

namespace {

std::vector<TreeTriangle> soup(size_t count, float size) {
  std::mt19937 generator(7);
  std::uniform_real_distribution<float> uniform(-1, 1);
  const auto random = [&] { return glm::vec3(uniform(generator), uniform(generator), uniform(generator)); };
  std::vector<TreeTriangle> triangles(count);
  for (uint32_t i = 0; i < count; ++i) {
    const glm::vec3 centre = random();
    triangles[i] = {centre + size * random(), centre + size * random(), centre + size * random(), i % 3, i / 3};
  }
  return triangles;
}

/// Walks the tree as a traversal that meets every box would, and checks whatever the kernels rely on.
class Walk {
 public:
  explicit Walk(const Tree& tree) : tree_(tree) {
    depth = stack = 0;
    if (!tree.nodes.empty()) node(0, 1, 0, {});
  }

  std::multiset<std::pair<uint32_t, uint32_t>> met;
  int depth, stack;

 private:
  using Boxes = std::vector<std::pair<glm::vec3, glm::vec3>>;

  void node(uint32_t index, int level, int waiting, Boxes boxes) {
    REQUIRE(index < tree_.nodes.size());
    const kernel::TreeNode& n = tree_.nodes[index];
    int children = 0;
    for (const uint32_t child : n.child) children += child != TREE_EMPTY;
    depth = std::max(depth, level);
    stack = std::max({stack, waiting + children, 1});
    for (int i = 0; i < TREE_WIDTH; ++i) {
      const glm::vec3 low(n.planes[0][0][i], n.planes[1][0][i], n.planes[2][0][i]);
      const glm::vec3 high(n.planes[0][1][i], n.planes[1][1][i], n.planes[2][1][i]);
      if (n.child[i] == TREE_EMPTY) {
        CHECK(low == glm::vec3(INFINITY));
        CHECK(high == glm::vec3(-INFINITY));
        continue;
      }
      boxes.emplace_back(low, high);
      if (n.child[i] & TREE_LEAF_BIT)
        leaf(n.child[i] & ~TREE_LEAF_BIT, boxes);
      else
        node(n.child[i], level + 1, waiting + children - 1, boxes);
      boxes.pop_back();
    }
  }

  void leaf(uint32_t index, const Boxes& boxes) {
    REQUIRE(index < tree_.leaves.size());
    const kernel::TreeLeaf& leaf = tree_.leaves[index];
    for (int i = 0; i < TREE_LEAF_WIDTH; ++i) {
      if (leaf.shape[i] == TREE_EMPTY) {
        CHECK(std::isnan(leaf.corners[0][0][i]));
        continue;
      }
      met.emplace(leaf.shape[i], leaf.primitive[i]);
      bool inside = true;
      for (const auto& [low, high] : boxes)
        for (const auto& corner : leaf.corners) {
          const glm::dvec3 p(corner[0][i], corner[1][i], corner[2][i]);
          const double padding = 0.9 * TREE_PADDING * std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
          inside &= glm::all(glm::lessThanEqual(glm::dvec3(low), p - padding));
          inside &= glm::all(glm::lessThanEqual(p + padding, glm::dvec3(high)));
        }
      CHECK(inside);
    }
  }

  const Tree& tree_;
};

bool same_bits(const Tree& a, const Tree& b) {
  const auto same = [](const auto& x, const auto& y) {
    return x.size() == y.size() && (x.empty() || std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0);
  };
  return same(a.nodes, b.nodes) && same(a.leaves, b.leaves);
}

void check_structure(const Tree& tree, const std::vector<TreeTriangle>& expected) {
  const Walk walk(tree);
  std::multiset<std::pair<uint32_t, uint32_t>> all;
  for (const TreeTriangle& t : expected) all.emplace(t.shape, t.primitive);
  CHECK(walk.met == all);
  CHECK(tree.statistics.triangles == expected.size());
  CHECK(walk.depth == tree.statistics.depth);
  CHECK(walk.stack == tree.statistics.stack);
  CHECK(tree.statistics.depth <= TREE_MAX_DEPTH);
  CHECK(tree.statistics.stack <= TREE_STACK_SIZE);
  CHECK(tree.statistics.bytes ==
        tree.nodes.size() * sizeof(kernel::TreeNode) + tree.leaves.size() * sizeof(kernel::TreeLeaf));
}

}  // namespace

TEST_CASE("every triangle lies in one leaf, within every box above it") {
  for (const size_t count : {1, 2, 4, 5, 33, 1000, 20000}) {
    CAPTURE(count);
    const auto triangles = soup(count, 0.05f);
    check_structure(build_tree(triangles), triangles);
  }
}

TEST_CASE("no triangles make a root without children") {
  const Tree tree = build_tree({});
  REQUIRE(tree.nodes.size() == 1);
  CHECK(tree.leaves.empty());
  check_structure(tree, {});
}

TEST_CASE("the tree does not hang on the number of threads") {
  const auto triangles = soup(100000, 0.02f);
  const Tree tree = build_tree(triangles, 1);
  CHECK(same_bits(tree, build_tree(triangles, 2)));
  CHECK(same_bits(tree, build_tree(triangles, 4)));
  CHECK(same_bits(tree, build_tree(triangles)));
}

TEST_CASE("triangles that split badly stay within the stack") {
  SUBCASE("all the same") {
    std::vector<TreeTriangle> triangles(20000, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    for (uint32_t i = 0; i < triangles.size(); ++i) triangles[i].primitive = i;
    check_structure(build_tree(triangles), triangles);
  }
  SUBCASE("each half the size of the one before") {
    std::vector<TreeTriangle> triangles;
    for (uint32_t i = 0; i < 400; ++i) {
      const float s = 1e9f * std::pow(0.8f, static_cast<float>(i));
      triangles.push_back({{s, 0, 0}, {0, s, 0}, {0, 0, s}, 0, i});
    }
    check_structure(build_tree(triangles), triangles);
  }
  SUBCASE("each half the size of the one before, and many where they end") {
    std::vector<TreeTriangle> triangles;
    for (float s = 1e12f; s > 1e-22f; s *= 0.8f)
      triangles.push_back({{s, 0, 0}, {0, s, 0}, {0, 0, s}, 0, static_cast<uint32_t>(triangles.size())});
    for (int i = 0; i < 30000; ++i) {
      const float s = 1e-22f / (1.0f + 0.003f * static_cast<float>(i));
      triangles.push_back({{s, 0, 0}, {0, s, 0}, {0, 0, s}, 0, static_cast<uint32_t>(triangles.size())});
    }
    check_structure(build_tree(triangles), triangles);
  }
  SUBCASE("along a line, each farther") {
    std::vector<TreeTriangle> triangles;
    for (uint32_t i = 0; i < 400; ++i) {
      const float x = 1e-6f * std::pow(1.1f, static_cast<float>(i));
      triangles.push_back({{x, 0, 0}, {x, 1e-6f, 0}, {x, 0, 1e-6f}, 0, i});
    }
    check_structure(build_tree(triangles), triangles);
  }
}

TEST_CASE("what no ray can hit is left out") {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  auto triangles = soup(50, 0.1f);
  const auto good = triangles;
  triangles.push_back({{nan, 0, 0}, {1, 0, 0}, {0, 1, 0}, 9, 0});
  triangles.push_back({{0, 0, 0}, {1, infinity, 0}, {0, 1, 0}, 9, 1});
  triangles.push_back({{0, 0, 0}, {1, 0, 0}, {0, 1, -2e12f}, 9, 2});
  triangles.push_back({{1, 2, 3}, {1, 2, 3}, {0, 1, 0}, 9, 3});
  triangles.push_back({{0, 0, 0}, {1, 1, 1}, {3, 3, 3}, 9, 4});
  const Tree tree = build_tree(triangles);
  CHECK(tree.statistics.dropped == 5);
  check_structure(tree, good);

  const Tree none = build_tree(std::span(triangles).subspan(50));
  CHECK(none.statistics.dropped == 5);
  check_structure(none, {});
}

TEST_CASE("meshes of a scene, and nothing else, become triangles") {
  Scene scene;
  scene.shapes.resize(3);
  scene.shapes[0].geometry = Sphere{};
  scene.shapes[1].geometry = Triangle{};
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.shapes[2].geometry = mesh;
  scene.shapes[2].name = "far";
  scene.shapes[2].where = {"a.toml", 12, 3};
  const auto triangles = tree_triangles(scene);
  REQUIRE(triangles.size() == 2);
  CHECK(triangles[1].shape == 2);
  CHECK(triangles[1].primitive == 1);
  CHECK(triangles[1].b == glm::vec3(0, 1, 0));

  std::get<Mesh>(scene.shapes[2].geometry).positions[3].z = -3e12f;
  CHECK_THROWS_WITH_AS(tree_triangles(scene),
                       "a.toml:12:3: shape 'far' reaches further than 1e12 m from the origin; "
                       "check its unit, its transform and its file",
                       Error);
}

namespace {

/// What a ray is expected to spend below `node`, and how many levels of wide nodes there are from it on.
struct Spent {
  float cost = 0.0f;
  int levels = 1;
};

Spent spent(const BinaryNode& node, int levels) {
  REQUIRE(levels > 0);
  const std::vector<WideChild> children = wide_children(node, levels);
  CHECK(children.size() >= 2);
  CHECK(children.size() <= TREE_WIDTH);
  Spent sum;
  for (const auto& [child, b] : children) {
    const float x = b.upper_x - b.lower_x, y = b.upper_y - b.lower_y, z = b.upper_z - b.lower_z;
    sum.cost += x * y + y * z + z * x;
    if (child->is_leaf()) continue;
    const Spent below = spent(*child, levels - 1);
    sum.cost += below.cost;
    sum.levels = std::max(sum.levels, 1 + below.levels);
  }
  return sum;
}

}  // namespace

TEST_CASE("wide nodes cost what was weighed, less than the flattest, and no more levels than there may be") {
  for (const size_t count : {9, 300, 20000}) {
    CAPTURE(count);
    std::vector<RTCBuildPrimitive> boxes;
    for (const TreeTriangle& t : soup(count, 0.02f)) {
      const glm::vec3 low = glm::min(t.a, glm::min(t.b, t.c)), high = glm::max(t.a, glm::max(t.b, t.c));
      boxes.push_back({low.x, low.y, low.z, 0, high.x, high.y, high.z, static_cast<uint32_t>(boxes.size())});
    }
    const BinaryTree binary(boxes, 1);
    weigh(*binary.root());
    const int least_levels = (binary.root()->height + 2) / 3;
    const Spent best = spent(*binary.root(), TREE_MAX_DEPTH), flattest = spent(*binary.root(), least_levels);
    CHECK(best.cost == doctest::Approx(binary.root()->cost[TREE_WIDTH - 1]).epsilon(1e-4));
    CHECK(flattest.levels <= least_levels);
    CHECK(best.cost <= flattest.cost);
    if (count == 20000) CHECK(best.cost < 0.97f * flattest.cost);
  }
}
