// The models that come with vitrum: all of them load, and the glass of cornell_glass is what its scene file says.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>
#include <string>
#include <utility>

#include "scene/media.hpp"
#include "scene/scene_file.hpp"
#include "scene/textures.hpp"
#include "scratch.hpp"

using namespace vitrum;
using glm::dvec3;

namespace {

namespace fs = std::filesystem;

const Scene& cornell_glass() {
  static const Scene scene = load_scene(VITRUM_SOURCE_DIR "/models/cornell_glass/scene.toml");
  return scene;
}

const Mesh& mesh(const std::string& name) {
  const auto& shapes = cornell_glass().shapes;
  const auto found = std::find_if(shapes.begin(), shapes.end(), [&](const Shape& shape) { return shape.name == name; });
  REQUIRE(found != shapes.end());
  return std::get<Mesh>(found->geometry);
}

dvec3 corner(const Mesh& mesh, size_t face, int which) {
  return mesh.positions[mesh.triangles[face][which]];
}

/// Along the front; its length is twice the area.
dvec3 area_normal(const Mesh& mesh, size_t face) {
  const dvec3 a = corner(mesh, face, 0);
  return glm::cross(corner(mesh, face, 1) - a, corner(mesh, face, 2) - a);
}

/// Divergence theorem; positive where the fronts look outwards.
double signed_volume(const Mesh& mesh) {
  double volume = 0.0;
  for (size_t face = 0; face < mesh.triangles.size(); ++face)
    volume += glm::dot(corner(mesh, face, 0), area_normal(mesh, face)) / 6.0;
  return volume;
}

/// How many of the mesh's directed edges have no single partner that runs the other way.
size_t open_edges(const Mesh& mesh) {
  std::multiset<std::pair<uint32_t, uint32_t>> edges;
  for (const glm::uvec3& t : mesh.triangles)
    for (const auto& edge : {std::pair(t.x, t.y), std::pair(t.y, t.z), std::pair(t.z, t.x)}) edges.insert(edge);
  return static_cast<size_t>(std::count_if(edges.begin(), edges.end(), [&](const auto& edge) {
    return edges.count(edge) != 1 || edges.count({edge.second, edge.first}) != 1;
  }));
}

/// Cosine of the largest angle between a face and the normals at its corners; -1 where a face has none.
double least_smooth(const Mesh& mesh) {
  if (mesh.normal_indices.empty()) return -1.0;
  double least = 1.0;
  for (size_t face = 0; face < mesh.triangles.size(); ++face) {
    if (mesh.normal_indices[face].x == none) return -1.0;
    const dvec3 normal = glm::normalize(area_normal(mesh, face));
    for (int i = 0; i < 3; ++i)
      least = std::min(least, glm::dot(normal, dvec3(mesh.normals[mesh.normal_indices[face][i]])));
  }
  return least;
}

double lowest(const Mesh& mesh, int axis) {
  const auto less = [&](const glm::vec3& a, const glm::vec3& b) { return a[axis] < b[axis]; };
  return (*std::min_element(mesh.positions.begin(), mesh.positions.end(), less))[axis];
}

/// Names of the media at a point of cornell_glass, as in "tumbler liquid".
std::string media_names(const dvec3& point) {
  std::string names;
  for (uint32_t material : media_at(cornell_glass(), point))
    names += (names.empty() ? "" : " ") + cornell_glass().materials[material].name;
  return names;
}

}  // namespace

TEST_CASE("every model loads without a warning") {
  int models = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(VITRUM_SOURCE_DIR "/models")) {
    if (!entry.is_directory()) continue;
    const std::string path = (entry.path() / "scene.toml").string();
    CAPTURE(path);
    CapturedWarnings warnings;
    Scene scene;
    CHECK_NOTHROW(scene = load_scene(path));
    CHECK_NOTHROW(load_textures(scene));
    CHECK(warnings.text() == "");
    CHECK(!scene.shapes.empty());
    CHECK(!scene.lights.empty());
    ++models;
  }
  CHECK(models >= 3);
}

