// Meshes: no ray slips through an edge, the closest hit does not hang on the tree, and what enters a mesh leaves it.

#include <cmath>
#include <memory>
#include <set>

#include "device/device_scene.hpp"
#include "scene/features.hpp"
#include "verify/groups.hpp"
#include "verify/path_lengths.hpp"
#include "verify/scenes.hpp"

namespace vitrum {

namespace kernel {
#include "checks/geometry_types.h"
static_assert(sizeof(AimData) == 40 && sizeof(GeometryResult) == 40);
}

namespace {

using kernel::AimData;
using kernel::GeometryResult;

/// Surfaces that a chain may meet before it is cut.
constexpr uint32_t chain_depth = 32;

/// A mesh of glass about a centre.
struct Body {
  const char* name;
  Mesh mesh;
  double size;                  ///< [m], radius
};

/// How chains are aimed at a body (AimData).
struct Way {
  const char* name;
  float slant;
  double spread;                ///< of the body's size
  uint32_t tangential, edges;
};
// The last: where a ray grazes a facet at its very edge, rounding puts it beyond, once in 500 times on needles.
constexpr Way ways[] = {{"anywhere", 5, 1, 0, 0}, {"at edges", 50, 1e-6, 0, 1}, {"along edges", 1000, 0, 1, 1}};

/// Balls from coarse to needles, by their facets and with the ball's normals, tiny and huge.
std::vector<Body> bodies(bool smooth) {
  std::vector<Body> all;
  const auto ball = [&](const char* name, double size, int rings, int sectors) {
    all.push_back({name, mesh_ball({0, 0, 0}, size, rings, sectors, smooth, 0), size});
  };
  ball("ball of 16,128 facets", 1, 64, 128);
  ball("ball of 224 facets", 1, 8, 16);
  ball("ball of needles, 4 x 3000", 1, 4, 3000);
  ball("ball of 5e-5 m", 5e-5, 64, 128);
  ball("ball of 5,000 m", 5000, 64, 128);
  return all;
}

/// The ends of each edge, a and b.
std::vector<float> edges_of(const Mesh& mesh) {
  std::set<std::pair<uint32_t, uint32_t>> pairs;
  for (const glm::uvec3& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) pairs.insert(std::minmax(t[k], t[(k + 1) % 3]));
  std::vector<float> ends;
  for (const auto& [a, b] : pairs)
    for (const uint32_t corner : {a, b})
      for (int axis = 0; axis < 3; ++axis) ends.push_back(mesh.positions[corner][axis]);
  return ends;
}

/// A body on the device, ready to be shot at.
class Target {
 public:
  Target(const CheckContext& context, const Body& body, double index)
      : device_(context.device), edges_(device_.upload(edges_of(body.mesh), "inputs of checks")) {
    Scene scene;
    scene.film.width = scene.film.height = 4;
    scene.camera = {CameraType::pinhole, {0, 0, 3 * body.size}, {0, 0, 0}, {0, 1, 0}, 45.0};
    scene.render.caustics = scene.render.lights = false;
    scene.materials.push_back(glass(index));
    add(scene, body.mesh);
    const Features features = scene_features(scene);
    data_ = scene_data(scene, features);
    tree_ = build_tree(data_.tree_triangles);
    scene_ = upload(device_, data_, features, &tree_);
    program_ = device_.build("checks/geometry.cl", kernel_source(context.kernels, {"checks/geometry.cl"}),
                             "-cl-std=CL1.2" + features.build_options());
  }

  /// Builds the tree anew from the triangles in the opposite order.
  void turn_tree() {
    std::vector<TreeTriangle> turned(data_.tree_triangles.rbegin(), data_.tree_triangles.rend());
    tree_ = build_tree(turned);
    scene_.nodes = device_.upload(tree_.nodes, "tree");
    scene_.leaves = device_.upload(tree_.leaves, "tree");
  }

