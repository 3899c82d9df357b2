// Photons that wait for a packet of their own must not overrun their queue: it lost their power once, with 16 lanes first
// of all in this very scene.
#include <doctest/doctest.h>

#include <cmath>

#include "verify/photon_run.hpp"
#include "verify/scenes.hpp"

using namespace vitrum;

TEST_CASE("the balance of power holds where photons often change between inside and outside") {
  Scene scene;
  scene.camera = {CameraType::pinhole, {0, 3, 8}, {0, 0, 0}, {0, 1, 0}, 45.0};
  scene.materials = {glass(2.4), surface(Surface::opaque, 0.5)};
  add(scene, Sphere{{0, 0, 0}, 1.0}, 0);
  add(scene, Plane{{0, -2, 0}, {0, 1, 0}, {}, {}}, 1);
  scene.lights.push_back({"sun", {}, DirectionalLight{{0, -1, 0}, Spectrum(1.0)}});
  scene.photons.estimate = PhotonEstimate::fixed_radius;
  scene.photons.radius = 0.05;
  scene.photons.max_depth = 31;
  scene.render.seed = 7;
  Device device;
  PhotonRun run(scene, device, 500'000);
  run.shoot(0, 500'000);
  const PhotonBalance& b = run.balance();
  for (int c = 0; c < 3; ++c) CHECK(std::abs((b.stored[c] + b.direct[c] + b.lost[c] + b.cut[c]) / b.shot[c] - 1) < 1e-6);
}
