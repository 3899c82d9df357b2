// Pictures of glass whose radiance has a closed form, pixel by pixel: a slab, a ball, a ball in a ball, and the inside of
// a ball, clear and absorbing.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reference/fresnel.hpp"
#include "render/render.hpp"
#include "verify/groups.hpp"
#include "verify/scenes.hpp"

namespace vitrum {
namespace {

using glm::dvec3;

constexpr double bound = 1e-5;
// Rays are floats: the truth is that of any ray which misses its place by so much of the scene's size, as 8 roundings do.
constexpr double ray_error = 8 * 0x1p-24;

/// A picture of size x size pixels without lights; each sample the pixel's centre. Deep enough for the bound where media
/// absorb.
Scene picture(const dvec3& eye, const dvec3& look_at, double vertical_fov, int size) {
  Scene scene;
  scene.camera = {CameraType::pinhole, eye, look_at, {0, 1, 0}, vertical_fov};
  scene.film.width = scene.film.height = size;
  scene.background = Spectrum(1.0);
  scene.render.samples = 1;
  scene.render.caustics = scene.render.lights = false;
  scene.render.max_depth = 31;
  scene.render.min_weight = 1e-8;
  return scene;
}

/// Unit direction of the ray through the centre of pixel `i`, as src/device/scene_data.cpp has the camera.
dvec3 direction_of(const Scene& scene, size_t i) {
  const Camera& camera = scene.camera;
  const dvec3 forward = glm::normalize(camera.look_at - camera.eye);
  const dvec3 right = glm::normalize(glm::cross(forward, camera.up)), up = glm::cross(right, forward);
  const double half = std::tan(0.5 * camera.vertical_fov * std::numbers::pi / 180), size = scene.film.height;
  const double x = static_cast<double>(i % static_cast<size_t>(scene.film.width)) + 0.5;
  const double y = static_cast<double>(i / static_cast<size_t>(scene.film.width)) + 0.5;
  return glm::normalize(forward + half * (2 * x / size - 1) * right + half * (1 - 2 * y / size) * up);
}

/// Radiance that `truth` allows: the least and the greatest over rays next to the pixel's.
struct Range {
  double low = 1e300, high = -1e300;
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

/// Renders the scene and holds pixels against `truth(direction, channel)`. What the limits cut away, times the radiance of
/// the surround (1) and the square of the eye's index, may be missing.
template <typename Truth>
Worst compared(const CheckContext& context, const Scene& scene, const Truth& truth) {
  RenderOptions options;
  options.kernels = context.kernels;
  const RenderResult result = render(scene, context.device, options);
  const std::vector<double> radiance = result.film.mean("radiance"), cut = result.film.mean("cut");
  Worst worst;
  for (size_t i = 0; i < cut.size(); ++i)
    for (size_t c = 0; c < 3; ++c) {
      const Range range = truth(direction_of(scene, i), c);
      const double found = radiance[3 * i + c];
      const double error = std::max({found - range.high, range.low - (found + cut[i]), 0.0});
      worst.add(std::isfinite(found) ? error : NAN, 3 * i + c);
    }
  return worst;
}

std::string place(const Scene& scene, const Worst& worst, const std::string& what) {
  const size_t pixel = worst.at / 3, width = static_cast<size_t>(scene.film.width);
  return what + printed(": pixel (%zu, %zu) of %zu, channel %zu", pixel % width, pixel / width, width,
                     static_cast<size_t>(worst.at % 3));
}

/// The worst of several pictures.
struct Row {
  Worst worst;
  std::string where;

