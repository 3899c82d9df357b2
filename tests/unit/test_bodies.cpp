// Bodies of a mesh, and whether they are closed.
#include <doctest/doctest.h>

#include "scene/bodies.hpp"
#include "verify/scenes.hpp"

using namespace vitrum;

TEST_CASE("a mesh has a body for each material, closed or not") {
  Mesh mesh = box({0, 0, 0}, {1, 2, 3}, 5);
  REQUIRE(bodies_of(mesh).size() == 1);
  CHECK(bodies_of(mesh)[0].material == 5);
  CHECK(bodies_of(mesh)[0].closed);
  CHECK(bodies_of(mesh_ball({1, 2, 3}, 0.5, 8, 16, true, 0))[0].closed);

  SUBCASE("corners of the same place are one, 0 and -0 too") {
    for (glm::uvec3& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) {
        const glm::vec3 p = mesh.positions[t[k]];
        t[k] = static_cast<uint32_t>(mesh.positions.size());
        mesh.positions.push_back(mesh.positions.size() % 2 ? p : glm::vec3(p.x == 0 ? -0.0f : p.x, p.y, p.z));
      }
    CHECK(bodies_of(mesh)[0].closed);
  }
  SUBCASE("a missing face") {
    mesh.triangles.pop_back();
    mesh.materials.pop_back();
    CHECK(!bodies_of(mesh)[0].closed);
  }
  SUBCASE("a face the other way round") {
    std::swap(mesh.triangles[3].x, mesh.triangles[3].y);
    CHECK(!bodies_of(mesh)[0].closed);
  }
  SUBCASE("two materials: a box inside, and a box of which one face is another material's") {
    const Mesh inner = box({0.2f, 0.2f, 0.2f}, {0.4f, 0.4f, 0.4f}, 7);
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), inner.positions.begin(), inner.positions.end());
    for (const glm::uvec3& t : inner.triangles) mesh.triangles.push_back(t + first);
    mesh.materials.insert(mesh.materials.end(), inner.materials.begin(), inner.materials.end());
    REQUIRE(bodies_of(mesh).size() == 2);
    CHECK(bodies_of(mesh)[0].closed);
    CHECK(bodies_of(mesh)[1].material == 7);
    CHECK(bodies_of(mesh)[1].closed);
    mesh.materials[4] = 7;
    CHECK(!bodies_of(mesh)[0].closed);
    CHECK(!bodies_of(mesh)[1].closed);
  }
}
