// Rays a second through the tree, by kind of ray and size of mesh, beside Embree with the same rays.

#include <cmath>
#include <numbers>
#include <random>

#include "bench/benchmarks.hpp"
#include "bench/embree_scene.hpp"
#include "bench/side_by_side.hpp"
#include "device/device_scene.hpp"
#include "verify/scenes.hpp"

namespace vitrum {
namespace {

using glm::vec3;

constexpr float epsilon = 1e-4f;          // where rays start off a surface, and end before a lamp [m]
constexpr vec3 lamp(0.5f, 3.0f, 1.0f);    // its centre [m]

/// A closed tube of 16 n^2 triangles around a trefoil knot, some 2 m wide: rays that leave it meet it again.
Mesh knot(uint32_t n) {
  Mesh mesh;
  const uint32_t along = 8 * n;
  for (uint32_t i = 0; i < along; ++i) {
    const double s = 2 * std::numbers::pi * i / along;
    const glm::dvec3 centre(std::sin(s) + 2 * std::sin(2 * s), std::cos(s) - 2 * std::cos(2 * s), -std::sin(3 * s));
    const glm::dvec3 tangent(std::cos(s) + 4 * std::cos(2 * s), 4 * std::sin(2 * s) - std::sin(s), -3 * std::cos(3 * s));
    const glm::dvec3 u = glm::normalize(glm::cross(tangent, {0, 0, 1})), v = glm::normalize(glm::cross(tangent, u));
    for (uint32_t j = 0; j < n; ++j) {
      const double angle = 2 * std::numbers::pi * j / n;
      mesh.positions.emplace_back((centre + 0.5 * (std::cos(angle) * u + std::sin(angle) * v)) / 3.0);
    }
  }
  const auto at = [&](uint32_t i, uint32_t j) { return i % along * n + j % n; };
  for (uint32_t i = 0; i < along; ++i)
    for (uint32_t j = 0; j < n; ++j) {
      mesh.triangles.emplace_back(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      mesh.triangles.emplace_back(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  mesh.materials.assign(mesh.triangles.size(), 0);
  return mesh;
}

struct Random {
  std::mt19937 bits{1};
  float operator()(float low, float high) { return std::uniform_real_distribution<float>(low, high)(bits); }
  vec3 in_ball() {
    vec3 v;
    do v = {(*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1)};
    while (glm::dot(v, v) > 1 || glm::dot(v, v) < 1e-4f);
    return v;
  }
};

/// The mesh on the device, with its tree.
class Traversal {
 public:
  Traversal(const BenchContext& context, const Mesh& mesh) : device_(context.device) {
    Scene scene;
    scene.render.caustics = scene.render.lights = false;
    scene.materials = {surface(Surface::opaque, 0.5)};
    add(scene, mesh);
    const Features features = scene_features(scene);
    const SceneData data = scene_data(scene, features);
    const Tree tree = build_tree(data.tree_triangles, context.threads);
    const uint64_t before = bytes_held();
    scene_ = upload(device_, data, features, &tree);
    bytes_ = static_cast<double>(bytes_held() - before);
    program_ = device_.build("checks/rays.cl", kernel_source(context.kernels, {"checks/rays.cl"}), "-cl-std=CL1.2");
    closest_ = cl::Kernel(program_, "closest");
    occluded_ = cl::Kernel(program_, "occluded");
  }

  void place(const std::vector<RayData>& rays) {
    count_ = static_cast<uint32_t>(rays.size());
    rays_ = device_.upload(rays, "rays");
    t_ = device_.allocate<float>(count_, "rays");
    met_ = device_.allocate<uint32_t>(count_, "rays");
  }
  void closest() {
    set_arguments(closest_, 0, count_, scene_.nodes, scene_.leaves, rays_, t_, met_);
    run(closest_);
  }
  void occluded() {
    set_arguments(occluded_, 0, count_, scene_.nodes, scene_.leaves, rays_, met_);
    run(occluded_);
  }
  std::vector<float> t() { return device_.read(t_, 0, count_); }
  /// Of `closest`, the triangles; of `occluded`, 1 for each ray that meets one.
  std::vector<uint32_t> met() { return device_.read(met_, 0, count_); }

  /// Of the mesh on the device, its tree included.
  double bytes() const { return bytes_; }

 private:
  uint64_t bytes_held() const {
    uint64_t sum = 0;
    for (const auto& [purpose, bytes] : device_.memory_by_purpose()) sum += bytes;
    return sum;
  }
  void run(const cl::Kernel& kernel) {
    device_.launch("rays", kernel, device_.packets(count_));
    device_.finish();
  }

  Device& device_;
  double bytes_ = 0.0;
  DeviceScene scene_;
  cl::Program program_;
  cl::Kernel closest_, occluded_;
  uint32_t count_ = 0;
  Buffer<RayData> rays_;
  Buffer<float> t_;
  Buffer<uint32_t> met_;
};

/// Where a ray has met the mesh.
struct Place {
  vec3 position, direction, normal;  ///< the normal points against the direction
  bool entering;
};

/// Makes the rays of each kind from where others met the mesh.
class RayMaker {
 public:
  RayMaker(Traversal& traversal, const Mesh& mesh, size_t count) : traversal_(traversal), mesh_(mesh), count_(count) {
    seen_ = places(primary());
  }

  /// Of a kind, in the order of the plot's lines.
  std::vector<RayData> rays(size_t kind) {
    switch (kind) {
      case 0: return primary();
      case 1: return diffuse();
      case 2: return shadow();
      default: return photon();
    }
  }

 private:
  /// From the eye, row by row.
  std::vector<RayData> primary() const {
    const auto side = static_cast<size_t>(std::sqrt(static_cast<double>(count_)));
    std::vector<RayData> rays;
    for (size_t i = 0; i < count_; ++i) {
      const float x = static_cast<float>(i % side) + 0.5f, y = static_cast<float>(i / side) + 0.5f;
      const float scale = 1.0f / static_cast<float>(side);
      rays.push_back({{0.2f, 0.3f, 3}, 0, glm::normalize(vec3(x * scale - 0.5f, 0.5f - y * scale, -1.2f)), INFINITY});
    }
    return rays;
  }
  /// From what the eye sees, by the cosine.
  std::vector<RayData> diffuse() {
    Random random;
    return from_seen([&](const Place& p) {
      return RayData{p.position, epsilon, glm::normalize(p.normal + glm::normalize(random.in_ball())), INFINITY};
    });
  }
  /// From what the eye sees to places on a lamp.
  std::vector<RayData> shadow() {
    Random random;
    return from_seen([&](const Place& p) {
      const vec3 to_lamp = lamp + vec3(random(-0.3f, 0.3f), 0, random(-0.3f, 0.3f)) - p.position;
      const float distance = glm::length(to_lamp);
      return RayData{p.position, epsilon, to_lamp / distance, distance - epsilon};
    });
  }
  /// From the lamp at random, and on through glass of index 1.5, bounce after bounce.
  std::vector<RayData> photon() {
    Random random;
    std::vector<RayData> all, rays;
    for (size_t i = 0; i < count_ / 2; ++i)
      rays.push_back({lamp, 0, glm::normalize(1.1f * random.in_ball() - lamp), INFINITY});
    while (!rays.empty() && all.size() < count_) {
      all.insert(all.end(), rays.begin(), rays.end());
      std::vector<RayData> next;
      for (const Place& p : places(rays)) {
        const vec3 refracted = glm::refract(p.direction, p.normal, p.entering ? 1 / 1.5f : 1.5f);
        const bool is_total = refracted == vec3(0);
        const vec3 direction = is_total ? glm::reflect(p.direction, p.normal) : refracted;
        next.push_back({p.position, epsilon, glm::normalize(direction), INFINITY});
      }
      rays = std::move(next);
    }
    all.resize(std::min(all.size(), count_));
    return all;
  }

  template <typename Make>
  std::vector<RayData> from_seen(const Make& make) const {
    std::vector<RayData> rays;
    for (size_t i = 0; i < count_; ++i) rays.push_back(make(seen_[i % seen_.size()]));
    return rays;
  }
  std::vector<Place> places(const std::vector<RayData>& rays) {
    traversal_.place(rays);
    traversal_.closest();
    const std::vector<float> t = traversal_.t();
    const std::vector<uint32_t> primitive = traversal_.met();
    std::vector<Place> found;
    for (size_t i = 0; i < rays.size(); ++i) {
      if (!std::isfinite(t[i])) continue;
      const glm::uvec3 c = mesh_.triangles[primitive[i]];
      const vec3 a = mesh_.positions[c.x];
      const vec3 outwards = glm::normalize(glm::cross(mesh_.positions[c.y] - a, mesh_.positions[c.z] - a));
      const bool entering = glm::dot(outwards, rays[i].direction) < 0;
      const vec3 position = rays[i].origin + t[i] * rays[i].direction;
      found.push_back({position, rays[i].direction, entering ? outwards : -outwards, entering});
    }
    return found;
  }

  Traversal& traversal_;
  const Mesh& mesh_;
  size_t count_;
  std::vector<Place> seen_;
};

/// Rays that the two disagree on: one meets what the other does not, or elsewhere.
size_t different(const std::vector<float>& a, const std::vector<float>& b) {
  size_t count = 0;
  for (size_t i = 0; i < a.size(); ++i) count += a[i] != b[i] && !(std::abs(a[i] - b[i]) <= 1e-4f);
  return count;
}
size_t different(const std::vector<uint32_t>& a, const std::vector<uint32_t>& b) {
  size_t count = 0;
  for (size_t i = 0; i < a.size(); ++i) count += a[i] != b[i];
  return count;
}

}  // namespace

BenchResult bench_traversal(const BenchContext& context) {
  std::vector<uint32_t> sizes = {16};
  if (!context.quick) sizes.insert(sizes.end(), {45, 180, 433, 790});
  const size_t count = context.quick ? 64 * 64 : 1024 * 1024;
  const int rounds = context.quick ? 3 : 5;
  const std::string unit = SideBySide::unit(context);
  BenchResult result;
  result.plot = {"Rays through the tree, against Embree", "triangles", "times as fast as Embree",
                 {{"primary", {}}, {"diffuse", {}}, {"shadow", {}}, {"photon", {}}}, true, false};
  for (size_t size = 0; size < sizes.size(); ++size) {
    const Mesh mesh = knot(sizes[size]);
    const double triangles = static_cast<double>(mesh.triangles.size());
    Traversal traversal(context, mesh);
    const EmbreeScene embree(mesh, context.threads);
    RayMaker maker(traversal, mesh, count);
    for (size_t kind = 0; kind < 4; ++kind) {
      const bool shadow = kind == 2;
      const std::vector<RayData> rays = maker.rays(kind);
      std::vector<float> t(rays.size());
      std::vector<uint32_t> met(rays.size());
      traversal.place(rays);
      const SideBySide both(
          context, rounds, [&] { shadow ? traversal.occluded() : traversal.closest(); },
          [&] { shadow ? embree.occluded(rays, met) : embree.closest(rays, t); });
      const size_t differ = shadow ? different(traversal.met(), met) : different(traversal.t(), t);
      const double n = static_cast<double>(rays.size()), millions = 1e-6 * n;
      PlotLine& line = result.plot.lines[kind];
      result.rows.push_back({line.name, {{"triangles", triangles}, {"M rays/" + unit, millions / both.ours()},
                                         {"Embree's", millions / both.theirs()}, {"times as fast", both.speedup()},
                                         {"rays", n}, {"differ", static_cast<double>(differ)},
                                         {"B/triangle", traversal.bytes() / triangles},
                                         {"Embree's B", embree.bytes() / triangles}}});
      line.points.emplace_back(triangles, both.speedup());
      context.progress(static_cast<double>(4 * size + kind + 1) / static_cast<double>(4 * sizes.size()));
    }
    result.findings.push_back(printed("%.0f triangles: %.0f bytes a triangle with the tree, Embree %.0f", triangles,
                                      traversal.bytes() / triangles, embree.bytes() / triangles));
  }
  result.findings.push_back(EmbreeScene::description());
  result.findings.push_back("Embree's scene: RTC_SCENE_FLAG_ROBUST, RTC_BUILD_QUALITY_MEDIUM; rtcIntersect1, for shadow rays "
                            "rtcOccluded1");
  return result;
}

}  // namespace vitrum
