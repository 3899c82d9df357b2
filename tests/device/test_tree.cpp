// The tree's traversal on the device: against every triangle tested by itself, in double and on the device.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "device/opencl_harness.hpp"
#include "scene/tree.hpp"

using namespace vitrum;
using glm::dvec3;
using glm::vec3;

namespace {

constexpr int max_borders = 4;

struct RayData {
  vec3 origin{0}, direction{0};
  float t_min = 0, t_max = INFINITY;
};

struct HitData {
  float t = INFINITY;
  uint32_t shape = TREE_EMPTY, primitive = TREE_EMPTY;
  float u = 0, v = 0;
  uint32_t front = 0;
  bool operator==(const HitData&) const = default;
};

struct Result {
  HitData closest;                          ///< by the tree
  HitData brute;                            ///< by the same triangle test over every leaf
  std::array<HitData, max_borders> within;     ///< in [t_min, t_max]
  std::array<HitData, max_borders> brute_within;
  uint32_t any, within_count, brute_count, found;
};

const char* const kernel_text = R"(
#include "tree.h"

// Every leaf, without the tree, again and again: the first hits of TREE_MAX_BORDERS borders, in (t_min, t_max) or
// [t_min, t_max].
uint brute(const RayPacket* rays, uint lane, __global const TreeLeaf* leaves, uint n_leaves, int closed, Hit* hits) {
  const TreeRays r = tree_rays(rays);
  const float t_min = LANE(rays->t_min, float, lane), t_max = LANE(rays->t_max, float, lane);
  uint count = 0;
  for (int found = 1; found && count < TREE_MAX_BORDERS; count += found) {
    found = 0;
    for (uint n = 0; n < n_leaves; ++n) {
      float4 t, u, v;
      int4 front;
      const int4 met = tree_triangles(&r, lane, leaves + n, &t, &u, &v, &front);
      for (uint i = 0; i < TREE_LEAF_WIDTH; ++i) {
        if (!(tree_mask4(met) >> i & 1)) continue;
        const Hit hit = tree_hit(leaves + n, i, t, u, v, tree_mask4(front));
        if (closed ? hit.t < t_min || hit.t > t_max : hit.t <= t_min || hit.t >= t_max) continue;
        int known = 0;
        for (uint k = 0; k < count; ++k) known |= hits[k].shape == hit.shape && hits[k].front == hit.front;
        if (known || (found && !tree_before(&hit, &hits[count]))) continue;
        hits[count] = hit;
        found = 1;
      }
    }
  }
  return count;
}

HitPacket nothing() {
  HitPacket hits;
  hits.t = INFINITY;
  hits.shape = hits.primitive = (Uint)(TREE_EMPTY);
  hits.u = hits.v = 0.0f;
  hits.front = (Uint)(0);
  return hits;
}

// Rays that leave no triangle.
MeshRays free_rays() {
  MeshRays rays;
  rays.shape = rays.primitive = (Uint)(TREE_EMPTY);
  rays.front = (Uint)(0);
  rays.error = 0.0f;
  return rays;
}

typedef struct {
  Hit closest, brute, within[TREE_MAX_BORDERS], brute_within[TREE_MAX_BORDERS];
  uint any, within_count, brute_count, found;
} Result;

// WIDTH rays a work-item, of which every fourth packet leaves out every other.
__kernel void trace(__global const TreeNode* nodes, __global const TreeLeaf* leaves, uint n_leaves,
                    __global const float* rays, __global Result* results) {
  const size_t item = get_global_id(0);
  MeshRays packet = free_rays();
  for (uint i = 0; i < WIDTH; ++i) {
    __global const float* ray = rays + 8 * (WIDTH * item + i);
    set_lane3(&packet.rays.origin, i, vload3(0, ray));
    set_lane3(&packet.rays.direction, i, vload3(0, ray + 3));
    SET_LANE(packet.rays.t_min, float, i, ray[6]);
    SET_LANE(packet.rays.t_max, float, i, ray[7]);
  }
  const uint all = lane_bits(LANES < (Uint)(WIDTH)), some = item % 4 == 3 ? all & 0x5555u : all;
  HitPacket closest = nothing();
  uint found = tree_closest(&packet, some, nodes, leaves, &closest);
  uint any = tree_any(&packet, some, nodes, leaves);
  // Neither says or changes anything of those left out.
  int wrong = ((found | any) & ~some) != 0;
  for (uint bits = all & ~some; bits; bits &= bits - 1) wrong |= LANE(closest.t, float, lowest_bit(bits)) != INFINITY;
  if (wrong) found = any = 0;
  if (some != all) {
    found |= tree_closest(&packet, all & ~some, nodes, leaves, &closest);
    any |= tree_any(&packet, all & ~some, nodes, leaves);
  }

  const HitPacket empty = nothing();
  for (uint i = 0; i < WIDTH; ++i) {
    const Hit none = hit_of(&empty, i);
    Hit hits[TREE_MAX_BORDERS];
    Result result;
    result.closest = hit_of(&closest, i);
    result.found = found >> i & 1;
    result.any = any >> i & 1;
    result.brute = brute(&packet.rays, i, leaves, n_leaves, 0, hits) ? hits[0] : none;
    for (uint k = 0; k < TREE_MAX_BORDERS; ++k) result.within[k] = result.brute_within[k] = none;
    result.within_count =
        tree_borders_within(&packet.rays, i, nodes, leaves, LANE(packet.rays.t_min, float, i),
                            LANE(packet.rays.t_max, float, i), LANE3(packet.rays.origin, i), INFINITY, result.within);
    result.brute_count = brute(&packet.rays, i, leaves, n_leaves, 1, result.brute_within);
    results[WIDTH * item + i] = result;
  }
}

// hits may hold some already; u is the ray's t_max.
__kernel void improve(__global const TreeNode* nodes, __global const TreeLeaf* leaves, __global Hit* hits,
                      __global uint* found) {
  const size_t first = WIDTH * get_global_id(0);
  MeshRays packet = free_rays();
  packet.rays.origin = make_vec3(0.25f, 0.25f, 1.0f);
  packet.rays.direction = make_vec3(0.0f, 0.0f, -1.0f);
  packet.rays.t_min = 0.0f;
  HitPacket held;
  for (uint i = 0; i < WIDTH; ++i) {
    set_hit(&held, i, hits[first + i]);
    SET_LANE(packet.rays.t_max, float, i, hits[first + i].u);
  }
  const uint all = lane_bits(LANES < (Uint)(WIDTH));
  const uint replaced = tree_closest(&packet, all, nodes, leaves, &held), any = tree_any(&packet, all, nodes, leaves);
  for (uint i = 0; i < WIDTH; ++i) {
    hits[first + i] = hit_of(&held, i);
    found[first + i] = (replaced >> i & 1) | (any >> i & 1) << 1;
  }
}
)";

