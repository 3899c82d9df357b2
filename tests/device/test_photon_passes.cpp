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
  const Scene scene = ball_over_plane(1.5, Spectrum(0.0), 4.0);
  Device device;
  PhotonRun run(scene, device);
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

TEST_CASE("a pass that stores all of its photons takes no more memory for each than its capacity reckons with") {
  // Air reflects nothing; the plane takes all.
  const Scene scene = ball_over_plane(1.0, Spectrum(0.0), INFINITY);
  Device device;
  constexpr uint64_t count = 300'000;
  PhotonRun run(scene, device);
  run.run(0, 0, 0, count);
  REQUIRE(run.map().count == count);
  const double bytes = static_cast<double>(run.map().photons.size() * sizeof(float)) / count;
  const double room = static_cast<double>(std::min(device.info().max_allocation, device.info().memory / 2));
  CHECK(bytes * static_cast<double>(PhotonPass::capacity(device, Features{})) <= room);
}
