// Which media contain a point.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>

#include "scene/media.hpp"

using namespace vitrum;
using glm::dvec3;

namespace {

using Indices = std::vector<uint32_t>;

uint32_t add_material(Scene& scene, Surface surface, int priority = 0) {
  Material material;
  material.surface = surface;
  material.priority = priority;
  scene.materials.push_back(material);
  return static_cast<uint32_t>(scene.materials.size() - 1);
}

void add_face(Mesh& mesh, uint32_t material, const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d) {
  const auto first = static_cast<uint32_t>(mesh.positions.size());
  for (const dvec3& p : {a, b, c, d}) mesh.positions.push_back(p);
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
  mesh.materials.insert(mesh.materials.end(), 2, material);
}

/// Faces of a box whose fronts look outwards; those of axis directions in `left_out` (0 -x, 1 +x, 2 -y, ...) are missing.
void add_box(Mesh& mesh, uint32_t material, const dvec3& low, const dvec3& high, const std::vector<int>& left_out = {}) {
  for (int side = 0; side < 6; ++side) {
    if (std::find(left_out.begin(), left_out.end(), side) != left_out.end()) continue;
    const int axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    const bool is_high = side % 2 == 1;
    std::array<dvec3, 4> corner;
    for (int i = 0; i < 4; ++i) {
      dvec3& p = corner[static_cast<size_t>(is_high ? i : 3 - i)];
      p[axis] = is_high ? high[axis] : low[axis];
      p[u] = i == 1 || i == 2 ? high[u] : low[u];
      p[v] = i >= 2 ? high[v] : low[v];
    }
    add_face(mesh, material, corner[0], corner[1], corner[2], corner[3]);
  }
}

void add_shape(Scene& scene, uint32_t material, decltype(Shape::geometry) geometry) {
  Shape shape;
  shape.material = material;
  shape.geometry = std::move(geometry);
  scene.shapes.push_back(std::move(shape));
}

}  // namespace

TEST_CASE("exact spheres and planes") {
  Scene scene;
  const uint32_t glass = add_material(scene, Surface::dielectric), stone = add_material(scene, Surface::opaque);
  const uint32_t water = add_material(scene, Surface::dielectric);
  add_shape(scene, glass, Sphere{{0, 0, 0}, 1});
  add_shape(scene, stone, Sphere{{0, 0, 0}, 2});
  add_shape(scene, water, Plane{.point = {0, 0.5, 0}, .normal = {0, 1, 0}, .texture_u = {}, .texture_v = {}});
  CHECK(media_at(scene, {0, 0, 0}) == Indices{glass, water});
  CHECK(media_at(scene, {0, 0.75, 0}) == Indices{glass});
  CHECK(media_at(scene, {0, -1.5, 0}) == Indices{water});
  CHECK(media_at(scene, {0, 1.5, 0}).empty());
}

TEST_CASE("a closed cube of glass") {
  Scene scene;
  const uint32_t glass = add_material(scene, Surface::dielectric);
  Mesh cube;
  add_box(cube, glass, {-1, -1, -1}, {1, 1, 1});
  add_shape(scene, none, cube);
  for (const dvec3& inside : {dvec3(0), dvec3(0.99), dvec3(-0.999, 0.999, 0), dvec3(0.3, -0.2, 0.1)})
    CHECK(media_at(scene, inside) == Indices{glass});
  for (const dvec3& outside : {dvec3(1.01, 0, 0), dvec3(0, -1.001, 0), dvec3(5, 5, 5), dvec3(0, 100, 0), dvec3(1.1, 0.9, 0.9)})
    CHECK(media_at(scene, outside).empty());
}

TEST_CASE("a hollow cube: its walls are glass, its inside is not") {
  Scene scene;
  const uint32_t glass = add_material(scene, Surface::dielectric);
  Mesh cube;
  add_box(cube, glass, {-2, -2, -2}, {2, 2, 2});
  // Corners exchanged: the inner box's fronts look into the cavity.
  Mesh cavity;
  add_box(cavity, glass, {-1, -1, -1}, {1, 1, 1});
  const auto first = static_cast<uint32_t>(cube.positions.size());
  cube.positions.insert(cube.positions.end(), cavity.positions.begin(), cavity.positions.end());
  for (const glm::uvec3& t : cavity.triangles) cube.triangles.push_back(glm::uvec3(t.x, t.z, t.y) + first);
  cube.materials.insert(cube.materials.end(), cavity.materials.begin(), cavity.materials.end());
  add_shape(scene, none, cube);
  CHECK(media_at(scene, {0, 0, 0}).empty());
  CHECK(media_at(scene, {0.9, 0.9, -0.9}).empty());
  CHECK(media_at(scene, {1.5, 0, 0}) == Indices{glass});
  CHECK(media_at(scene, {3, 0, 0}).empty());
}