/// A way to build the kernels: rays of a packet, with the processor's own instructions or without.
struct Build {
  uint32_t width;
  const char* options;
};
constexpr Build builds[] = {{16, "-DWIDTH=16 "}, {8, "-DWIDTH=8 "}, {1, "-DWIDTH=1 -DVITRUM_PORTABLE "}};
constexpr size_t whole_groups = 16 * 64;    ///< of rays

struct TreeTracer {
  OpenClHarness cl;
  std::vector<cl::Program> programs;

  TreeTracer() {
    for (const Build& build : builds) programs.push_back(cl.build(kernel_text, build.options));
  }
  static const TreeTracer& get() {
    static const TreeTracer tracer;
    return tracer;
  }
};

std::vector<Result> trace(const std::vector<TreeTriangle>& triangles, std::vector<RayData> rays, size_t build = 0) {
  const TreeTracer& tracer = TreeTracer::get();
  const Tree tree = build_tree(triangles);
  const size_t count = rays.size();
  rays.resize((count + whole_groups - 1) / whole_groups * whole_groups, rays.back());
  const cl::Buffer results = tracer.cl.upload(std::vector<Result>(rays.size()));
  tracer.cl.run(tracer.programs[build], "trace", rays.size() / builds[build].width, tracer.cl.upload(tree.nodes),
                tracer.cl.upload(tree.leaves), static_cast<uint32_t>(tree.leaves.size()), tracer.cl.upload(rays),
                results);
  return tracer.cl.download<Result>(results, count);
}

