// Caustics drawn as patches, in pictures: against the ball's irradiance by quadrature, and against what is gathered.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "film/statistics.hpp"
#include "render/photon_pass.hpp"
#include "truth/caustics.hpp"
#include "verify/caustic_plate.hpp"

namespace vitrum {
namespace {

/// A lamp over a ball of glass and a mirror ball, in a corner of floor and wall with a step in it.
Scene corner(const glm::dvec3& eye, const glm::dvec3& look_at) {
  Scene scene;
  scene.camera = {CameraType::pinhole, eye, look_at, {0, 1, 0}, 60};
  scene.film.width = 96;
  scene.film.height = 64;
  scene.materials = {glass(1.5), surface(Surface::mirror), surface(Surface::opaque, 0.5), surface(Surface::opaque, 0.7)};
  add(scene, Sphere{{0, 0.6, 0}, 0.3}, 0);
  add(scene, Sphere{{0.9, 0.4, 0}, 0.25}, 1);
  add(scene, Plane{{0, 0, 0}, {0, 1, 0}, {}, {}}, 2);
  add(scene, Plane{{0, 0, -1}, {0, 0, 1}, {}, {}}, 3);
  add(scene, box({-0.4f, 0.0f, -0.1f}, {0.05f, 0.1f, 0.4f}, 3), 3);
  scene.lights.push_back({"lamp", {}, PointLight{{0.2, 1.6, 0.1}, Spectrum(1.0)}});
  scene.photons.max_depth = 8;
  scene.photons.radius = 0.01;
  return scene;
}

/// Means of radiance over squares of 8 x 8 pixels.
std::vector<double> blocks(const RenderResult& result) {
  const std::vector<double> radiance = result.film.mean("caustics");
  std::vector<double> means(96 / 8 * 64 / 8, 0.0);
  for (size_t i = 0; i < radiance.size(); i += 3) means[i / 3 / 96 / 8 * 12 + i / 3 % 96 / 8] += radiance[i] / 64;
  return means;
}

/// Differences of such means over what is gathered, both summed over all squares but the few brightest, which hold a focus that
/// gathering blurs.
double difference(const std::vector<double>& drawn, const std::vector<double>& gathered) {
  std::vector<double> sorted = gathered;
  std::sort(sorted.begin(), sorted.end());
  const double most = 4 * sorted[sorted.size() / 2];
  double off = 0, sum = 0;
  for (size_t i = 0; i < drawn.size(); ++i) {
    if (gathered[i] > most) continue;
    off += std::abs(drawn[i] - gathered[i]);
    sum += gathered[i];
  }
  return off / sum;
}

}  // namespace

TEST_CASE("patches: the error of the ball's caustic, exact and as a mesh, falls with the photons to the power of -.8 at least") {
  Device device;
  for (const bool mesh : {false, true}) {
    CAPTURE(mesh);
    const CausticPlate plate = mesh ? CausticPlate(180) : CausticPlate();
    std::vector<double> errors;
    for (const uint64_t photons : {1u << 12, 1u << 14, 1u << 16, 1u << 18}) {
      const RenderResult result = caustics_of(plate.scene, photons, 1, PhotonEstimate::footprints, device);
      errors.push_back(plate.error(result));
      // All that is lit is drawn, and the map stays empty.
      CHECK(result.rays.gathered == 0);
      double found = 0, truth = 0;
      const std::vector<double> irradiance = CausticPlate::irradiance(result);
      for (size_t i = 0; i < irradiance.size(); ++i) found += irradiance[i], truth += plate.truth()[i];
      MESSAGE(photons << " photons: error " << errors.back() << ", flux " << found / truth);
      // What is beyond half a step at the border is left out.
      CHECK(std::abs(found / truth - 1) < 8.0 / static_cast<double>(photons) + 2e-4);
    }
    CHECK(errors[0] < 0.13);
    CHECK(errors[1] < 0.045);
    CHECK(errors[2] < (mesh ? 0.02 : 0.012));
    if (!mesh) CHECK(std::log(errors[3] / errors[0]) / std::log(64.0) < -0.8);
  }
}

TEST_CASE("patches: photons beyond what a lattice holds are on further ones") {
  Device device;
  const CausticPlate plate;
  const uint64_t photons = 2 * largest_lattice + 100'000;
  const RenderResult result = caustics_of(plate.scene, photons, 1, PhotonEstimate::automatic, device);
  MESSAGE("error " << plate.error(result));
  CHECK(plate.error(result) < 0.001);
  CHECK(result.passes == 1);
  CHECK(static_cast<double>(result.photons.photons_shot) == doctest::Approx(static_cast<double>(photons)).epsilon(0.01));
  CHECK(result.photons.shot.x == doctest::Approx(0.1 * CausticPlate::power).epsilon(1e-3));
}

TEST_CASE("patches: floor, wall and step each take their own light, as those do who gather it") {
  Device device;
  const Scene scene = corner({0.9, 1.1, 2.2}, {0.15, 0.2, 0});
  const std::vector<double> gathered = blocks(caustics_of(scene, 4'000'000, 16, PhotonEstimate::fixed_radius, device));
  const RenderResult patches = caustics_of(scene, 100'000, 16, PhotonEstimate::footprints, device);
  const double off = difference(blocks(patches), gathered);
  MESSAGE("squares of pixels differ by " << off);
  // Where patches are torn, at edges of the step and of shadows, they are right only as they get small.
  CHECK(off < 0.03);
  // Balls and edges are not drawn: they gather.
  CHECK(patches.rays.gathered > 0);
}

TEST_CASE("patches with a radius beside them: each pixel is what footprints draw there, or what a radius gathers") {
  Device device;
  const Scene scene = corner({0.9, 1.1, 2.2}, {0.15, 0.2, 0});
  const RenderResult both = caustics_of(scene, 100'000, 1, PhotonEstimate::automatic, device);
  const std::vector<double> found = both.film.mean("caustics");
  const std::vector<double> drawn = caustics_of(scene, 100'000, 1, PhotonEstimate::footprints, device).film.mean("caustics");
  const std::vector<double> gathered = caustics_of(scene, 100'000, 1, PhotonEstimate::automatic_radius, device).film.mean("caustics");
  size_t as_drawn = 0, as_gathered = 0, neither = 0;
  for (size_t i = 0; i < found.size(); i += 3) {
    const auto is_like = [&](const std::vector<double>& other) { return std::equal(&found[i], &found[i] + 3, &other[i]); };
    if (is_like(drawn) && is_like(gathered)) continue;  // dark
    ++(is_like(drawn) ? as_drawn : is_like(gathered) ? as_gathered : neither);
  }
  MESSAGE(as_drawn << " pixels drawn, " << as_gathered << " gathered");
  CHECK(as_drawn > 2000);
  CHECK(as_gathered > 200);
  CHECK(neither == 0);
  // Photons are told of once: of both sets, those that are gathered.
  CHECK(both.photons.photons_shot == 100'000);
}

TEST_CASE("patches: those that reach from the view behind the eye are cut") {
  Device device;
  // The eye is just above the floor, in the midst of the light that the mirror ball scatters.
  const Scene scene = corner({0.4, 0.02, 0.8}, {0.4, 0.0, -1});
  const std::vector<double> gathered = blocks(caustics_of(scene, 4'000'000, 16, PhotonEstimate::fixed_radius, device));
  const double off = difference(blocks(caustics_of(scene, 100'000, 16, PhotonEstimate::footprints, device)), gathered);
  MESSAGE("squares of pixels differ by " << off);
  CHECK(off < 0.1);
}

TEST_CASE("patches: what a pane that does nothing hides is gathered, and is the same") {
  Device device;
  CausticPlate plate;
  Scene behind = plate.scene;
  behind.materials.push_back(glass(1.0));
  add(behind, box({-0.03f, 0.165f, -0.03f}, {0.03f, 0.175f, 0.03f}, 2));  // right before the eye
  const RenderResult drawn = caustics_of(plate.scene, 65536, 64, PhotonEstimate::footprints, device);
  const RenderResult gathered = caustics_of(behind, 65536, 64, PhotonEstimate::footprints, device);
  MESSAGE("errors " << plate.error(drawn) << " drawn, " << plate.error(gathered) << " gathered");
  CHECK(drawn.rays.gathered == 0);
  CHECK(gathered.rays.gathered > 0);
  CHECK(plate.error(gathered) < 0.06);
  CHECK(plate.error(drawn) < 0.6 * plate.error(gathered));
}

TEST_CASE("patches: a texture is multiplied by the light of its own part of a pixel") {
  Device device;
  CausticPlate plate;
  // Pixels of 25 mm, across whose upper half the plate is white, and black across the lower.
  constexpr int size = 16, finer = 128 / size;
  plate.scene.film.width = plate.scene.film.height = size;
  plate.scene.textures.resize(1);
  plate.scene.textures[0].filter = TextureFilter::nearest;
  plate.scene.textures[0].width = 1;
  plate.scene.textures[0].height = 2;
  plate.scene.textures[0].texels = {glm::vec3(1), glm::vec3(0)};
  plate.scene.materials[1].diffuse = Spectrum(1.0);
  plate.scene.materials[1].diffuse_texture = 0;
  const double pixel = 2 * CausticPlate::half_width / size;
  std::get<Plane>(plate.scene.shapes[1].geometry).texture_u = {1, 0, 0};
  std::get<Plane>(plate.scene.shapes[1].geometry).texture_v = {0, 0, 1 / pixel};
  const RenderResult result = caustics_of(plate.scene, 65536, 256, PhotonEstimate::footprints, device);
  CHECK(result.rays.gathered == 0);
  const std::vector<double> radiance = result.film.mean("caustics");
  double squares = 0, sum = 0;
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column) {
      double truth = 0;
      for (int y = 0; y < finer / 2; ++y)
        for (int x = 0; x < finer; ++x) truth += plate.truth()[(row * finer + y) * 128 + column * finer + x] / (finer * finer);
      const double found = radiance[3 * (row * size + column)] * std::numbers::pi;
      squares += (found - truth) * (found - truth);
      sum += truth;
    }
  const double error = std::sqrt(squares) * size / sum;
  MESSAGE("error " << error);
  CHECK(error < 0.05);
}

}  // namespace vitrum
