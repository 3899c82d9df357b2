// The reference renderer against closed forms of direct light, textures and meshes, and on the default scene.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "reference/renderer.hpp"
#include "reference_scenes.hpp"

using namespace vitrum;
using reference::Renderer;
using std::numbers::pi;

namespace {

/// The default scene, grass as a texture of 4 x 4 random greens.
Scene default_scene() {
  Scene scene;
  scene.camera = {CameraType::pinhole, {2, 1.5, 2}, {0, 0.5, 0}, {0, 1, 0}, 2 * glm::degrees(std::atan(0.5))};
  scene.background = {0.1, 0.3, 0.6};
  scene.materials = {surface(Surface::opaque), glass(1.5), surface(Surface::opaque, 0.2, 0.1)};
  scene.materials[0].diffuse_texture = 0;
  scene.materials[1].specular = Spectrum(0.3);
  scene.materials[1].shininess = 42;
  Texture grass;
  grass.width = grass.height = 4;
  for (int k = 0; k < 16; ++k) grass.texels.emplace_back(0.1f, 0.3f + 0.04f * static_cast<float>(k * 7 % 16), 0.0f);
  scene.textures = {grass};
  add(scene, Plane{{0, 0, 0}, {0, 1, 0}, {-0.2, 0, 0}, {0, 0, 0.2}}, 0);
  add(scene, Sphere{{0, 0.5, 0}, 0.3}, 1);
  add(scene, Triangle{{-0.2, 0.1, 0.9}, {0.2, 0.1, 0.9}, {-0.2, 0.1, -0.1}, {}, {}, {}}, 2);
  add_point_light(scene, {0, 1, 0}, pi);
  return scene;
}

}  // namespace

TEST_CASE("Lambert and Phong under a point light and a directional light, from either side") {
  for (const double side : {1.0, -1.0}) {
    CAPTURE(side);
    Scene scene = looking({1, side, 0}, {0, 0, 0});
    scene.materials = {surface(Surface::opaque, 0.5, 0.125)};
    scene.materials[0].specular = Spectrum(0.25);
    scene.materials[0].shininess = 10;
    add(scene, Plane{{0, 0, 0}, {0, 1, 0}, {}, {}}, 0);
    add_point_light(scene, {-2, 3 * side, 1}, 7);
    const double squared = 14, cos_theta = 3 / std::sqrt(squared), irradiance = 7 / squared * cos_theta;
    // Mirrored light leaves along (2, 3, -1); the viewer is along (1, 1, 0).
    const double highlight = 0.25 * 12 / (2 * pi) * std::pow(5 / std::sqrt(2 * squared), 10);
    CHECK(seen(scene).radiance.g == doctest::Approx(0.125 + (0.5 / pi + highlight) * irradiance).epsilon(1e-12));

    scene.lights[0].emitter = DirectionalLight{glm::normalize(glm::dvec3(2, -3 * side, -1)), Spectrum(5)};
    CHECK(seen(scene).radiance.g == doctest::Approx(0.125 + (0.5 / pi + highlight) * 5 * cos_theta).epsilon(1e-12));

    scene.lights[0].emitter = PointLight{{-2, -3 * side, 1}, Spectrum(7)};
    CHECK(seen(scene).radiance.g == doctest::Approx(0.125).epsilon(1e-12));  // from behind

    scene.lights[0].emitter = PointLight{{-2, 3 * side, 1}, Spectrum(7)};
    scene.materials.push_back(glass(1.5));
    add(scene, Sphere{{-1, 1.5 * side, 0.5}, 0.1}, 1);
    CHECK(seen(scene).radiance.g == doctest::Approx(0.125).epsilon(1e-12));  // glass throws a shadow

    scene.render.lights = false;
    scene.shapes.pop_back();
    CHECK(seen(scene).radiance.g == doctest::Approx(0.125).epsilon(1e-12));
  }
}