/// The tree loses nothing and adds nothing: its answers are those of every triangle tested by itself, bit by bit.
void check_against_leaves(const std::vector<Result>& results) {
  size_t wrong_closest = 0, wrong_any = 0, wrong_within = 0;
  for (const Result& r : results) {
    wrong_closest += r.closest != r.brute || r.found != (r.brute.shape != TREE_EMPTY);
    wrong_any += r.any != r.found;
    wrong_within += r.within_count != r.brute_count || r.within != r.brute_within;
  }
  CHECK(wrong_closest == 0);
  CHECK(wrong_any == 0);
  CHECK(wrong_within == 0);
}

/// Where a ray stands to a triangle, in double.
struct Exact {
  double t;                                 ///< of the triangle's plane
  double inside;                            ///< least distance from the edges, seen along the ray; negative outside
  double error;                             ///< what the float test may be off by across the ray
  double t_error;                           ///< and in t
};

Exact exact(const RayData& ray, const TreeTriangle& triangle) {
  const dvec3 d(ray.direction), o(ray.origin);
  const std::array p{dvec3(triangle.a) - o, dvec3(triangle.b) - o, dvec3(triangle.c) - o};
  const dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
  const double facing = glm::dot(normal, d);
  double reach = 0;
  for (const dvec3& corner : p) reach = std::max(reach, glm::length(corner));
  Exact result{glm::dot(normal, p[0]) / facing, INFINITY, 1.5e-6 * reach, 0};
  for (int i = 0; i < 3; ++i) {
    const dvec3 &a = p[i], &b = p[(i + 1) % 3], side = glm::cross(d, b - a);
    result.inside = std::min(result.inside, glm::dot(side, a) * (facing > 0 ? -1 : 1) / glm::length(side));
  }
  result.t_error = result.error * (2 + glm::length(glm::cross(normal, d)) / std::abs(facing));
  return result;
}

/// No triangle that is clearly hit is missed, none that is clearly missed is hit.
void check_against_double(const std::vector<TreeTriangle>& triangles, const std::vector<RayData>& rays,
                          const std::vector<Result>& results) {
  size_t missed = 0, invented = 0, hits = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    const HitData& hit = results[i].closest;
    hits += results[i].found;
    for (const TreeTriangle& triangle : triangles) {
      const Exact e = exact(rays[i], triangle);
      const bool clear = e.inside > e.error && e.t - e.t_error > rays[i].t_min && e.t + e.t_error < rays[i].t_max;
      if (clear && !(hit.t <= e.t + e.t_error)) ++missed;
      if (hit.shape == triangle.shape && hit.primitive == triangle.primitive)
        if (e.inside < -e.error || std::abs(e.t - hit.t) > e.t_error) ++invented;
    }
  }
  CHECK(missed == 0);
  CHECK(invented == 0);
  CHECK(hits > 0);
}

class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}
  float operator()() { return uniform_(generator_); }
  vec3 vector() { return {(*this)(), (*this)(), (*this)()}; }
  vec3 direction() {
    vec3 v;
    do v = vector();
    while (glm::length(v) > 1 || glm::length(v) < 0.1f);
    return glm::normalize(v);
  }
  uint32_t below(size_t n) { return static_cast<uint32_t>(generator_() % n); }

 private:
  std::mt19937 generator_;
  std::uniform_real_distribution<float> uniform_{-1, 1};
};

/// `across` over `along` is the needles' aspect.
std::vector<TreeTriangle> soup(size_t count, float along, float across, float scale, vec3 offset, unsigned seed) {
  Random random(seed);
  std::vector<TreeTriangle> triangles;
  for (uint32_t i = 0; i < count; ++i) {
    const vec3 centre = random.vector(), u = random.direction(), v = random.direction();
    triangles.push_back({offset + scale * centre, offset + scale * (centre + along * u),
                         offset + scale * (centre + along * u * (0.5f + 0.5f * random()) + across * v), i % 2, i / 2});
  }
  return triangles;
}

std::vector<RayData> rays_for(size_t count, float scale, vec3 offset, unsigned seed) {
  Random random(seed);
  std::vector<RayData> rays;
  for (size_t i = 0; i < count; ++i) {
    const float away = i % 8 == 0 ? 30.0f : 1.5f;
    const vec3 origin = away * random.vector();
    const vec3 direction = i % 2 ? random.direction() : glm::normalize(random.vector() - origin);
    rays.push_back({offset + scale * origin, direction, 0, INFINITY});
    if (i % 4 == 1) rays.back().t_min = scale * 0.2f;
    if (i % 4 >= 2) rays.back().t_max = scale * (away + random());
  }
  return rays;
}

