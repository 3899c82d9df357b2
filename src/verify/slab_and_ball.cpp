// Pictures of glass whose radiance has a closed form, pixel by pixel: a slab, a ball, a ball in a ball, and the inside
// of a ball, clear and absorbing; and the group, with the meshes of mesh_pictures.hpp.

#include <algorithm>
#include <cmath>
#include <utility>

#include "verify/groups.hpp"
#include "verify/mesh_pictures.hpp"
#include "verify/truth_pictures.hpp"

namespace vitrum {
namespace {

using glm::dvec3;

const Spectrum absorption(0.1, 0.5, 2.0);

/// One thing in a white surround.
Scene ball_scene(double index, const Spectrum& sigma_a, int size) {
  Scene scene = truth_picture({0.2, 0.3, 4}, {0, 0, 0}, 32, size);
  scene.materials.push_back(glass(index));
  scene.materials[0].absorption = sigma_a;
  add(scene, Sphere{{0, 0, 0}, 1.0}, 0);
  return scene;
}

std::vector<CheckResult> check_furnace(const CheckContext& context, int size) {
  PictureRow row;
  for (const double n : {1.00028, 1.333, 1.5, 2.4}) {
    Scene scene = ball_scene(n, Spectrum(0.0), size);
    // As rendered by default, where much is cut: all that is missing must be told.
    scene.render.max_depth = 20;
    scene.render.min_weight = 1e-4;
    row.add(context, scene, [](const dvec3&) { return Range{dvec3(1), dvec3(1)}; }, printed("n = %g", n));
  }
  return {row.result("slab-and-ball/white furnace", "radiance 1 all around gives 1 (clear ball)")};
}

std::vector<CheckResult> check_ball(const CheckContext& context, int size) {
  PictureRow row;
  for (const double n : {1.333, 1.5, 2.4}) {
    const Scene scene = ball_scene(n, absorption, size);
    const auto truth = [&](const dvec3& direction) {
      return shells_seen({{1.0, n, absorption}}, scene.camera.eye, direction);
    };
    row.add(context, scene, truth, printed("n = %g, sigma_a = .1, .5, 2", n));
  }
  return {row.result("slab-and-ball/absorbing ball", "R + T^2 tau/(1 - R tau), tau = exp(-2 sigma a cos_t)")};
}

std::vector<CheckResult> check_nested(const CheckContext& context, int size) {
  struct Nested {
    double outer, inner;
    int priority;               // of the outer glass, against 0
    double innermost;           // 0: there is none
  };
  PictureRow row;
  // Glass around liquid, liquid around glass, around air, a body that must not be seen at all, since the outer one
  // fills its place, and ice in liquid in glass.
  for (const Nested& n :
       {Nested{1.5, 1.333, 0, 0}, {1.333, 1.5, 0, 0}, {1.5, 1.0, 0, 0}, {1.5, 2.4, 1, 0}, {1.5, 1.333, 0, 1.31}}) {
    Scene scene = ball_scene(n.outer, absorption, size);
    scene.materials[0].priority = n.priority;
    scene.materials.push_back(glass(n.inner));
    const Spectrum inside(2.0, 0.3, 0.1), innermost(0.5, 0.2, 1.0);
    scene.materials[1].absorption = inside;
    std::vector<Shell> shells = {{1.0, n.outer, absorption}};
    if (n.priority == 0) shells.push_back({0.6, n.inner, inside});
    add(scene, Sphere{{0, 0, 0}, 0.6}, 1);
    if (n.innermost > 0) {
      scene.materials.push_back(glass(n.innermost));
      scene.materials[2].absorption = innermost;
      add(scene, Sphere{{0, 0, 0}, 0.4}, 2);
      shells.push_back({0.4, n.innermost, innermost});
    }
    const auto truth = [&](const dvec3& direction) { return shells_seen(shells, scene.camera.eye, direction); };
    std::string what = printed("n = %g around %g, priority %d", n.outer, n.inner, n.priority);
    if (n.innermost > 0) what += printed(", around %g", n.innermost);
    row.add(context, scene, truth, what);
  }
  return {row.result("slab-and-ball/nested balls", "the same, shell in shell; Schmidt and Budge 2002")};
}

std::vector<CheckResult> check_inside(const CheckContext& context, int size) {
  PictureRow row;
  const dvec3 eye(0.1, -0.2, 0.3);
  for (const double n : {1.333, 1.5, 2.0}) {
    Scene scene = ball_scene(n, absorption, size);
    scene.camera.eye = eye;
    scene.camera.look_at = {-1, 0.4, 0.2};
    scene.camera.vertical_fov = 120;
    const auto truth = [&](const dvec3& direction) {
      const double across = glm::length(glm::cross(eye, direction)), half = leg(1.0, across);
      const double way = half - glm::dot(eye, direction);
      const reference::Fresnel f = reference::fresnel(n, 1.0, half);
      const dvec3 around = f.R * reference::transmittance(absorption, 2 * half);
      const dvec3 value = n * n * f.T * reference::transmittance(absorption, way) / (1.0 - around);
      return Range{value, value};
    };
    row.add(context, scene, truth, printed("n = %g", n));
  }
  return {row.result("slab-and-ball/eye in the ball", "n^2 T tau_1/(1 - R tau), radiance in the glass")};
}

std::vector<CheckResult> check_slab(const CheckContext& context, int size) {
  PictureRow row;
  constexpr double thickness = 0.5;
  for (const double n : {1.333, 1.5, 2.4})
    for (const bool mirrored : {false, true}) {
      Scene scene = lit_from_both_sides(size);
      const Spectrum sigma_a = mirrored ? Spectrum(0, 0, 1.0) : Spectrum(0.7, 0.7, 0);
      scene.materials.push_back(glass(n));
      scene.materials[1].absorption = sigma_a;
      add(scene, layer(0, -thickness, 1));
      const auto truth = [&](const dvec3& direction) { return layers_seen({{n, thickness, sigma_a}}, direction); };
      row.add(context, scene, truth, printed("n = %g, sigma_a = %g, %g, %g", n, sigma_a.x, sigma_a.y, sigma_a.z));
    }
  return {row.result("slab-and-ball/slab", "R + T^2 R tau^2/(1 - R^2 tau^2), T^2 tau/(1 - R^2 tau^2)")};
}

}  // namespace

std::vector<CheckResult> check_slab_and_ball(const CheckContext& context) {
  const int size = context.full ? 256 : 48;
  const auto checks = {check_furnace,      check_ball,      check_nested,          check_inside,         check_slab,
                       check_mesh_furnace, check_mesh_ball, check_touching_layers, check_mesh_shells};
  std::vector<CheckResult> rows;
  double done = 0.0;
  for (const auto check : checks) {
    for (CheckResult& row : check(context, size)) rows.push_back(std::move(row));
    context.progress(++done / static_cast<double>(checks.size()));
  }
  return rows;
}

}  // namespace vitrum