TEST_CASE("cornell_glass: the glass is closed, smooth and turned outwards") {
  CHECK(mesh("knot").triangles.size() > 100'000);
  for (const char* name : {"knot", "tumbler", "liquid"}) {
    CAPTURE(name);
    CHECK(open_edges(mesh(name)) == 0);
    CHECK(signed_volume(mesh(name)) > 0.0);
    CHECK(least_smooth(mesh(name)) > 0.99);
  }
}

TEST_CASE("cornell_glass: the knot has a tube's volume and stands free") {
  // Pappus: a tube about a closed curve holds its cross-section times the curve's length; here an 80-gon's.
  const double major = 0.18, minor = 0.084, tube = 0.05, turn = 2.0 * std::numbers::pi;
  double length = 0.0;
  for (int i = 0, steps = 3600; i < steps; ++i) {
    const double t = turn * i / steps;
    length += std::hypot(3.0 * minor, 2.0 * (major + minor * std::cos(3.0 * t))) * turn / steps;
  }
  const double cross_section = 40.0 * std::sin(turn / 80.0) * tube * tube;
  CHECK(signed_volume(mesh("knot")) / (cross_section * length) == doctest::Approx(1.0).epsilon(2e-4));

  CHECK(lowest(mesh("knot"), 1) == 0.0);   // on the floor
  CHECK(lowest(mesh("knot"), 2) == -0.5);  // at the back wall
  const Shape& ball = cornell_glass().shapes.front();
  REQUIRE(ball.name == "ball");
  const Sphere& sphere = std::get<Sphere>(ball.geometry);
  double to_ball = 1.0, to_tumbler = 1.0, to_side = 1.0;
  for (const glm::vec3& p : mesh("knot").positions) {
    to_ball = std::min(to_ball, glm::distance(dvec3(p), sphere.centre) - sphere.radius);
    to_tumbler = std::min(to_tumbler, std::hypot(p.x - 0.05, p.z - 0.2) - 0.097);
    to_side = std::min(to_side, 0.5 - std::abs(double(p.x)));
  }
  CHECK(to_ball > 0.0);
  CHECK(to_tumbler > 0.0);
  CHECK(to_side > 0.0);
}

TEST_CASE("cornell_glass: media") {
  const dvec3 axis(0.05, 0.0, 0.2);  // of the tumbler
  const auto at = [&](double r, double y) { return media_names(axis + dvec3(r * std::cos(2.0), y, r * std::sin(2.0))); };
  CHECK(at(0.0, 0.1) == "liquid");
  CHECK(at(0.0, 0.01) == "tumbler");
  CHECK(at(0.0, 0.0255) == "tumbler liquid");
  CHECK(at(0.0, 0.1845) == "liquid");
  CHECK(at(0.0, 0.1855) == "");
  CHECK(at(0.0, 0.26) == "");

  // From the axis outwards: the liquid, a thin overlap, the wall, air; never air between liquid and glass.
  for (const double y : {0.05, 0.1, 0.15, 0.18}) {
    CAPTURE(y);
    const double outer = 0.075 + 0.022 / 0.27 * y, inner = outer - 0.007 * std::hypot(1.0, 0.022 / 0.27);
    CHECK(at(inner - 0.0002, y) == "liquid");
    CHECK(at(inner + 0.0003, y) == "tumbler liquid");
    CHECK(at(inner + 0.0012, y) == "tumbler liquid");
    CHECK(at(inner + 0.0020, y) == "tumbler");
    CHECK(at(outer - 0.0003, y) == "tumbler");
    CHECK(at(outer + 0.0003, y) == "");
  }

  const Mesh& knot = mesh("knot");
  for (size_t face = 0; face < knot.triangles.size(); face += 20'011) {
    const dvec3 outwards = glm::normalize(area_normal(knot, face)), on = corner(knot, face, 0);
    CHECK(media_names(on - 0.001 * outwards) == "crystal");
    CHECK(media_names(on - 0.05 * outwards) == "crystal");  // the middle of the tube
    CHECK(media_names(on + 0.001 * outwards) == "");
  }
  CHECK(media_names(cornell_glass().camera.eye) == "");
}

TEST_CASE("cornell_glass: one light, and nothing of it shines up") {
  const Scene& scene = cornell_glass();
  REQUIRE(scene.lights.size() == 1);
  CHECK(scene.lights.front().name == "lamp");
  CHECK(scene.shapes.at(std::get<MeshLight>(scene.lights.front().emitter).shape).name == "lamp");
  const Mesh& lamp = mesh("lamp");
  double down = 0.0, sideways = 0.0;  // area times radiance
  for (size_t face = 0; face < lamp.triangles.size(); ++face) {
    const Material& material = scene.materials[lamp.materials[face]];
    CHECK(material.emission_is_light);
    const dvec3 normal = area_normal(lamp, face);
    CHECK(normal.y <= 0.0);
    (normal.y < 0.0 ? down : sideways) += material.emission.g * glm::length(normal) / 2.0;
  }
  CHECK(down == doctest::Approx(36.0 * 0.32 * 0.32));
  CHECK(sideways < 0.1 * down);
}

TEST_CASE("cornell_glass: the room looks inwards and wears its textures") {
  const Scene& scene = cornell_glass();
  const Mesh& room = mesh("room");
  CHECK(room.triangles.size() == 10);
  for (size_t face = 0; face < room.triangles.size(); ++face)
    CHECK(glm::dot(area_normal(room, face), dvec3(0.0, 0.5, 0.0) - corner(room, face, 0)) > 0.0);
  std::set<std::string> textured;
  for (const Material& material : scene.materials) {
    if (material.diffuse_texture == none) continue;
    const Texture& texture = scene.textures.at(material.diffuse_texture);
    CHECK(!material.texture_replaces_diffuse);
    CHECK(texture.colour_space == ColourSpace::srgb);
    textured.insert(material.name + ' ' + fs::path(texture.path).filename().string());
  }
  CHECK(textured == std::set<std::string>{"back_wall tiles.png", "floor wood.png", "left_wall tiles.png",
                                          "right_wall tiles.png"});
  // Glass stands in the plane of the floor; the liquid does not reach it.
  CHECK(lowest(mesh("tumbler"), 1) == 0.0);
  CHECK(lowest(room, 1) == 0.0);
  CHECK(lowest(mesh("liquid"), 1) > 0.02);
}