/// A closed, bumpy ball of latitudes and longitudes.
std::vector<TreeTriangle> ball(int n, float scale, vec3 offset) {
  const auto point = [&](int i, int j) {
    const double theta = M_PI * i / n, phi = M_PI * (j % (2 * n)) / n;
    const double r = 1 + (i % n ? 0.1 * std::sin(13.0 * i) * std::cos(17.0 * (j % (2 * n))) : 0.0);
    const double ring = i % n ? std::sin(theta) : 0.0;
    return offset + scale * vec3(dvec3(ring * std::cos(phi), std::cos(theta), ring * std::sin(phi)) * r);
  };
  std::vector<TreeTriangle> triangles;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 2 * n; ++j) {
      const vec3 a = point(i, j), b = point(i, j + 1), c = point(i + 1, j), d = point(i + 1, j + 1);
      if (i > 0) triangles.push_back({a, b, d, 0, static_cast<uint32_t>(triangles.size())});
      if (i < n - 1) triangles.push_back({a, d, c, 0, static_cast<uint32_t>(triangles.size())});
    }
  return triangles;
}

}  // namespace

TEST_CASE("soups of triangles, of many sizes and at many places") {
  struct Case {
    float along, across, scale;
    vec3 offset;
  };
  const Case cases[] = {{0.1f, 0.1f, 1, vec3(0)},           {0.5f, 0.5f, 1, vec3(0)},
                        {0.1f, 0.1f, 1e-4f, vec3(0)},       {0.1f, 0.1f, 1e4f, vec3(0)},
                        {2.0f, 1e-4f, 1, vec3(0)},          {2.0f, 1e-6f, 1, vec3(0)},
                        {0.01f, 0.3f, 1e-3f, {1, -2, 0.5}}, {0.3f, 0.3f, 1, {100, 300, -200}},
                        {30.0f, 30.0f, 1, vec3(0)},         {0.3f, 0.3f, 1e-9f, vec3(0)},
                        {0.3f, 0.3f, 1e11f, vec3(0)}};
  unsigned seed = 1;
  for (const Case& c : cases) {
    CAPTURE(c.along);
    CAPTURE(c.across);
    CAPTURE(c.scale);
    const auto triangles = soup(1500, c.along, c.across, c.scale, c.offset, seed);
    const auto rays = rays_for(1024, c.scale, c.offset, seed++);
    const auto results = trace(triangles, rays);
    check_against_leaves(results);
    check_against_double(triangles, rays, results);
    for (size_t build = 1; build < std::size(builds); ++build) {
      CAPTURE(builds[build].options);
      const auto others = trace(triangles, rays, build);
      check_against_leaves(others);
      size_t differ = 0;
      for (size_t i = 0; i < rays.size(); ++i) differ += others[i].closest != results[i].closest;
      CHECK(differ == 0);
    }
  }
}

TEST_CASE("rays along the axes meet boxes in their very planes, edges and corners") {
  // Corners, origins and directions on one lattice: zero components, flat boxes, and ties everywhere.
  Random random(3);
  std::vector<TreeTriangle> triangles;
  const auto lattice = [&] { return vec3(random.below(9), random.below(9), random.below(9)) / 8.0f; };
  while (triangles.size() < 1200) {
    TreeTriangle t{lattice(), lattice(), lattice(), random.below(3), static_cast<uint32_t>(triangles.size())};
    if (triangles.size() % 2) {
      const int axis = static_cast<int>(random.below(3));
      t.b[axis] = t.c[axis] = t.a[axis];
    }
    if (glm::cross(t.b - t.a, t.c - t.a) != vec3(0)) triangles.push_back(t);
  }
  std::vector<RayData> rays;
  for (int i = 0; i < 4096; ++i) {
    RayData ray{lattice(), vec3(0), 0, INFINITY};
    const int axis = i % 3;
    ray.direction[axis] = i % 2 ? 1.0f : -1.0f;
    if (i % 4 == 3) ray.direction[(axis + 1) % 3] = -1.0f;
    for (int k = 0; k < 3; ++k)
      if (i % 8 >= 4 && ray.direction[k] == 0) ray.direction[k] = -0.0f;
    ray.direction = glm::normalize(ray.direction);
    if (i % 5) ray.origin[axis] = ray.direction[axis] > 0 ? -1.0f : 2.0f;
    if (i % 16 > 12) ray.t_max = 1.5f;  // a t at which there are hits
    rays.push_back(ray);
  }
  const auto results = trace(triangles, rays);
  check_against_leaves(results);
  check_against_double(triangles, rays, results);
}

