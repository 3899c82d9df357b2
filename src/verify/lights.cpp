// The irradiance of a plane under each kind of light, against closed forms.

#include <cmath>
#include <numbers>
#include <numeric>

#include "render/render.hpp"
#include "verify/estimates.hpp"
#include "verify/groups.hpp"
#include "verify/scenes.hpp"

namespace vitrum {
namespace {

using glm::dvec3;

constexpr double pi = std::numbers::pi;
constexpr uint64_t seeds = 2;               // each of as many replicates as a film holds; their spread is the error
constexpr double rounding = 2e-6;           // relative: radiance is summed up in floats

/// Where light `light` is: so far from the others that they cast no shadow there.
dvec3 lamp_of(size_t light) {
  constexpr double x[] = {0.2, 10, -10, 20, -20, 30, -30};
  return {x[light], 1.1, -0.1};
}
constexpr double disc_radius = 0.4, ball_radius = 0.3;
// Of the quad and the meshes, which shine along cross(edge_u, edge_v): downwards.
const dvec3 edge_u(0.7, 0, 0), edge_v(0, 0, 0.5);
dvec3 corner_of(size_t light) { return lamp_of(light) - 0.5 * (edge_u + edge_v); }

/// A white plane at y = 0 seen from `height` above it around `place`, with all kinds of light in one scene, so that one
/// build of the kernels serves them all; those but number `lit` are dark.
Scene white_plane(size_t lit, const dvec3& place, double height, double vertical_fov, int size) {
  Scene scene;
  scene.camera = {CameraType::pinhole, place + dvec3(0.5, height, 0.4), place, {0, 1, 0}, vertical_fov};
  scene.film.width = scene.film.height = size;
  scene.materials.push_back(surface(Surface::opaque, 1.0));
  add(scene, Plane{{0, 0, 0}, {0, 1, 0}, {}, {}}, 0);
  const auto emitted = [lit](size_t light) { return Spectrum(light == lit ? 1.0 : 0.0); };
  scene.lights.push_back({"point", {}, PointLight{lamp_of(0), emitted(0)}});
  scene.lights.push_back({"directional", {}, DirectionalLight{glm::normalize(dvec3(1, -2, 0.5)), emitted(1)}});
  scene.lights.push_back({"disc", {}, DiscLight{lamp_of(2), {0, -1, 0}, disc_radius, emitted(2)}});
  scene.lights.push_back({"sphere", {}, SphereLight{lamp_of(3), ball_radius, emitted(3)}});
  scene.lights.push_back({"quad", {}, QuadLight{corner_of(4), edge_u, edge_v, emitted(4)}});
  // A mesh is a light only if it emits: as good as dark.
  for (const size_t mesh : {5, 6})
    add_panel(scene, corner_of(mesh), edge_u, edge_v, mesh == 5 ? 1 : 8, mesh == lit ? 1.0 : 1e-30);
  return scene;
}

/// Irradiance [W/m2] at `place` on the plane y = 0 by light `light` alone.
double irradiance(size_t light, const dvec3& place) {
  const dvec3 to = lamp_of(light) - place;
  const double h = to.y, r2 = to.x * to.x + to.z * to.z, d2 = glm::dot(to, to);
  switch (light) {
    case 0: return h / (d2 * std::sqrt(d2));
    case 1: return 2 / std::sqrt(1 + 4 + 0.25);
    case 2: {                   // Foote 1915: a disc parallel to the plane, at any place
      const double R2 = disc_radius * disc_radius, sum = h * h + r2 + R2;
      return 0.5 * pi * (1 - (h * h + r2 - R2) / std::sqrt(sum * sum - 4 * r2 * R2));
    }
    case 3: return pi * ball_radius * ball_radius / d2 * (h / std::sqrt(d2));
    default: return panel_irradiance(corner_of(light), edge_u, edge_v, place);
  }
}

Film rendered(const CheckContext& context, const Scene& scene) {
  RenderOptions options;
  options.kernels = context.kernels;
  return render(scene, context.device, options).film;
}

/// Lights without an area: pixel by pixel.
CheckResult check_points(const CheckContext& context) {
  const int size = context.full ? 256 : 48;
  Worst worst;
  std::string where;
  for (size_t light = 0; light < 2; ++light) {
    Scene scene = white_plane(light, lamp_of(light) * dvec3(1, 0, 1) + dvec3(0.3, 0, 0.1), 2.0, 70, size);
    scene.render.samples = 1;
    const std::vector<double> radiance = rendered(context, scene).mean("radiance");
    const Camera& camera = scene.camera;
    const dvec3 forward = glm::normalize(camera.look_at - camera.eye);
    const dvec3 right = glm::normalize(glm::cross(forward, camera.up)), up = glm::cross(right, forward);
    const double half = std::tan(0.5 * camera.vertical_fov * pi / 180);
    for (int i = 0; i < size * size; ++i) {
      const dvec3 ray = forward + half * ((2.0 * (i % size) + 1) / size - 1) * right + half * (1 - (2.0 * (i / size) + 1) / size) * up;
      const dvec3 place = camera.eye - camera.eye.y / ray.y * ray;
      const double error = std::abs(pi * radiance[3 * static_cast<size_t>(i)] / irradiance(light, place) - 1);
      if (error > worst.error) where = printed("%s light: pixel (%d, %d) of %d", light == 0 ? "point" : "directional", i % size, i / size, size);
      worst.add(error, static_cast<uint64_t>(i));
    }
  }
  return {"lights/point and directional", worst.cases, worst.error, 1e-5, "relative", "I h/d^3, E cos, each pixel", where};
}

}  // namespace

std::vector<CheckResult> check_lights(const CheckContext& context) {
  constexpr const char* names[] = {"", "", "disc", "sphere", "quad", "mesh of 2 triangles", "mesh of 128 triangles"};
  std::vector<CheckResult> rows = {check_points(context)};
  Estimates exact, meshes;
  for (size_t light = 2; light < std::size(names); ++light)
    for (const dvec3& aside : {dvec3(0, 0, 0), dvec3(0.7, 0, 0.5)}) {
      const dvec3 place = lamp_of(light) * dvec3(1, 0, 1) + aside;
      // From below the light, and so narrow that the irradiance over the picture is that of its centre, within 1e-6.
      Scene scene = white_plane(light, place, 0.7, 0.02, 16);
      scene.render.passes = Film::max_replicates;
      scene.render.samples = Film::max_replicates * (context.full ? 1024 : 128);
      std::vector<double> means;
      for (uint64_t seed = 0; seed < seeds; ++seed) {
        scene.render.seed = seed;
        const Film film = rendered(context, scene);
        for (int replicate = 0; replicate < film.replicates(); ++replicate) {
          const FilmPlane& plane = *film.plane("radiance", replicate);
          const double total = std::accumulate(plane.sums.begin(), plane.sums.end(), 0.0);
          const double mean = total / static_cast<double>(plane.sums.size()) / plane.samples;
          means.push_back(pi * mean / irradiance(light, place));
        }
      }
      (light < 5 ? exact : meshes).add(means, 1.0, rounding, printed("%s, at (%g, 0, %g)", names[light], place.x, place.z));
    }
  constexpr const char* blunt = "standard error of the estimates";
  exact.rows("lights/disc, sphere, quad", "Foote 1915; pi (R/d)^2 cos; Lambert's polygon", 5e-4, "relative", blunt, rows);
  meshes.rows("lights/emissive meshes", "Lambert's polygon", 5e-4, "relative", blunt, rows);
  return rows;
}

}  // namespace vitrum
