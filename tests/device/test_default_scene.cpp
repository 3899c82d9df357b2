// Pictures without caustics, device against the reference renderer in double, on the same sample positions.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>

#include "reference/renderer.hpp"
#include "render/render.hpp"
#include "scene/scene_file.hpp"
#include "scene/textures.hpp"

namespace vitrum {
namespace {

constexpr double tolerance = 1e-4;          // of a pixel's radiance
constexpr double edge_distance = 1e-5;      // of the picture's height

std::string model(const char* name) { return std::string(VITRUM_SOURCE_DIR "/models/") + name + "/scene.toml"; }

/// One sample in the centre of each pixel, no caustics.
Scene small_scene(const char* name, std::vector<std::string> overrides = {}) {
  overrides.insert(overrides.begin(),
                   {"film.size=[64, 64]", "render.samples=1", "render.caustics=false"});
  Scene scene = load_scene(model(name), overrides);
  load_textures(scene);
  return scene;
}

/// Largest difference of a channel, relative to the pixel's brightest one.
double relative_difference(const double* seen, const Spectrum& truth) {
  double difference = 0, brightest = 0;
  for (int c = 0; c < 3; ++c) {
    if (!std::isfinite(seen[c])) return HUGE_VAL;
    difference = std::max(difference, std::abs(seen[c] - truth[c]));
    brightest = std::max(brightest, std::abs(truth[c]));
  }
  return difference > 0 ? difference / brightest : 0.0;
}

/// Every pixel within the tolerance, but for those on an edge, which are listed. At most `most_edges` of them.
void check_against_reference(const Scene& scene, size_t most_edges) {
  Device device;
  const RenderResult result = render(scene, device, {});
  const std::vector<double> radiance = result.film.mean("radiance");
  const std::vector<double> cut = result.film.mean("cut");
  const reference::Renderer truth(scene);
  const int width = scene.film.width, height = scene.film.height;
  double worst = 0, sum = 0;
  size_t edges = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const size_t pixel = static_cast<size_t>(y * width + x);
      const glm::dvec2 position(x + 0.5, y + 0.5);
      const reference::Sample sample = truth.at(position);
      const double difference = relative_difference(&radiance[3 * pixel], sample.radiance);
      sum += sample.radiance.y;
      const bool same_cut = std::abs(cut[pixel] - sample.energy_cut) <= tolerance;  // of the weight at the eye
      if (difference <= tolerance && same_cut) {
        worst = std::max(worst, difference);
        continue;
      }
      std::ostringstream what;
      what << "pixel " << x << ", " << y << ": (" << radiance[3 * pixel] << ", " << radiance[3 * pixel + 1] << ", "
           << radiance[3 * pixel + 2] << "), reference (" << sample.radiance.x << ", " << sample.radiance.y << ", "
           << sample.radiance.z << "), off by " << difference << "; cut " << cut[pixel] << ", reference "
           << sample.energy_cut;
      const reference::Edges edge = truth.edges_within(position, edge_distance * height);
      if (edge.any()) {
        ++edges;
        what << (edge.silhouette ? ", silhouette" : "") << (edge.shadow ? ", shadow" : "")
             << (edge.texel ? ", texel" : "");
        MESSAGE(what.str());
      } else {
        FAIL_CHECK(what.str());
      }
    }
  MESSAGE("worst difference " << worst << "; pixels on an edge: " << edges << " of " << width * height);
  CHECK(edges <= most_edges);
  CHECK(sum > 0);
}

/// A material of a dielectric that shows nothing but what comes through it.
Material glass(double index, const Spectrum& absorption = Spectrum(0.0), int priority = 0) {
  Material material;
  material.name = "glass";
  material.surface = Surface::dielectric;
  material.index.value = index;
  material.absorption = absorption;
  material.priority = priority;
  return material;
}

uint32_t add(Scene& scene, Material material) {
  scene.materials.push_back(std::move(material));
  return static_cast<uint32_t>(scene.materials.size() - 1);
}

void add(Scene& scene, std::variant<Sphere, Plane, Triangle, Mesh> geometry, uint32_t material = none) {
  scene.shapes.push_back({"shape " + std::to_string(scene.shapes.size()), {}, material, std::move(geometry)});
}


Shape& shape(Scene& scene, const std::string& name) {
  return *std::find_if(scene.shapes.begin(), scene.shapes.end(), [&](const Shape& s) { return s.name == name; });
}

/// A sphere in rings of latitude and sectors of longitude, with its exact normals at the corners.
Mesh tessellated_sphere(const glm::vec3& centre, float radius, uint32_t rings, uint32_t sectors, uint32_t material) {
  Mesh mesh;
  for (uint32_t ring = 0; ring <= rings; ++ring)
    for (uint32_t sector = 0; sector < sectors; ++sector) {
      const float theta = std::numbers::pi_v<float> * static_cast<float>(ring) / static_cast<float>(rings);
      const float phi = 2 * std::numbers::pi_v<float> * static_cast<float>(sector) / static_cast<float>(sectors);
      const glm::vec3 normal(std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi));
      const bool pole = ring == 0 || ring == rings;
      mesh.normals.push_back(pole ? glm::vec3(0, ring == 0 ? 1 : -1, 0) : normal);
      mesh.positions.push_back(centre + radius * mesh.normals.back());
    }
  const auto add_triangle = [&](uint32_t a, uint32_t b, uint32_t c) {
    mesh.triangles.emplace_back(a, b, c);
    mesh.materials.push_back(material);
  };
  for (uint32_t ring = 0; ring < rings; ++ring)
    for (uint32_t sector = 0; sector < sectors; ++sector) {
      const uint32_t a = ring * sectors + sector, b = ring * sectors + (sector + 1) % sectors;
      const uint32_t c = a + sectors, d = b + sectors;
      if (ring + 1 < rings) add_triangle(a, c, d);
      if (ring > 0) add_triangle(a, d, b);
    }
  // At a pole all corners of a ring coincide, exactly: each sector's triangle takes its own.
  mesh.normal_indices = mesh.triangles;
  return mesh;
}

