// The reference renderer against closed forms: furnaces, slabs, direct light, nested media, and what is cut.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "reference/fresnel.hpp"
#include "reference/renderer.hpp"

using namespace vitrum;
using reference::Renderer;
using std::numbers::pi;

namespace {

Material glass(double index, double sigma_a = 0, int priority = 0) {
  Material material;
  material.surface = Surface::dielectric;
  material.index.value = index;
  material.absorption = Spectrum(sigma_a);
  material.priority = priority;
  return material;
}

Material surface(Surface kind, double diffuse = 0, double emission = 0) {
  Material material;
  material.surface = kind;
  material.diffuse = Spectrum(diffuse);
  material.emission = Spectrum(emission);
  return material;
}

/// A box as a mesh of 12 triangles, fronts outwards.
Mesh box(const glm::vec3& low, const glm::vec3& high, uint32_t material) {
  Mesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.positions.emplace_back(k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z);
  for (const glm::uvec4 q : {glm::uvec4(0, 4, 6, 2), {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}) {
    mesh.triangles.emplace_back(q.x, q.y, q.z);
    mesh.triangles.emplace_back(q.x, q.z, q.w);
  }
  mesh.materials.assign(12, material);
  return mesh;
}

void add(Scene& scene, std::variant<Sphere, Plane, Triangle, Mesh> geometry, uint32_t material = none) {
  scene.shapes.push_back({"shape", {}, material, std::move(geometry)});
}

/// A camera of one pixel that looks from `eye` to `look_at` through the centre of its film, (0.5, 0.5).
Scene looking(const glm::dvec3& eye, const glm::dvec3& look_at, const glm::dvec3& up = {0, 0, 1}) {
  Scene scene;
  scene.camera = {CameraType::pinhole, eye, look_at, up, 1.0};
  scene.film.width = scene.film.height = 1;
  scene.render.min_weight = 1e-14;
  scene.render.max_depth = 200;
  return scene;
}

reference::Sample seen(const Scene& scene) { return Renderer(scene).at({0.5, 0.5}); }

void add_point_light(Scene& scene, const glm::dvec3& position, double intensity) {
  scene.lights.push_back({"lamp", {}, PointLight{position, Spectrum(intensity)}});
}

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

/// Power shares of an unpolarised slab: Stokes' sums over all inner reflections.
struct Slab {
  double R, T;
};
Slab slab(double n, double tau, double cos_i) {
  const double R = reference::fresnel(1, n, cos_i).R;
  return {R + (1 - R) * (1 - R) * R * tau * tau / (1 - R * R * tau * tau),
          (1 - R) * (1 - R) * tau / (1 - R * R * tau * tau)};
}

}  // namespace

TEST_CASE("white furnace: a ball of glass in a uniform surround") {
  for (const double sigma_a : {0.0, 0.7}) {
    for (const double offset : {0.0, 0.3, 0.9, 0.999}) {
      CAPTURE(sigma_a);
      CAPTURE(offset);
      Scene scene = looking({offset, 0, 5}, {offset, 0, 0}, {0, 1, 0});
      scene.background = {1, 2, 4};
      scene.materials = {glass(1.5, sigma_a)};
      add(scene, Sphere{{0, 0, 0}, 1}, 0);
      const double cos_i = std::sqrt(1 - offset * offset), cos_t = std::sqrt(1 - offset * offset / 2.25);
      const double R = reference::fresnel(1, 1.5, cos_i).R, tau = std::exp(-2 * sigma_a * cos_t);
      const double expected = R + (1 - R) * (1 - R) * tau / (1 - R * tau);
      const auto sample = seen(scene);
      CHECK(sample.radiance.r + sample.energy_cut == doctest::Approx(expected).epsilon(1e-12));
      CHECK(sample.radiance.b == doctest::Approx(4 * sample.radiance.r).epsilon(1e-14));
    }
  }
}

TEST_CASE("white furnace: what is cut by depth and by weight is what is missing") {
  Scene scene = looking({0.9, 0, 5}, {0.9, 0, 0}, {0, 1, 0});
  scene.background = Spectrum(1);
  scene.materials = {glass(1.5)};
  add(scene, Sphere{{0, 0, 0}, 1}, 0);
  scene.render.min_weight = 1e-2;
  const auto by_weight = seen(scene);
  CHECK(by_weight.energy_cut > 1e-5);
  CHECK(by_weight.energy_cut < 1e-2);
  CHECK(by_weight.radiance.g + by_weight.energy_cut == doctest::Approx(1).epsilon(1e-14));

  scene.render.min_weight = 0;
  const double R = reference::fresnel(1, 1.5, std::sqrt(1 - 0.81)).R;
  double left = 1;                          // before the first surface
  for (int depth = 1; depth < 5; ++depth) {
    scene.render.max_depth = depth;
    const auto by_depth = seen(scene);
    CHECK(by_depth.radiance.g + by_depth.energy_cut == doctest::Approx(1).epsilon(1e-14));
    // A path that has met `depth` surfaces goes no further: both branches at the last of them are cut.
    CHECK(by_depth.energy_cut == doctest::Approx(left).epsilon(1e-14));
    left *= depth == 1 ? 1 - R : R;
  }
}

TEST_CASE("slab: a mesh box reflects and transmits what Stokes' sums say") {
  for (const double sigma_a : {0.0, 0.4}) {
    for (const double degrees : {0.0, 30.0, 80.0}) {
      CAPTURE(sigma_a);
      CAPTURE(degrees);
      // 1 m thick, seen from above; what is transmitted meets a light plane, what is reflected another.
      const double angle = glm::radians(degrees), cos_i = std::cos(angle);
      Scene scene = looking({-5 * std::tan(angle), 5, 0}, {0, 0, 0});
      scene.materials = {glass(1.5, sigma_a), surface(Surface::unlit, 0, 1), surface(Surface::unlit, 0.25, 0.75)};
      add(scene, box({-4000, -1, -4000}, {4000, 0, 4000}, 0));
      add(scene, Plane{{0, -3, 0}, {0, 1, 0}, {}, {}}, 1);
      const double cos_t = std::sqrt(1 - std::pow(std::sin(angle) / 1.5, 2)), tau = std::exp(-sigma_a / cos_t);
      const Slab expected = slab(1.5, tau, cos_i);
      CHECK(seen(scene).radiance.r == doctest::Approx(expected.T).epsilon(1e-12));
      scene.shapes.pop_back();
      add(scene, Plane{{0, 30, 0}, {0, 1, 0}, {}, {}}, 2);
      CHECK(seen(scene).radiance.r == doctest::Approx(expected.R).epsilon(1e-12));
      if (sigma_a == 0) {
        const double R = reference::fresnel(1, 1.5, cos_i).R;
        CHECK(expected.R == doctest::Approx(2 * R / (1 + R)).epsilon(1e-14));
      }
    }
  }
}

TEST_CASE("slab with a constant reflectance; total reflection all the same") {
  Scene scene = looking({0, 5, 0}, {0, 0, 0});
  scene.render.constant_reflectance = 0.1;
  scene.materials = {glass(1.5), surface(Surface::unlit, 0, 1)};
  add(scene, box({-40, -1, -40}, {40, 0, 40}, 0));
  add(scene, Plane{{0, -3, 0}, {0, 1, 0}, {}, {}}, 1);
  CHECK(seen(scene).radiance.r == doctest::Approx(0.9 / 1.1).epsilon(1e-12));

  // From inside, beyond the critical angle of 41.8 degrees, against a top above which all is bright.
  scene = looking({0, -0.5, 0}, {1, 0, 0});
  scene.render.constant_reflectance = 0.1;
  scene.background = Spectrum(1);
  scene.materials = {glass(1.5), surface(Surface::opaque)};
  add(scene, box({-40, -1, -40}, {40, 0, 40}, 0));
  add(scene, Plane{{0, -1, 0}, {0, 1, 0}, {}, {}}, 1);
  std::swap(scene.shapes[0], scene.shapes[1]);  // of what coincides the first is met
  CHECK(seen(scene).radiance.r == 0);
  scene.camera.look_at = {0.1, 0, 0};
  CHECK(seen(scene).radiance.r == doctest::Approx(0.9 * 2.25).epsilon(1e-12));
}

TEST_CASE("radiance scales with the square of the index where the eye is in the medium") {
  // Snell's window from 0.3 m below the surface of a box of water that holds the eye.
  Scene scene = looking({0.1, -0.3, 0.2}, {0.1, 0, 0.2});
  scene.background = Spectrum(1);
  scene.materials = {glass(1.333, 0.5)};
  add(scene, box({-4, -1, -4}, {4, 0, 4}, 0));
  scene.render.max_depth = 1;               // the way up alone is cut there
  CHECK(seen(scene).radiance.r == 0);
  CHECK(seen(scene).energy_cut == doctest::Approx(std::exp(-0.15)).epsilon(1e-14));
  scene.render.max_depth = 200;
  const double R = std::pow(0.333 / 2.333, 2), tau = std::exp(-0.5), half_way = std::exp(-0.15);
  // Up at once, or after going down and up again any number of times; and what leaves through the bottom.
  const double up = half_way * (1 - R) / (1 - R * R * tau * tau), down = half_way * R * tau * (1 - R) / (1 - R * R * tau * tau);
  CHECK(seen(scene).radiance.r == doctest::Approx(1.333 * 1.333 * (up + down)).epsilon(1e-12));
}

TEST_CASE("media that overlap by priority, and media that touch, have one interface") {
  // Glass 1 m on water 1 m on a light plane, straight from above.
  const double R_glass = 0.04, R_contact = std::pow((1.5 - 1.333) / (1.5 + 1.333), 2), R_water = std::pow(0.333 / 2.333, 2);
  // Stack of three interfaces, incoherent, clear: sum of R / (1 - R) adds up (Stokes 1862).
  const auto ratio = [](double R) { return R / (1 - R); };
  const double T = 1 / (1 + ratio(R_glass) + ratio(R_contact) + ratio(R_water));

  for (const float overlap : {0.0f, 0.25f}) {
    for (const bool water_first : {false, true}) {
      CAPTURE(overlap);
      CAPTURE(water_first);
      Scene scene = looking({0.1, 5, 0.2}, {0.1, 0, 0.2});
      scene.render.min_weight = 1e-12;
      scene.materials = {glass(1.5, 0, 1), glass(1.333, 0, 0), surface(Surface::unlit, 0, 1)};
      add(scene, box({-4, 0, -4}, {4, 1, 4}, 0));
      add(scene, box({-4, -1, -4}, {4, overlap, 4}, 1));
      if (water_first) std::swap(scene.shapes[0], scene.shapes[1]);
      add(scene, Plane{{0, -3, 0}, {0, 1, 0}, {}, {}}, 2);
      CHECK(seen(scene).radiance.r == doctest::Approx(T).epsilon(1e-10));
    }
  }
}

TEST_CASE("two bodies of the same glass that touch are one") {
  Scene scene = looking({0, 5, 0}, {0, 0, 0});  // straight along the diagonals' crossing
  scene.materials = {glass(1.5, 0.3), surface(Surface::unlit, 0, 1)};
  add(scene, box({-4, 0, -4}, {4, 1, 4}, 0));
  add(scene, box({-4, -1, -4}, {4, 0, 4}, 0));
  add(scene, Plane{{0, -3, 0}, {0, 1, 0}, {}, {}}, 1);
  CHECK(seen(scene).radiance.r == doctest::Approx(slab(1.5, std::exp(-0.6), 1).T).epsilon(1e-12));
}

TEST_CASE("opaque glass lets nothing through and gives no NaN") {
  Scene scene = looking({0, 0, 5}, {0, 0, 0}, {0, 1, 0});
  scene.background = Spectrum(1);
  scene.materials = {glass(1.5)};
  scene.materials[0].absorption = {std::numeric_limits<double>::infinity(), 0, 1};
  add(scene, Sphere{{0, 0, 0}, 1}, 0);
  const Spectrum radiance = seen(scene).radiance;
  CHECK(radiance.r == doctest::Approx(0.04).epsilon(1e-12));
  CHECK(radiance.g == doctest::Approx(1).epsilon(1e-12));
  CHECK(radiance.b < 0.2);
}

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

TEST_CASE("mirrors face to face: every reflection meets one more surface") {
  Scene scene = looking({0, 0.5, 0}, {0, 0, 0});
  scene.materials = {surface(Surface::mirror), surface(Surface::mirror)};
  scene.materials[1].emission = Spectrum(1);
  add(scene, Plane{{0, 0, 0}, {0, 1, 0}, {}, {}}, 0);
  add(scene, Plane{{0, 1, 0}, {0, 1, 0}, {}, {}}, 1);
  scene.render.max_depth = 9;
  CHECK(seen(scene).radiance.r == doctest::Approx(4));
  CHECK(seen(scene).energy_cut == 1);
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