TEST_CASE("water as an open sheet in an opaque basin") {
  Scene scene;
  const uint32_t stone = add_material(scene, Surface::opaque), water = add_material(scene, Surface::dielectric);
  const int top = 3;
  Mesh basin;
  add_box(basin, stone, {0, 0, 0}, {4, 2, 4}, {top});
  // The sheet reaches a little into the walls, as sheets do.
  add_face(basin, water, {-0.1, 1, -0.1}, {-0.1, 1, 4.1}, {4.1, 1, 4.1}, {4.1, 1, -0.1});
  add_shape(scene, none, basin);
  for (const dvec3& under : {dvec3(2, 0.5, 2), dvec3(0.1, 0.05, 0.1), dvec3(3.9, 0.98, 2), dvec3(2, 0.01, 3.9)}) {
    CAPTURE(under.y);
    CHECK(media_at(scene, under) == Indices{water});
  }
  for (const dvec3& above : {dvec3(2, 1.5, 2), dvec3(2, 10, 2), dvec3(0.1, 1.02, 0.1), dvec3(2, -1, 2), dvec3(6, 0.5, 2)}) {
    CAPTURE(above.y);
    CHECK(media_at(scene, above).empty());
  }
}

TEST_CASE("glass whose bottom lies in the table's plane") {
  Scene scene;
  const uint32_t glass = add_material(scene, Surface::dielectric), table = add_material(scene, Surface::opaque);
  Mesh block;
  add_box(block, glass, {-1, 0, -1}, {1, 0.02, 1});
  add_shape(scene, none, block);
  add_shape(scene, table, Plane{.point = {0, 0, 0}, .normal = {0, 1, 0}, .texture_u = {}, .texture_v = {}});
  CHECK(media_at(scene, {0, 0.01, 0}) == Indices{glass});
  CHECK(media_at(scene, {0, 0.03, 0}).empty());
  CHECK(media_at(scene, {0, -0.01, 0}).empty());
}

TEST_CASE("a sheet of glass in the plane of an opaque floor is seen") {
  Scene scene;
  const uint32_t glass = add_material(scene, Surface::dielectric), stone = add_material(scene, Surface::opaque);
  Mesh room;
  const float floor = 0.1f;
  add_box(room, stone, {-1, floor, -1}, {1, 2, 1});
  add_face(room, glass, {-1, floor, -1}, {1, floor, -1}, {1, floor, 1}, {-1, floor, 1});  // its back looks into the room
  // Turned about x by an angle without meaning, so that the two distances round differently.
  for (glm::vec3& p : room.positions) p = {p.x, 0.8f * p.y - 0.6f * p.z, 0.6f * p.y + 0.8f * p.z};
  add_shape(scene, none, room);
  CHECK(media_at(scene, {0, 0.8, 0.6}) == Indices{glass});
}

TEST_CASE("nested shapes come by priority, then in order") {
  Scene scene;
  const uint32_t water = add_material(scene, Surface::dielectric, 1), glass = add_material(scene, Surface::dielectric, 3);
  const uint32_t ice = add_material(scene, Surface::dielectric, 3);
  Mesh tank;
  add_box(tank, water, {-5, -5, -5}, {5, 5, 5});
  add_shape(scene, none, tank);
  add_shape(scene, ice, Sphere{{0, 0, 0}, 2});
  Mesh cube;
  add_box(cube, glass, {-1, -1, -1}, {1, 1, 1});
  add_shape(scene, none, cube);
  add_shape(scene, water, Sphere{{0, 0, 0}, 0.5});
  CHECK(media_at(scene, {0, 0, 0}) == Indices{ice, glass, water, water});
  CHECK(media_at(scene, {0.9, 0, 0}) == Indices{ice, glass, water});
  CHECK(media_at(scene, {1.9, 0, 0}) == Indices{ice, water});
  CHECK(media_at(scene, {4, 0, 0}) == Indices{water});
  CHECK(media_at(scene, {6, 0, 0}).empty());
}

TEST_CASE("one mesh of two media") {
  Scene scene;
  const uint32_t glass = add_material(scene, Surface::dielectric, 1), liquid = add_material(scene, Surface::dielectric);
  Mesh mesh;
  add_box(mesh, glass, {-1, -1, -1}, {1, 1, 1});
  add_box(mesh, liquid, {0, -2, -2}, {3, 2, 2});
  add_shape(scene, none, mesh);
  CHECK(media_at(scene, {-0.5, 0, 0}) == Indices{glass});
  CHECK(media_at(scene, {0.5, 0, 0}) == Indices{glass, liquid});
  CHECK(media_at(scene, {2, 0, 0}) == Indices{liquid});
}

TEST_CASE("an opaque lid hides glass behind it") {
  Scene scene;
  const uint32_t glass = add_material(scene, Surface::dielectric), stone = add_material(scene, Surface::opaque);
  Mesh sheet;
  add_face(sheet, glass, {-50, 1, -50}, {50, 1, -50}, {50, 1, 50}, {-50, 1, 50});  // its front looks down
  add_shape(scene, none, sheet);
  CHECK(media_at(scene, {0, 2, 0}) == Indices{glass});
  add_shape(scene, stone, Sphere{{0, 2, 0}, 0.5});
  CHECK(media_at(scene, {0, 2, 0}).empty());
  scene.shapes.pop_back();
  Mesh box;
  add_box(box, stone, {-1, 1.5, -1}, {1, 2.5, 1});
  add_shape(scene, none, box);
  CHECK(media_at(scene, {0, 2, 0}).empty());
}
