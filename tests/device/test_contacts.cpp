// Surfaces in contact, within rounding at one place: device against reference, which crosses them as one event.

#include <doctest/doctest.h>

#include <cmath>

#include "device/opencl.hpp"
#include "reference/renderer.hpp"
#include "render/render.hpp"
#include "unit/reference_scenes.hpp"

using namespace vitrum;

namespace {

/// Looks down at a slant on what stands on the plane y = 0, which shows a radiance of its own.
Scene on_a_table() {
  Scene scene;
  scene.camera = {CameraType::pinhole, {0.7, 1.9, 1.3}, {0.03, 0.05, 0.02}, {0, 1, 0}, 30.0};
  scene.film.width = scene.film.height = 48;
  scene.background = Spectrum(0.3, 0.5, 0.8);
  scene.render.samples = 1;
  scene.render.caustics = false;
  scene.render.min_weight = 1e-6;
  scene.render.max_depth = 12;
  scene.materials.push_back(surface(Surface::opaque, 0.0, 2.0));
  add(scene, Plane{{0, 0, 0}, {0, 1, 0}, {}, {}}, 0);
  return scene;
}

uint32_t add_glass(Scene& scene, double index, double sigma_a, int priority = 0) {
  scene.materials.push_back(glass(index, sigma_a, priority));
  return static_cast<uint32_t>(scene.materials.size() - 1);
}

/// Pixels that differ by more than 1e-4 relative and do not lie at an edge.
int differing_pixels(const Scene& scene, int* at_edges) {
  Device device;
  RenderOptions options;
  const RenderResult result = render(scene, device, options);
  const std::vector<double> picture = result.film.mean("radiance");
  const reference::Renderer renderer(scene);
  int differing = 0;
  *at_edges = 0;
  for (int y = 0; y < scene.film.height; ++y)
    for (int x = 0; x < scene.film.width; ++x) {
      const glm::dvec2 position(x + 0.5, y + 0.5);
      const reference::Sample truth = renderer.at(position);
      double worst = 0.0;
      for (int c = 0; c < 3; ++c)
        worst = std::max(worst, std::abs(picture[static_cast<size_t>(3 * (y * scene.film.width + x) + c)] / truth.radiance[c] - 1.0));
      if (worst <= 1e-4) continue;
      if (renderer.edges_within(position, 1e-4).any())
        ++*at_edges;
      else
        ++differing;
    }
  return differing;
}

}  // namespace

TEST_CASE("glass whose foot lies in the table's plane lets the table be seen, not what is under it") {
  Scene scene = on_a_table();
  add(scene, box({-0.3f, 0.0f, -0.2f}, {0.3f, 0.31f, 0.2f}, add_glass(scene, 1.5, 2.0)));
  REQUIRE(scene_features(scene).contacts);
  int at_edges = 0;
  CHECK(differing_pixels(scene, &at_edges) == 0);
  CHECK(at_edges < 60);
}

TEST_CASE("two glasses that touch face to face meet in one border, in whatever order they are listed") {
  for (bool swapped : {false, true}) {
    Scene scene = on_a_table();
    const uint32_t low = add_glass(scene, 1.33, 3.0), high = add_glass(scene, 1.6, 0.5);
    const Mesh below = box({-0.3f, 0.1f, -0.2f}, {0.3f, 0.2f, 0.2f}, low);
    const Mesh above = box({-0.3f, 0.2f, -0.2f}, {0.3f, 0.35f, 0.2f}, high);
    add(scene, swapped ? above : below);
    add(scene, swapped ? below : above);
    REQUIRE(scene_features(scene).contacts);
    int at_edges = 0;
    CHECK(differing_pixels(scene, &at_edges) == 0);
    CHECK(at_edges < 60);
  }
}

TEST_CASE("bodies of one mesh are told apart by their materials, as if each were a mesh") {
  Scene apart = on_a_table();
  const uint32_t low = add_glass(apart, 1.33, 3.0), high = add_glass(apart, 1.6, 0.5);
  Scene together = apart;
  const Mesh below = box({-0.3f, 0.1f, -0.2f}, {0.3f, 0.2f, 0.2f}, low);
  const Mesh above = box({-0.3f, 0.2f, -0.2f}, {0.3f, 0.35f, 0.2f}, high);
  add(apart, below);
  add(apart, above);
  Mesh both = below;
  both.positions.insert(both.positions.end(), above.positions.begin(), above.positions.end());
  for (const glm::uvec3& t : above.triangles) both.triangles.push_back(t + static_cast<uint32_t>(below.positions.size()));
  both.materials.insert(both.materials.end(), above.materials.begin(), above.materials.end());
  add(together, both);
  REQUIRE(scene_features(together).contacts);
  REQUIRE(scene_features(together).media_stack);
  Device device;
  const std::vector<double> expected = render(apart, device, {}).film.mean("radiance");
  CHECK(render(together, device, {}).film.mean("radiance") == expected);
}

TEST_CASE("a liquid that fills its glass up to the very wall, standing on the table") {
  Scene scene = on_a_table();
  const uint32_t liquid = add_glass(scene, 1.33, 4.0, 1), wall = add_glass(scene, 1.5, 0.2, 2);
  // Walls of four boxes around the liquid and a bottom under it, all coincident where they touch.
  add(scene, box({-0.2f, 0.05f, -0.2f}, {0.2f, 0.3f, 0.2f}, liquid));
  add(scene, box({-0.25f, 0.0f, -0.25f}, {0.25f, 0.05f, 0.25f}, wall));
  add(scene, box({-0.25f, 0.05f, -0.25f}, {-0.2f, 0.35f, 0.25f}, wall));
  add(scene, box({0.2f, 0.05f, -0.25f}, {0.25f, 0.35f, 0.25f}, wall));
  int at_edges = 0;
  CHECK(differing_pixels(scene, &at_edges) == 0);
  CHECK(at_edges < 100);
}