TEST_CASE("glass with a highlight and a diffuse term shows them outside, unshadowed by itself") {
  Scene scene = looking({0, 0, 5}, {0, 0, 0}, {0, 1, 0});
  scene.materials = {glass(1.5)};
  scene.materials[0].diffuse = Spectrum(0.3);
  scene.materials[0].specular = Spectrum(0.3);
  scene.materials[0].shininess = 42;
  add(scene, Sphere{{0, 0, 0}, 1}, 0);
  add_point_light(scene, {0, 0, 3}, 8);     // 2 m from the surface, behind which all hits are shadowed
  CHECK(seen(scene).radiance.r == doctest::Approx(2 * (0.3 / pi + 0.3 * 44 / (2 * pi))).epsilon(1e-12));
}

TEST_CASE("textures: nearest and bilinear, repeated and clamped, rows upwards") {
  Scene scene = looking({0, 1, 0}, {0, 0, 0});
  scene.materials = {surface(Surface::unlit)};
  scene.materials[0].diffuse_texture = 0;
  Texture texture;
  texture.width = 2, texture.height = 2;
  texture.texels = {glm::vec3(1), glm::vec3(2), glm::vec3(4), glm::vec3(8)};  // upper row, then lower row
  scene.textures = {texture};
  add(scene, Plane{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}}, 0);
  const auto at = [&](double u, double v) {
    scene.camera.eye = {u, 1, v}, scene.camera.look_at = {u, 0, v};
    return seen(scene).radiance.r;
  };
  CHECK(at(0.25, 0.25) == doctest::Approx(4).epsilon(1e-12));
  CHECK(at(0.75, 0.75) == doctest::Approx(2).epsilon(1e-12));
  CHECK(at(0.5, 0.25) == doctest::Approx(6).epsilon(1e-12));
  CHECK(at(0.5, 0.5) == doctest::Approx(3.75).epsilon(1e-12));
  CHECK(at(0.05, 0.25) == doctest::Approx(4 + 4 * 0.4).epsilon(1e-12));  // wraps to the right
  CHECK(at(-2.95, 5.25) == doctest::Approx(4 + 4 * 0.4).epsilon(1e-12));
  scene.textures[0].clamp = true;
  CHECK(at(0.05, 0.25) == doctest::Approx(4).epsilon(1e-12));
  CHECK(at(7, -3) == doctest::Approx(8).epsilon(1e-12));
  scene.textures[0].filter = TextureFilter::nearest;
  CHECK(at(0.49, 0.51) == 1);
  CHECK(at(0.51, 0.49) == 8);
  scene.textures[0].clamp = false;
  scene.textures[0].scale = {2, 1}, scene.textures[0].offset = {0.5, 0};
  CHECK(at(0.3, 0.9) == 1);                 // u = 1.1
  scene.materials[0].texture_replaces_diffuse = false;
  scene.materials[0].diffuse = Spectrum(0.5);
  CHECK(at(0.3, 0.9) == 0.5);
  scene.render.textures = false;
  CHECK(at(0.3, 0.9) == 0.5);
  scene.materials[0].diffuse = Spectrum(0.75);
  CHECK(at(0.3, 0.9) == 0.75);
}

TEST_CASE("meshes: shading normals and texture coordinates are interpolated") {
  Scene scene = looking({0.25, 1, 0.25}, {0.25, 0, 0.25}, {1, 0, 0});
  scene.materials = {surface(Surface::opaque, 1)};
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}};
  mesh.triangles = {{0, 1, 2}};
  mesh.materials = {0};
  mesh.normals = {{0, 1, 0}, glm::normalize(glm::vec3(0.6, 0.8, 0)), {0, 1, 0}};
  mesh.normal_indices = {{0, 1, 2}};
  add(scene, mesh);
  scene.lights.push_back({"sun", {}, DirectionalLight{{0, -1, 0}, Spectrum(pi)}});
  const glm::dvec3 normal = glm::normalize(0.75 * glm::dvec3(0, 1, 0) + 0.25 * glm::dvec3(mesh.normals[1]));
  CHECK(seen(scene).radiance.r == doctest::Approx(normal.y).epsilon(1e-12));
  std::get<Mesh>(scene.shapes[0].geometry).normal_indices = {{none, none, none}};
  CHECK(seen(scene).radiance.r == doctest::Approx(1).epsilon(1e-12));
}