/// Two triangles with texture coordinates, front up.
Mesh textured_floor(float half, float repeats, uint32_t material) {
  Mesh mesh;
  mesh.positions = {{-half, 0, half}, {half, 0, half}, {half, 0, -half}, {-half, 0, -half}};
  mesh.texcoords = {{0, 0}, {repeats, 0}, {repeats, repeats}, {0, repeats}};
  mesh.triangles = mesh.texcoord_indices = {{0, 1, 2}, {0, 2, 3}};
  mesh.materials = {material, material};
  return mesh;
}

}  // namespace

TEST_CASE("default scene without caustics: device against reference") {
  check_against_reference(small_scene("default_scene"), 8);
}

TEST_CASE("default scene by every shader of glass") {
  for (const char* illum : {"2", "3", "4", "11", "12"}) {
    CAPTURE(illum);
    check_against_reference(small_scene("default_scene", {std::string("material.glass.illum=") + illum}), 8);
  }
}

TEST_CASE("default scene by the constant reflectance of before") {
  check_against_reference(small_scene("default_scene", {"render.reflectance=0.1"}), 8);
}

TEST_CASE("default scene without light, without textures, with a directional light") {
  check_against_reference(small_scene("default_scene", {"render.lights=false"}), 8);
  check_against_reference(small_scene("default_scene", {"render.textures=false"}), 8);
  // The far lawn is lit too, where a rounding of a ray's direction moves it over many texels: none, then.
  check_against_reference(small_scene("default_scene", {"render.textures=false", "light.lamp={type='directional', "
                                                        "direction=[1,-2,0.5], irradiance=[2,1,3]}"}), 8);
}

TEST_CASE("default scene seen from inside of the ball") {
  check_against_reference(small_scene("default_scene", {"camera.eye=[0.1, 0.55, 0.05]", "camera.look_at=[-0.3, 0.2, 1]"}), 8);
}

TEST_CASE("a mesh of glass with smooth normals over a textured mesh") {
  Scene scene = small_scene("default_scene");
  std::erase_if(scene.shapes, [](const Shape& s) { return s.name != "cardboard"; });
  const auto material = [&](const char* name) {
    const auto found = std::find_if(scene.materials.begin(), scene.materials.end(),
                                    [&](const Material& m) { return m.name == name; });
    return static_cast<uint32_t>(found - scene.materials.begin());
  };
  add(scene, tessellated_sphere({0, 0.5f, 0}, 0.3f, 8, 12, material("glass")));
  add(scene, textured_floor(1.5f, 0.6f, material("green")));
  check_against_reference(scene, 16);
}

TEST_CASE("a very coarse mesh of glass, whose shading normals go astray") {
  Scene scene = small_scene("default_scene");
  std::erase_if(scene.shapes, [](const Shape& s) { return s.name == "ball"; });
  add(scene, tessellated_sphere({0.6f, 0.5f, 0.6f}, 0.5f, 4, 5, add(scene, glass(1.5, {0.5, 0.1, 2}))));
  check_against_reference(scene, 16);
}

TEST_CASE("a very coarse mesh of mirror, whose shading normals go astray") {
  Scene scene = small_scene("default_scene");
  Material mirror;
  mirror.surface = Surface::mirror;
  add(scene, tessellated_sphere({0.6f, 0.5f, 0.6f}, 0.5f, 4, 5, add(scene, mirror)));
  check_against_reference(scene, 16);
}