  void add(const Scene& scene, const Worst& found, const std::string& what) {
    if (found.error > worst.error) where = place(scene, found, what);
    worst.merge(found);
  }
  CheckResult result(const char* name, const char* truth) const {
    return {name, worst.cases, worst.error, bound, "radiance", truth, where};
  }
};

/// Share of the light that comes back from a ball, or a slab, met at `cosine` from index `n_i`, whose glass of index `n_t`
/// leaves `tau` of it on the way from the entry to the next border: R + T^2 tau / (1 - R tau).
double returned(double n_i, double n_t, double cosine, double tau) {
  const reference::Fresnel f = reference::fresnel(n_i, n_t, std::clamp(cosine, 0.0, 1.0));
  if (f.total_reflection) return 1.0;
  return f.R + f.T * f.T * tau / (1 - f.R * tau);
}

double leg(double hypotenuse, double other) { return std::sqrt(std::max((hypotenuse - other) * (hypotenuse + other), 0.0)); }

struct Shell {
  double radius, index, sigma_a;
};

/// Radiance of concentric shells, the outermost first, in a surround of radiance 1 and index `outside`, along a ray whose
/// distance from the centre times its index is `p`. That product is the same along all the path.
double shells_radiance(const std::vector<Shell>& shells, size_t k, double outside, double p) {
  const Shell& shell = shells[k];
  if (p >= outside * shell.radius) return 1.0;
  const double cosine = leg(1.0, p / (outside * shell.radius));
  if (p >= shell.index * shell.radius) return 1.0;  // total reflection
  const double half = leg(shell.radius, p / shell.index);
  if (k + 1 == shells.size() || p >= shell.index * shells[k + 1].radius)
    return returned(outside, shell.index, cosine, reference::transmittance(shell.sigma_a, 2 * half));
  const double way = half - leg(shells[k + 1].radius, p / shell.index);
  const double tau = reference::transmittance(shell.sigma_a, way);
  return returned(outside, shell.index, cosine, tau * tau * shells_radiance(shells, k + 1, shell.index, p));
}

/// The same around the origin, seen in `direction` from `eye` outside.
Range shells_seen(const std::vector<Shell>& shells, const dvec3& eye, const dvec3& direction) {
  const double p = glm::length(glm::cross(eye, direction)), error = ray_error * glm::length(eye);
  Range range;
  for (const double q : {std::max(p - error, 0.0), p, p + error}) range.add(shells_radiance(shells, 0, 1.0, q));
  return range;
}

const Spectrum absorption(0.1, 0.5, 2.0);

/// One thing in a white surround.
Scene ball_scene(double index, const Spectrum& sigma_a, int size) {
  Scene scene = picture({0.2, 0.3, 4}, {0, 0, 0}, 32, size);
  scene.materials.push_back(glass(index));
  scene.materials[0].absorption = sigma_a;
  add(scene, Sphere{{0, 0, 0}, 1.0}, 0);
  return scene;
}

CheckResult check_furnace(const CheckContext& context, int size) {
  Row row;
  for (const double n : {1.00028, 1.333, 1.5, 2.4}) {
    Scene scene = ball_scene(n, Spectrum(0.0), size);
    // As rendered by default, where much is cut: all that is missing must be told.
    scene.render.max_depth = 20;
    scene.render.min_weight = 1e-4;
    row.add(scene, compared(context, scene, [](const dvec3&, size_t) { return Range{1.0, 1.0}; }), printed("n = %g", n));
  }
  return row.result("slab-and-ball/white furnace", "radiance 1 all around gives 1 (clear ball)");
}

CheckResult check_ball(const CheckContext& context, int size) {
  Row row;
  for (const double n : {1.333, 1.5, 2.4}) {
    const Scene scene = ball_scene(n, absorption, size);
    const auto truth = [&](const dvec3& direction, size_t c) {
      return shells_seen({{1.0, n, absorption[static_cast<int>(c)]}}, scene.camera.eye, direction);
    };
    row.add(scene, compared(context, scene, truth), printed("n = %g, sigma_a = .1, .5, 2", n));
  }
  return row.result("slab-and-ball/absorbing ball", "R + T^2 tau/(1 - R tau), tau = exp(-2 sigma a cos_t)");
}

CheckResult check_nested(const CheckContext& context, int size) {
  struct Nested {
    double outer, inner;
    int priority;               // of the outer glass, against 0
  };
  Row row;
  // Glass around liquid, liquid around glass, around air, and a body that must not be seen at all: the outer one fills
  // its place.
  for (const Nested& n : {Nested{1.5, 1.333, 0}, {1.333, 1.5, 0}, {1.5, 1.0, 0}, {1.5, 2.4, 1}}) {
    Scene scene = ball_scene(n.outer, {0.1, 0.5, 2.0}, size);
    scene.materials[0].priority = n.priority;
    scene.materials.push_back(glass(n.inner));
    const Spectrum inside(2.0, 0.3, 0.1);
    scene.materials[1].absorption = inside;
    add(scene, Sphere{{0, 0, 0}, 0.6}, 1);
    const auto truth = [&](const dvec3& direction, size_t c) {
      const int channel = static_cast<int>(c);
      std::vector<Shell> shells = {{1.0, n.outer, absorption[channel]}};
      if (n.priority == 0) shells.push_back({0.6, n.inner, inside[channel]});
      return shells_seen(shells, scene.camera.eye, direction);
    };
    row.add(scene, compared(context, scene, truth), printed("n = %g around %g, priority %d", n.outer, n.inner, n.priority));
  }
  return row.result("slab-and-ball/nested balls", "the same, shell in shell; Schmidt and Budge 2002");
}

CheckResult check_inside(const CheckContext& context, int size) {
  Row row;
  const dvec3 eye(0.1, -0.2, 0.3);
  for (const double n : {1.333, 1.5, 2.0}) {
    Scene scene = ball_scene(n, absorption, size);
    scene.camera.eye = eye;
    scene.camera.look_at = {-1, 0.4, 0.2};
    scene.camera.vertical_fov = 120;
    const auto truth = [&](const dvec3& direction, size_t c) {
      const double across = glm::length(glm::cross(eye, direction)), half = leg(1.0, across);
      const double way = half - glm::dot(eye, direction), sigma_a = absorption[static_cast<int>(c)];
      const reference::Fresnel f = reference::fresnel(n, 1.0, half);
      const double around = f.R * reference::transmittance(sigma_a, 2 * half);
      const double value = n * n * f.T * reference::transmittance(sigma_a, way) / (1 - around);
      return Range{value, value};
    };
    row.add(scene, compared(context, scene, truth), printed("n = %g", n));
  }
  return row.result("slab-and-ball/eye in the ball", "n^2 T tau_1/(1 - R tau), radiance in the glass");
}

CheckResult check_slab(const CheckContext& context, int size) {
  Row row;
  constexpr double thickness = 0.5;
  for (const double n : {1.333, 1.5, 2.4})
    for (const bool mirrored : {false, true}) {
      // Channel by channel: light from above alone, from below alone, from both sides.
      Scene scene = picture({0, 2, 0}, {1, 0, 0}, 60, size);
      const Spectrum sigma_a = mirrored ? Spectrum(0, 0, 1.0) : Spectrum(0.7, 0.7, 0);
      scene.background = {1, 0, 1};
      scene.materials.push_back(glass(n));
      scene.materials[0].absorption = sigma_a;
      scene.materials.push_back(surface(Surface::opaque));
      scene.materials[1].emission = {0, 1, 1};
      add(scene, box({-40, -thickness, -40}, {40, 0, 40}, 0));
      add(scene, Plane{{0, -5, 0}, {0, 1, 0}, {}, {}}, 1);
      const auto truth = [&](const dvec3& direction, size_t c) {
        Range range;
        for (const double error : {-ray_error, 0.0, ray_error}) {
          const double cosine = std::clamp(-direction.y + error, 0.0, 1.0);
          const reference::Fresnel f = reference::fresnel(1.0, n, cosine);
          const double tau = reference::transmittance(sigma_a[static_cast<int>(c)], thickness / f.cos_theta_t);
          const double among = 1 - f.R * f.R * tau * tau;
          const double R = f.R + f.T * f.T * f.R * tau * tau / among, T = f.T * f.T * tau / among;
          range.add(c == 0 ? R : c == 1 ? T : R + T);
        }
        return range;
      };
      row.add(scene, compared(context, scene, truth), printed("n = %g, sigma_a = %g, %g, %g", n, sigma_a.x, sigma_a.y, sigma_a.z));
    }
  return row.result("slab-and-ball/slab", "R + T^2 R tau^2/(1 - R^2 tau^2), T^2 tau/(1 - R^2 tau^2)");
}

}  // namespace

std::vector<CheckResult> check_slab_and_ball(const CheckContext& context) {
  const int size = context.full ? 256 : 48;
  return {check_furnace(context, size), check_ball(context, size), check_nested(context, size),
          check_inside(context, size), check_slab(context, size)};
}

}  // namespace vitrum