  /// Kernel edge_rays, or with `max_depth` chains, on about `count` rays.
  GeometryResult shoot(const AimData& aim, uint64_t count, uint32_t max_depth = 0) {
    constexpr uint32_t packets = 64;
    const auto items = static_cast<uint32_t>((count + packets * device_.width() - 1) / (packets * device_.width()));
    const auto results = device_.upload(std::vector<GeometryResult>(items), "outputs of checks");
    cl::Kernel kernel(program_, max_depth > 0 ? "chains" : "edge_rays");
    const unsigned next = scene_.set_arguments(kernel);
    const auto aim_buffer = device_.upload(std::vector<AimData>{aim}, "inputs of checks");
    set_arguments(kernel, next, edges_, static_cast<uint32_t>(edges_.size() / 6), aim_buffer, packets, items);
    if (max_depth > 0) set_arguments(kernel, next + 5, max_depth, results);
    else set_arguments(kernel, next + 5, results);
    device_.launch_singly("checks", kernel, items);
    GeometryResult all{};
    for (const GeometryResult& r : device_.read(results, 0, items)) {
      if (all.wrong == 0 && r.wrong > 0) {
        std::copy(r.origin, r.origin + 3, all.origin);
        std::copy(r.direction, r.direction + 3, all.direction);
      }
      all.rays += r.rays;
      all.wrong += r.wrong;
      all.events += r.events;
      all.sum += r.sum;
    }
    return all;
  }

 private:
  Device& device_;
  Buffer<float> edges_;
  SceneData data_;
  Tree tree_;
  DeviceScene scene_;
  cl::Program program_;
};

/// Rays that went wrong over several bodies.
struct Row {
  uint64_t rays = 0, wrong = 0;
  std::string where;

  void add(const GeometryResult& found, const std::string& what) {
    if (wrong == 0 && found.wrong > 0)
      where = what + printed(": %u of %u, the first from (%.9g, %.9g, %.9g) along (%.9g, %.9g, %.9g)", found.wrong, found.rays,
                             found.origin[0], found.origin[1], found.origin[2], found.direction[0], found.direction[1],
                             found.direction[2]);
    rays += found.rays;
    wrong += found.wrong;
  }
  CheckResult result(const char* name, const char* unit, const char* truth) const {
    return {name, rays, static_cast<double>(wrong), 0, unit, truth, where};
  }
};

}  // namespace

std::vector<CheckResult> check_geometry(const CheckContext& context) {
  const uint64_t rays = context.full ? 7'000'000 : 50'000, chains = context.full ? 100'000 : 4'000;
  Row missed, unique, straight, refracted;
  // Shares of the time: 15 sets of rays, twice, and 200 of chains.
  int done = 0;
  const auto told = [&](int part) { context.progress((done += part) / 480.0); };
  for (const Body& body : bodies(false)) {
    Target target(context, body, 1.5);
    // From inside, from its neighbourhood, and from 10,000 m: of the tiny one, as many times its size. From aside, but not
    // so far that the ray could pass the body.
    for (const double distance : {0.0, 2 * body.size, body.size < 1 ? 1e4 * body.size : 1e4}) {
      const AimData aim{{0, 0, 0}, static_cast<float>(distance), 0.7f, 0, 0, 0, 1, static_cast<uint32_t>(distance)};
      const GeometryResult found = target.shoot(aim, rays);
      missed.add(found, printed("%s, %g m away", body.name, distance));
      target.turn_tree();
      GeometryResult again = target.shoot(aim, rays);
      again.wrong = again.sum != found.sum;
      told(16);
      unique.add(again, printed("%s, %g m away", body.name, distance));
      target.turn_tree();
    }
  }
  for (const double index : {1.0, 1.5, 1 / 1.5, 2.4})
    for (const bool smooth : {false, true})
      for (const Body& body : bodies(smooth)) {
        Target target(context, body, index);
        told(6);
        for (const double distance : {0.0, 2 * body.size})
          for (const Way& way : ways) {
            if (way.tangential && distance == 0.0) continue;
            const AimData aim{{0, 0, 0}, static_cast<float>(distance), way.slant,
                              static_cast<float>(way.spread * body.size), way.tangential,
                              index == 1.0 ? 2u : chain_depth, way.edges, static_cast<uint32_t>(100 * index)};
            (index == 1.0 ? straight : refracted)
                .add(target.shoot(aim, chains, chain_depth), printed("%s%s, n = %g, %g m away, %s", body.name, smooth ? ", smooth" : "",
                                                            index, distance, way.name));
          }
      }
  return {missed.result("geometry/edges and corners", "misses", "closed mesh: each ray hits"),
          unique.result("geometry/closest hit", "sums of hits", "another tree over the same triangles"),
          straight.result("geometry/straight chains", "wrong media", "who enters a closed mesh leaves it"),
          refracted.result("geometry/chains", "wrong media", "who enters a closed mesh leaves it"),
          check_path_lengths(context)};
}

}  // namespace vitrum
