// Rays per second through the tree on the OpenCL device, beside Embree's rtcIntersect1 on the same rays and threads.
//
// usage: bench_traversal [rounds]. POCL_MAX_PTHREAD_COUNT sets the threads of both.

#include <embree3/rtcore.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <thread>

#include "device/opencl_harness.hpp"
#include "scene/tree.hpp"

using namespace vitrum;

namespace {

struct RayData {
  float origin[3], direction[3];
};

const char* const kernel_text = R"(
#include "tree.h"
__kernel void closest(__global const TreeNode* nodes, __global const TreeLeaf* leaves, __global const float* rays,
                      __global float* t, __global uint* primitive) {
  const size_t i = get_global_id(0);
  const Ray ray = free_ray(vload3(2 * i, rays), vload3(2 * i + 1, rays), 1e-4f, INFINITY);
  Hit hit;
  hit.t = INFINITY;
  hit.shape = hit.primitive = TREE_EMPTY;
  hit.u = hit.v = 0.0f;
  tree_closest(&ray, nodes, leaves, &hit);
  t[i] = hit.t;
  primitive[i] = hit.primitive;
}
)";

/// Unit sphere of latitudes and longitudes, a little wavy: some 2 * n * 2n triangles.
std::vector<TreeTriangle> sphere_mesh(int n) {
  const auto point = [&](int i, int j) {
    const double theta = M_PI * i / n, phi = M_PI * (j % (2 * n)) / n;
    const double r = 1 + 0.02 * std::sin(9 * theta) * std::cos(11 * phi);
    return glm::vec3(glm::dvec3(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)) * r);
  };
  std::vector<TreeTriangle> triangles;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 2 * n; ++j) {
      const glm::vec3 a = point(i, j), b = point(i, j + 1), c = point(i + 1, j), d = point(i + 1, j + 1);
      const auto number = static_cast<uint32_t>(triangles.size());
      if (i > 0) triangles.push_back({a, b, d, 0, number});
      if (i < n - 1) triangles.push_back({a, d, c, 0, static_cast<uint32_t>(triangles.size())});
    }
  return triangles;
}

std::vector<RayData> primary_rays(int n) {
  std::vector<RayData> rays(static_cast<size_t>(n) * n);
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const glm::vec3 d =
          glm::normalize(glm::vec3((x + .5f) / n - .5f, (y + .5f) / n - .5f, -1.3f));
      rays[static_cast<size_t>(y) * n + x] = {{0.1f, 0.2f, 3}, {d.x, d.y, d.z}};
    }
  return rays;
}

/// From where the primary rays met the mesh, in a random direction.
std::vector<RayData> diffuse_rays(const std::vector<RayData>& primary, const std::vector<float>& t) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<RayData> rays = primary;
  for (size_t i = 0, next = 0; i < rays.size(); ++i) {
    while (!std::isfinite(t[next % t.size()])) ++next;
    const size_t k = next++ % t.size();
    glm::vec3 d;
    do d = {uniform(generator), uniform(generator), uniform(generator)};
    while (glm::dot(d, d) > 1 || glm::dot(d, d) < 0.01f);
    d = glm::normalize(d);
    for (int axis = 0; axis < 3; ++axis) {
      rays[i].origin[axis] = primary[k].origin[axis] + t[k] * primary[k].direction[axis];
      rays[i].direction[axis] = d[axis];
    }
  }
  return rays;
}

/// Embree with its own tree, made as it makes trees for robust scenes.
class Embree {
 public:
  explicit Embree(const std::vector<TreeTriangle>& triangles)
      : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* corners = static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(
        mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), triangles.size() * 3));
    auto* indices = static_cast<uint32_t*>(rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   3 * sizeof(uint32_t), triangles.size()));
    for (size_t i = 0; i < triangles.size(); ++i) {
      corners[3 * i] = triangles[i].a;
      corners[3 * i + 1] = triangles[i].b;
      corners[3 * i + 2] = triangles[i].c;
    }
    for (uint32_t i = 0; i < 3 * triangles.size(); ++i) indices[i] = i;
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(scene_, mesh);
    rtcReleaseGeometry(mesh);
    rtcCommitScene(scene_);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;
  ~Embree() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  void run(const std::vector<RayData>& rays, std::vector<float>& t, std::vector<uint32_t>& primitive,
           unsigned threads) const {
    std::vector<std::jthread> pool;
    for (unsigned k = 0; k < threads; ++k)
      pool.emplace_back([&, k] {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        for (size_t i = rays.size() * k / threads; i < rays.size() * (k + 1) / threads; ++i) {
          const RayData& r = rays[i];
          RTCRayHit query{};
          query.ray = {r.origin[0], r.origin[1], r.origin[2], 1e-4f, r.direction[0], r.direction[1], r.direction[2],
                       0, INFINITY, 0xffffffffu, 0, 0};
          query.hit.geomID = query.hit.primID = RTC_INVALID_GEOMETRY_ID;
          rtcIntersect1(scene_, &context, &query);
          t[i] = query.ray.tfar;
          primitive[i] = query.hit.primID;
        }
      });
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
};

