// Which photons a pass shoots.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "verify/photon_run.hpp"
#include "verify/scenes.hpp"

using namespace vitrum;

namespace {

using Places = std::vector<std::array<float, 3>>;

Places sorted_places(const std::vector<cl_float8>& photons) {
  Places places;
  for (const cl_float8& p : photons) places.push_back({p.s[0], p.s[1], p.s[2]});
  std::sort(places.begin(), places.end());
  return places;
}

}  // namespace

TEST_CASE("the passes of a replicate shoot the photons of one sequence, whatever launches and passes hold") {
  Scene scene;
  scene.camera = {CameraType::pinhole, {0, 3, 8}, {0, 0, 0}, {0, 1, 0}, 45.0};
  scene.materials = {glass(1.5), surface(Surface::opaque, 0.5)};
  add(scene, Sphere{{0, 0, 0}, 1.0}, 0);
  add(scene, Plane{{0, -2, 0}, {0, 1, 0}, {}, {}}, 1);
  scene.lights.push_back({"lamp", {}, PointLight{{0, 4, 0}, Spectrum(1.0)}});
  scene.photons.estimate = PhotonEstimate::fixed_radius;
  scene.photons.radius = 0.05;
  Device device;
  PhotonRun run(scene, device, 100'000);
  const Places whole = sorted_places(run.shoot(0, 100'000));  // more than a launch
  std::vector<cl_float8> parts = run.shoot(0, 30'000);
  const std::vector<cl_float8> rest = run.shoot(0, 70'000, 30'000);
  parts.insert(parts.end(), rest.begin(), rest.end());
  const bool same = sorted_places(parts) == whole;
  CHECK(same);
  CHECK(std::adjacent_find(whole.begin(), whole.end()) == whole.end());

  Places both = whole;
  const Places other = sorted_places(run.shoot(1, 100'000));
  both.insert(both.end(), other.begin(), other.end());
  std::sort(both.begin(), both.end());
  CHECK(std::adjacent_find(both.begin(), both.end()) == both.end());
}
