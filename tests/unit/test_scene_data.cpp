// What lies in the scene's buffers.
#include <doctest/doctest.h>

#include <vector>

#include "device/scene_data.hpp"
#include "verify/scenes.hpp"

using namespace vitrum;

TEST_CASE("the alias table of a mesh light chooses each face by its area times its radiance") {
  Scene scene;
  for (const double radiance : {1.0, 5.0}) {
    Material lamp = surface(Surface::opaque, 0.0, radiance);
    lamp.emission_is_light = true;
    scene.materials.push_back(lamp);
  }
  Mesh mesh;
  std::vector<double> weights;
  double total = 0;
  for (uint32_t i = 0; i < 7; ++i) {
    const float size = 0.5f + 0.3f * static_cast<float>(i);
    for (const glm::vec3& corner : {glm::vec3(0), glm::vec3(size, 0, 0), glm::vec3(0, 0, size)})
      mesh.positions.push_back(corner + glm::vec3(0, static_cast<float>(i), 0));
    mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    mesh.materials.push_back(i % 2);
    weights.push_back(static_cast<double>(size) * static_cast<double>(size) * (i % 2 == 0 ? 1.0 : 5.0));
    total += weights.back();
  }
  add(scene, mesh);
  scene.lights.push_back({"lamp", {}, MeshLight{0}});
  const std::vector<kernel::LightFace> faces = scene_data(scene, scene_features(scene)).faces;
  REQUIRE(faces.size() == weights.size());
  const double slot = 1.0 / static_cast<double>(faces.size());
  std::vector<double> chosen(faces.size(), 0.0);
  for (size_t i = 0; i < faces.size(); ++i) {
    chosen[i] += slot * static_cast<double>(faces[i].probability);
    chosen[faces[i].alias] += slot * (1.0 - static_cast<double>(faces[i].probability));
  }
  for (size_t i = 0; i < faces.size(); ++i) {
    CAPTURE(i);
    CHECK(std::abs(chosen[i] - weights[i] / total) < 1e-6);
    CHECK(std::abs(static_cast<double>(faces[i].selection) - weights[i] / total) < 1e-6);
  }
}
