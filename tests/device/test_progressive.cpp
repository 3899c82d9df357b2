// A progressive radius goes by the number of the pass in the picture, from that of the first pass.
#include <doctest/doctest.h>

#include <cmath>

#include "core/printed.hpp"
#include "render/photon_grid.hpp"
#include "render/render.hpp"
#include "scene/scene_file.hpp"
#include "scene/textures.hpp"

using namespace vitrum;

namespace {

/// Mean radius over the passes [m].
double mean_radius(int passes, std::vector<std::string> overrides) {
  overrides.insert(overrides.end(), {"film.size=[8, 6]", printed("render.samples=%d", passes),
                                     printed("render.passes=%d", passes), printed("photons.count=%d", 20'000 * passes)});
  Scene scene = load_scene(VITRUM_SOURCE_DIR "/models/default_scene/scene.toml", overrides);
  load_textures(scene);
  Device device;
  return render(scene, device, {}).photon_radius;
}

}  // namespace

TEST_CASE("the area of a progressive estimate is the product of Knaus and Zwicker's ratios") {
  double product = 1.0;
  for (uint64_t pass = 0; pass < 10'000; ++pass) {
    CHECK(progressive_area(pass) == doctest::Approx(product).epsilon(1e-11));
    product *= (static_cast<double>(pass) + 1.0 + 2.0 / 3.0) / (static_cast<double>(pass) + 2.0);
  }
}

TEST_CASE("a progressive radius shrinks from pass to pass, through all replicates") {
  // Ten passes are dealt out to eight replicates.
  double shrunk = 0.0;
  for (uint64_t pass = 0; pass < 10; ++pass) shrunk += std::sqrt(progressive_area(pass)) / 10;
  for (const std::string estimate : {"radius", "automatic"}) {
    const std::vector<std::string> fixed = {"photons.estimate='" + estimate + "'", "photons.radius=0.02"};
    std::vector<std::string> progressive = fixed;
    progressive.push_back("photons.progressive=true");
    const double first = mean_radius(1, fixed);
    CHECK(mean_radius(1, progressive) == first);
    CHECK(mean_radius(10, progressive) == doctest::Approx(shrunk * first).epsilon(1e-6));
  }
}