double cpu_seconds() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_utime.tv_sec + 1e-6 * usage.ru_utime.tv_usec;
}

/// Times of several rounds.
struct Times {
  std::vector<double> wall, cpu;

  template <typename Work>
  void add(const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    const double cpu_start = cpu_seconds();
    work();
    cpu.push_back(cpu_seconds() - cpu_start);
    wall.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
};

/// Millions of rays per second in the best round.
double rate(const std::vector<double>& seconds, size_t rays) {
  return 1e-6 * static_cast<double>(rays) / *std::ranges::min_element(seconds);
}

/// How many times faster `ours` is, as the median over the rounds: what else runs on the machine disturbs it least.
double speedup(const std::vector<double>& ours, const std::vector<double>& theirs) {
  std::vector<double> ratios;
  for (size_t i = 0; i < ours.size(); ++i) ratios.push_back(theirs[i] / ours[i]);
  std::ranges::sort(ratios);
  return ratios[ratios.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 11;
  const char* limit = std::getenv("POCL_MAX_PTHREAD_COUNT");
  const unsigned threads = limit ? static_cast<unsigned>(std::atoi(limit)) : std::thread::hardware_concurrency();

  const std::vector<TreeTriangle> triangles = sphere_mesh(360);
  const Tree tree = build_tree(triangles, threads);
  std::printf("%zu triangles, %zu nodes, %zu leaves, depth %d, stack %d, %.1f MB, built in %.3f s\n",
              tree.statistics.triangles, tree.nodes.size(), tree.leaves.size(), tree.statistics.depth,
              tree.statistics.stack, tree.statistics.bytes * 1e-6, tree.statistics.seconds);
  const Embree embree(triangles);
  const OpenClHarness device;
  const cl::Buffer nodes = device.upload(tree.nodes), leaves = device.upload(tree.leaves);
  const cl::Program native = device.build(kernel_text), portable = device.build(kernel_text, "-DVITRUM_PORTABLE");

  std::vector<RayData> rays = primary_rays(1024);
  const size_t count = rays.size();
  std::vector<float> t(count);
  std::vector<uint32_t> primitive(count);
  const cl::Buffer device_t = device.upload(t), device_primitive = device.upload(primitive);
  for (const char* kind : {"primary", "diffuse"}) {
    const cl::Buffer device_rays = device.upload(rays);
    Times ours, plain, theirs;
    for (int round = 0; round < rounds; ++round) {
      ours.add([&] { device.run(native, "closest", count, nodes, leaves, device_rays, device_t, device_primitive); });
      theirs.add([&] { embree.run(rays, t, primitive, threads); });
      plain.add([&] { device.run(portable, "closest", count, nodes, leaves, device_rays, device_t, device_primitive); });
    }
    const auto our_t = device.download<float>(device_t, count);
    const auto our_primitive = device.download<uint32_t>(device_primitive, count);
    size_t differ = 0;
    for (size_t i = 0; i < count; ++i) differ += our_primitive[i] != primitive[i];
    std::printf("%s: vitrum %.2f, portable %.2f, Embree %.2f Mray/s; per second of processor time %.2f, %.2f, %.2f; "
                "vitrum/Embree %.2f, by processor time %.2f, portable %.2f; %zu of %zu hits differ\n",
                kind, rate(ours.wall, count), rate(plain.wall, count), rate(theirs.wall, count),
                rate(ours.cpu, count), rate(plain.cpu, count), rate(theirs.cpu, count),
                speedup(ours.wall, theirs.wall), speedup(ours.cpu, theirs.cpu), speedup(plain.cpu, theirs.cpu), differ,
                count);
    rays = diffuse_rays(rays, our_t);
  }
}