TEST_CASE("default scene: the horizon, the ball's outline, and which edges are near") {
  const Scene scene = default_scene();
  const Renderer renderer(scene);
  const auto is_sky = [&](double x, double y) { return renderer.at({x, y}).radiance == scene.background; };
  // forward is (-2, -1, -2) / 3, so the horizon is tan(asin(1/3)) above the centre: 181.02 of 512 pixel heights.
  const double horizon = 256 - 512 / std::sqrt(8.0);
  CHECK(is_sky(10, horizon - 1e-6));
  CHECK(!is_sky(10, horizon + 1e-3));

  // The ball is 3 m away; its outline is a circle of tan(asin(0.1)).
  const double outline = 512 * std::tan(std::asin(0.1));
  for (const glm::dvec2 way : {glm::dvec2(1, 0), {-1, 0}, {0, 1}, {0.6, -0.8}}) {
    const glm::dvec2 edge = glm::dvec2(256) + outline * way;
    CHECK(renderer.edges_within(edge + 5e-6 * way, 1e-5).silhouette);
    CHECK(renderer.at(edge + 1e-6 * way).decisions.surfaces != renderer.at(edge - 1e-6 * way).decisions.surfaces);
    CHECK(renderer.at(edge + 2e-6 * way).decisions.surfaces == renderer.at(edge + 1e-6 * way).decisions.surfaces);
  }
  CHECK(!renderer.edges_within({10, 10}, 1e-5).any());

  // The ball's shadow on the lawn has the radius tan(asin(0.6)) = 0.75, since it touches the cone from (0, 1, 0).
  const auto film_of = [&](const glm::dvec3& point) {
    const glm::dvec3 forward = glm::dvec3(-2, -1, -2) / 3.0, right = glm::normalize(glm::cross(forward, {0, 1, 0}));
    const glm::dvec3 to = point - scene.camera.eye, ray = to / glm::dot(to, forward);
    return glm::dvec2(256 + 512 * glm::dot(ray, right), 256 - 512 * glm::dot(ray, glm::cross(right, forward)));
  };
  const auto shadow = renderer.edges_within(film_of({0.75, 0, 0}), 1e-5);
  CHECK(shadow.shadow);
  CHECK(!shadow.silhouette);
  CHECK(renderer.at(film_of({0.74, 0, 0})).radiance == Spectrum(0));
  const glm::dvec3 lit(0.76, 0, 0.1);
  const double squared = glm::dot(lit - glm::dvec3(0, 1, 0), lit - glm::dvec3(0, 1, 0));
  CHECK(renderer.at(film_of(lit)).radiance.r ==
        doctest::Approx(double(0.1f) * std::pow(squared, -1.5)).epsilon(1e-9));

  // Texels of 1.25 m, their centres' lines at odd multiples of 0.625 m.
  const auto texel = renderer.edges_within(film_of({0.625, 0, 1.2}), 1e-5);
  CHECK(texel.texel);
  CHECK(!texel.shadow);
  CHECK(!renderer.edges_within(film_of({0.7, 0, 1.2}), 1e-5).any());
}

TEST_CASE("lights with an area are refused, unless lights are off") {
  Scene scene = looking({0, 1, 0}, {0, 0, 0});
  scene.lights.push_back({"panel", {}, QuadLight{}});
  CHECK_THROWS_AS(Renderer{scene}, std::invalid_argument);
  scene.render.lights = false;
  CHECK_NOTHROW(Renderer{scene});
}

TEST_CASE("render gives each position what a renderer gives it") {
  const Scene scene = default_scene();
  const auto samples = reference::render(scene, {{256, 256}, {300.5, 400.25}});
  REQUIRE(samples.size() == 2);
  CHECK(samples[1].radiance == Renderer(scene).at({300.5, 400.25}).radiance);
  CHECK(samples[0].decisions == Renderer(scene).at({256, 256}).decisions);
  CHECK(samples[0].energy_cut > 0);
}