TEST_CASE("no ray leaves a closed mesh through its edges and corners") {
  for (const float scale : {1e-4f, 1.0f, 1e4f})
    for (const vec3 offset : {vec3(0), scale * vec3(7, -3, 20)}) {
      CAPTURE(scale);
      CAPTURE(offset.x);
      const auto triangles = ball(16, scale, offset);
      Random random(5);
      std::vector<RayData> rays;
      for (int i = 0; i < 30000; ++i) {
        const TreeTriangle& t = triangles[random.below(triangles.size())];
        const vec3 origin = i % 7 ? offset + 0.5f * scale * random.vector() : offset;
        const float s = i % 3 ? 0.5f + 0.5f * random() : 0.0f;
        const vec3 target = t.a + s * (t.b - t.a);
        const vec3 direction = glm::normalize(target - origin);
        rays.push_back({origin, direction, 0, INFINITY});
        // From outside towards the same place: it or something before it is met.
        if (i % 2) rays.back() = {origin + 50.0f * scale * random.direction(), vec3(0), 0, INFINITY};
        if (i % 2) rays.back().direction = glm::normalize(offset - rays.back().origin);
      }
      const auto results = trace(triangles, rays);
      size_t missed = 0;
      for (const Result& r : results) missed += !r.found;
      CHECK(missed == 0);
      check_against_leaves(results);
    }
}

TEST_CASE("rays from far away lose nothing at the boxes, however coarse their own numbers are") {
  Random random(11);
  for (const float away : {1e2f, 1e4f, 1e6f}) {
    CAPTURE(away);
    auto triangles = soup(1000, 0.1f, 0.1f, 1, vec3(0), 12);
    for (size_t i = 0; i < triangles.size(); i += 2) {  // half of them in a plane across an axis
      const int axis = static_cast<int>(i / 2 % 3);
      triangles[i].b[axis] = triangles[i].c[axis] = triangles[i].a[axis];
    }
    std::vector<RayData> rays;
    for (int i = 0; i < 8192; ++i) {
      const TreeTriangle& t = triangles[random.below(triangles.size())];
      vec3 origin = away * random.direction();
      if (i % 2) {  // along an axis, all but
        origin = t.b;
        origin[i % 3] = i % 4 == 1 ? away : -away;
      }
      rays.push_back({origin, glm::normalize((i % 8 < 4 ? t.a : t.b) - origin), 0, INFINITY});
    }
    check_against_leaves(trace(triangles, rays));
  }
}

TEST_CASE("equal distances go to the lowest shape, then the lowest primitive") {
  // Three copies of a fan whose triangles share the corner and the edges that the rays are sent to, in mixed order.
  std::vector<TreeTriangle> triangles;
  for (const uint32_t shape : {5u, 2u, 9u})
    for (uint32_t i = 0; i < 8; ++i) {
      const auto at = [](uint32_t k) { return vec3(std::cos(k % 8 * M_PI / 4), std::sin(k % 8 * M_PI / 4), 0); };
      triangles.push_back({vec3(0), at(i), at(i + 1), shape, 7 - i});
    }
  std::vector<RayData> rays{{{0, 0, 1}, {0, 0, -1}, 0, INFINITY}, {{0.5f, 0, -2}, {0, 0, 1}, 0, INFINITY}};
  const auto results = trace(triangles, rays);
  for (const Result& result : results) {
    CHECK(result.closest.shape == 2);
    CHECK(result.closest.primitive == 0);
    // Of the eight or two triangles of a shape one counts, so none takes the place of another shape.
    CHECK(result.within_count == 3);
    for (uint32_t k = 0; k < 3; ++k) {
      CHECK(result.within[k].shape == std::array{2u, 5u, 9u}[k]);
      CHECK(result.within[k].primitive == 0);
    }
  }
  CHECK(results[1].closest.t == 2);
  check_against_leaves(results);
}