TEST_CASE("meshes that scatter, whose shading normals see a lamp behind the facet or turn away from the eye") {
  Scene scene = small_scene("default_scene", {"light.lamp.position=[1.5, 0.6, -0.6]"});
  std::erase_if(scene.shapes, [](const Shape& s) { return s.name == "ball"; });
  Material chalk;
  chalk.diffuse = Spectrum(0.8);
  const uint32_t material = add(scene, chalk);
  add(scene, tessellated_sphere({0.6f, 0.5f, 0.6f}, 0.5f, 4, 5, material));
  // No other side of it casts the shadow.
  Mesh sheet;
  sheet.positions = {{-1.2f, 0.3f, 0}, {-0.5f, 0.3f, 0}, {-0.85f, 0.9f, 0}};
  sheet.normals = {glm::normalize(glm::vec3(1, 0, 0.2f))};
  sheet.triangles = {{0, 1, 2}};
  sheet.normal_indices = {{0, 0, 0}};
  sheet.materials = {material};
  add(scene, sheet);
  check_against_reference(scene, 32);
}

TEST_CASE("textures on a sphere, and on a mesh without coordinates") {
  Scene scene = small_scene("default_scene");
  const uint32_t lawn = shape(scene, "lawn").material;
  scene.materials[lawn].diffuse = {0.2, 0.5, 0.7};
  add(scene, Sphere{{0.6, 0.4, 0.4}, 0.3}, lawn);
  add(scene, tessellated_sphere({0.5f, 0.3f, 0.9f}, 0.3f, 6, 8, lawn));
  check_against_reference(scene, 16);
}

TEST_CASE("media that overlap, by their priorities") {
  Scene scene = small_scene("default_scene");
  // A bubble of a lighter liquid that bites into the ball, one of air inside of it, and one of equal priority.
  add(scene, Sphere{{0.25, 0.5, 0.1}, 0.2}, add(scene, glass(1.33, {0.5, 0.1, 2}, -1)));
  add(scene, Sphere{{-0.1, 0.55, 0.1}, 0.1}, add(scene, glass(1.0, Spectrum(0.0), 1)));
  add(scene, Sphere{{0.05, 0.3, 0.2}, 0.15}, add(scene, glass(1.8, {0, 1, 1}, 0)));
  check_against_reference(scene, 8);
}

TEST_CASE("media that overlap have no border where one fills both sides, by the constant reflectance too") {
  Scene scene = small_scene("default_scene", {"render.reflectance=0.1"});
  add(scene, Sphere{{0.25, 0.5, 0.1}, 0.2}, add(scene, glass(1.33, {0.5, 0.1, 2}, -1)));
  check_against_reference(scene, 8);
}

TEST_CASE("eye, lamp, mirror and cardboard in water without a ground that absorbs blue alone") {
  Scene scene = small_scene("default_scene");
  std::erase_if(scene.shapes, [](const Shape& s) { return s.name != "cardboard"; });
  Material mirror;
  mirror.surface = Surface::mirror;
  add(scene, Sphere{{0, 0.5, 0}, 0.3}, add(scene, mirror));
  add(scene, Plane{{0, 3, 0}, {0, 1, 0}, {}, {}}, add(scene, glass(1.33, {0, 0, 0.7})));
  check_against_reference(scene, 8);
}

TEST_CASE("a mesh that is a light shows its front alone") {
  Scene scene = small_scene("default_scene", {"render.lights=false"});
  Material lamp;
  lamp.emission = {1, 2, 3};
  lamp.emission_is_light = true;
  Mesh panels;  // the first faces the eye, the second turns its back on it
  panels.positions = {{0.5f, 0.2f, 1}, {1, 0.2f, 0.5f}, {0.5f, 1, 1}, {1, 1, 0.5f}};
  panels.triangles = {{0, 1, 2}, {1, 2, 3}};
  panels.materials.assign(2, add(scene, lamp));
  add(scene, panels);
  check_against_reference(scene, 8);
}

TEST_CASE("open sheets of glass seen from behind are left though they were never entered") {
  Scene scene = small_scene("default_scene", {"render.lights=false", "background.radiance=[0, 0, 0]",
                                              "camera.eye=[0, -1, 0]", "camera.look_at=[1, 0, 0]"});
  scene.shapes.clear();
  const uint32_t sheet = add(scene, glass(1.5));
  // Side by side, since what has been inside of a sheet does not know where it ends.
  for (const double z : {-9.0, 0.1}) add(scene, Triangle{{-9, 0, z}, {0, 0, z + 8.9}, {9, 0, z}, {}, {}, {}}, sheet);
  Material sky;
  sky.surface = Surface::unlit;
  sky.emission = {1, 2, 3};
  add(scene, Plane{{0, 3, 0}, {0, -1, 0}, {}, {}}, add(scene, sky));
  check_against_reference(scene, 16);
}

TEST_CASE("the eye where two media overlap") {
  Scene scene = small_scene("default_scene", {"camera.eye=[0.1, 0.55, 0.05]", "camera.look_at=[-0.3, 0.2, 1]"});
  add(scene, Sphere{{0.15, 0.5, 0.1}, 0.3}, add(scene, glass(1.33, {0.5, 0.1, 2}, 1)));
  check_against_reference(scene, 8);
}

}  // namespace vitrum
