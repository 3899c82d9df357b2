// Photons with footprints against the quadrature of the ball's caustic, and against light that is even.

#include <doctest/doctest.h>

#include <cmath>

#include "truth/caustics.hpp"
#include "verify/caustic_plate.hpp"
#include "verify/photon_run.hpp"

namespace vitrum {
namespace {

/// Power within `half_width` of the axis, by a picture over the truth.
double flux_ratio(const CausticPlate& plate, const RenderResult& result) {
  const auto mask = reference::disc_mask(CausticPlate::half_width, CausticPlate::size, CausticPlate::size, CausticPlate::half_width);
  const std::vector<double> found = CausticPlate::irradiance(result);
  double sum = 0, truth = 0;
  for (size_t i = 0; i < found.size(); ++i) {
    sum += mask[i] * found[i];
    truth += mask[i] * plate.truth()[i];
  }
  return sum / truth;
}

/// The sun straight down through a slab of glass, over a plane.
Scene sun_through_slab() {
  Scene scene;
  scene.camera = {CameraType::pinhole, {0, 0.4, 0}, {0, 0, 0}, {0, 0, 1}, 50};
  scene.film.width = scene.film.height = 48;
  scene.materials = {glass(1.5), surface(Surface::opaque, 0.5)};
  add(scene, box({-1, 0.5f, -1}, {1, 0.7f, 1}, 0));
  add(scene, Plane{{0, 0, 0}, {0, 1, 0}, {}, {}}, 1);
  scene.lights.push_back({"sun", {}, DirectionalLight{{0, -1, 0}, Spectrum(1.0)}});
  return scene;
}

}  // namespace

TEST_CASE("footprints: 16,384 photons tell the caustic of a ball, exact and as a mesh, where as many with a radius do not") {
  Device device;
  for (const bool mesh : {false, true}) {
    CAPTURE(mesh);
    const CausticPlate plate = mesh ? CausticPlate(90) : CausticPlate();
    const RenderResult with = caustics_of(plate.scene, 16384, 64, PhotonEstimate::footprints, device);
    Scene sharp = plate.scene;
    sharp.photons.nearest = 5;  // what serves a radius best
    const RenderResult without = caustics_of(sharp, 16384, 64, PhotonEstimate::automatic_radius, device);
    MESSAGE("errors " << plate.error(with) << " and " << plate.error(without) << ", flux " << flux_ratio(plate, with));
    CHECK(plate.error(with) < 0.09);
    CHECK(plate.error(with) < 0.4 * plate.error(without));
    CHECK(std::abs(flux_ratio(plate, with) - 1) < 0.01);
  }
}

TEST_CASE("footprints: their parts carry the power that was stored") {
  Device device;
  Scene scene = CausticPlate().scene;
  scene.photons.estimate = PhotonEstimate::footprints;
  PhotonRun run(scene, device);
  double power = 0;
  for (const cl_float8& photon : run.shoot(0, 20000)) power += static_cast<double>(photon.s[PHOTON_POWER]);
  CHECK(std::abs(power / run.balance().stored.x - 1) < 1e-5);
}

TEST_CASE("footprints: even light stays even") {
  Device device;
  // Straight through, and by two reflections inside, which some photons take by chance.
  const double R = 0.04, through = (1 - R) * (1 - R) / (1 - R * R);
  // The picture shows a fiftieth of what the sun shines on.
  for (const auto& [photons, most] : {std::pair{4096u, 0.08}, std::pair{65536u, 0.035}}) {
    CAPTURE(photons);
    const std::vector<double> radiance =
        caustics_of(sun_through_slab(), photons, 16, PhotonEstimate::footprints, device).film.mean("caustics");
    double mean = 0, squares = 0;
    const double pixels = static_cast<double>(radiance.size() / 3);
    for (size_t i = 0; i < radiance.size(); i += 3) {
      const double relative = radiance[i] * std::numbers::pi / 0.5 / through;
      mean += relative / pixels;
      squares += (relative - 1) * (relative - 1) / pixels;
    }
    MESSAGE("mean " << mean << ", off by " << std::sqrt(squares));
    CHECK(std::abs(mean - 1) < 0.005);
    CHECK(std::sqrt(squares) < most);
  }
}

}  // namespace vitrum