TEST_CASE("the hit's weights put it where the ray is") {
  const auto triangles = soup(500, 0.5f, 0.5f, 1, vec3(0), 21);
  const auto rays = rays_for(1024, 1, vec3(0), 22);
  const auto results = trace(triangles, rays);
  double worst = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    const HitData& hit = results[i].closest;
    if (!results[i].found) continue;
    const TreeTriangle& t = triangles[hit.primitive * 2 + hit.shape];
    const dvec3 a(t.a), by_weights = a + double(hit.u) * (dvec3(t.b) - a) + double(hit.v) * (dvec3(t.c) - a);
    const dvec3 by_t = dvec3(rays[i].origin) + double(hit.t) * dvec3(rays[i].direction);
    worst = std::max(worst, glm::length(by_weights - by_t) / (1.5e-6 * (2 + glm::length(dvec3(rays[i].origin)))));
    CHECK(hit.u >= 0);
    CHECK(hit.v >= 0);
    CHECK(hit.u + hit.v <= 1 + 1e-6f);
  }
  CHECK(worst < 1);
}

TEST_CASE("a hit that is there already is only replaced by one that comes before it") {
  const TreeTracer& tracer = TreeTracer::get();
  const Tree tree = build_tree(std::vector<TreeTriangle>{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4, 6}});  // at t = 1
  struct Case {
    HitData held;                           ///< u is the ray's t_max
    bool replaced, any;
  };
  const Case cases[] = {{{2, 1, 0, INFINITY, 0}, true, true},
                        {{0.5f, 8, 0, INFINITY, 0}, false, true},
                        {{1, 4, 6, INFINITY, 0}, false, true},
                        {{1, 4, 7, INFINITY, 0}, true, true},
                        {{1, 5, 0, INFINITY, 0}, true, true},
                        {{1, 3, 9, INFINITY, 0}, false, true},
                        {{INFINITY, ~0u, ~0u, 1, 0}, false, false},
                        {{1, ~0u, 0, 1, 0}, false, false},
                        {{INFINITY, ~0u, ~0u, 1.01f, 0}, true, true}};
  std::vector<HitData> held(whole_groups);
  for (size_t i = 0; i < std::size(cases); ++i) held[i] = cases[i].held;
  for (size_t build = 0; build < std::size(builds); ++build) {
    const cl::Buffer hits = tracer.cl.upload(held), found = tracer.cl.upload(std::vector<uint32_t>(whole_groups));
    tracer.cl.run(tracer.programs[build], "improve", whole_groups / builds[build].width, tracer.cl.upload(tree.nodes),
                  tracer.cl.upload(tree.leaves), hits, found);
    const auto after = tracer.cl.download<HitData>(hits, std::size(cases));
    const auto replaced = tracer.cl.download<uint32_t>(found, std::size(cases));
    for (size_t i = 0; i < std::size(cases); ++i) {
      CAPTURE(builds[build].options);
      CAPTURE(i);
      CHECK((replaced[i] & 1) == cases[i].replaced);
      CHECK((replaced[i] >> 1) == cases[i].any);
      if (cases[i].replaced)
        CHECK(after[i] == HitData{1, 4, 6, 0.25f, 0.25f, 1});
      else
        CHECK(after[i] == cases[i].held);
    }
  }
}

TEST_CASE("a tree of nothing, and rays that are no rays") {
  const float nan = NAN;
  const std::vector<RayData> rays{{{0, 0, 1}, {0, 0, -1}, 0, INFINITY},
                                  {{nan, nan, nan}, {0, 0, -1}, 0, INFINITY},
                                  {{0, 0, 1}, {nan, nan, nan}, 0, INFINITY},
                                  {{0, 0, 1}, {0, 0, 0}, 0, INFINITY},
                                  {{0, 0, 1}, {0, 0, -1}, nan, INFINITY}};
  for (const Result& r : trace({}, rays)) CHECK(!r.found);
  const auto results = trace(soup(1000, 0.5f, 0.5f, 1, vec3(0), 4), rays);
  for (size_t i = 1; i < rays.size(); ++i) CHECK(!results[i].found);
}
