// The same scene and seed give the same bits, whatever the group size, the number of threads, and however often.

#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "render/render.hpp"
#include "scene/scene_file.hpp"
#include "scene/textures.hpp"
#include "temporary_folder.hpp"

namespace vitrum {
namespace {

struct Case {
  const char* model;
  std::vector<std::string> overrides;
  bool knows_bias = true;
};

/// Exact shapes; meshes with an area light and independent sampling; several passes of each; as many as a target error takes.
const std::vector<Case> cases = {
    {"default_scene", {"film.size=[60, 44]", "render.samples=3", "photons.count=300_000"}},
    {"default_scene", {"film.size=[33, 20]", "render.samples=4", "render.passes=2", "photons.count=70_001",
                       "render.sampling='independent'", "photons.sampling='independent'"}},
    {"default_scene", {"film.size=[30, 22]", "render.samples=4", "render.passes=4", "photons.count=80_000",
                       "photons.progressive=true"}},
    {"cornell_glass", {"film.size=[48, 37]", "render.samples=2", "photons.count=100_000"}},
    {"default_scene", {"film.size=[30, 22]", "render.samples=4", "render.passes=2", "photons.count=20_000",
                       "photons.estimate='footprints'"}, false},
    {"default_scene", {"film.size=[30, 22]", "render.samples=128", "render.adaptive=true", "photons.count=10_000"}},
    {"default_scene", {"film.size=[30, 22]", "render.target_error=0.2"}},
    {"default_scene", {"film.size=[30, 22]", "render.target_error=0.2", "photons.estimate='footprints'"}, false},
};

std::string scene_path(const Case& c) { return std::string(VITRUM_SOURCE_DIR "/models/") + c.model + "/scene.toml"; }

std::vector<View> views_of(const Case& c) {
  std::vector<View> views = {View::beauty, View::photons, View::caustics, View::albedo,
                             View::normal, View::depth,   View::error,    View::cut};
  if (c.knows_bias) views.push_back(View::bias);
  return views;
}

RenderResult rendered(const Case& c, unsigned group_size) {
  Device device("", group_size);
  RenderOptions options;
  options.views = views_of(c);
  Scene scene = load_scene(scene_path(c), c.overrides);
  load_textures(scene);
  return render(scene, device, options);
}

void check_same(const RenderResult& a, const RenderResult& b) {
  CHECK(a.film.names() == b.film.names());
  for (const std::string& name : a.film.names()) {
    CAPTURE(name);
    const std::vector<double> one = a.film.mean(name), other = b.film.mean(name);
    REQUIRE(one.size() == other.size());
    size_t differing = 0, not_finite = 0;
    for (size_t i = 0; i < one.size(); ++i) {
      differing += one[i] != other[i];
      not_finite += !(std::isfinite(one[i]) && std::isfinite(other[i])) && name != "depth";
    }
    CHECK(differing == 0);
    CHECK(not_finite == 0);
  }
  CHECK(a.standard_error() == b.standard_error());
  CHECK(a.rays.gathered == b.rays.gathered);
  CHECK(a.rays.gathered_pairs == b.rays.gathered_pairs);
  CHECK(a.photon_radius == b.photon_radius);
  CHECK(a.photons.photons_stored == b.photons.photons_stored);
  CHECK(a.photons.shot == b.photons.shot);
  CHECK(a.photons.stored == b.photons.stored);
  CHECK(a.photons.absorbed == b.photons.absorbed);
  CHECK(a.photons.direct == b.photons.direct);
  CHECK(a.photons.lost == b.photons.lost);
  CHECK(a.photons.cut == b.photons.cut);
}

}  // namespace

TEST_CASE("two group sizes, and two runs of one, give the same bits") {
  for (const Case& c : cases) {
    CAPTURE(std::string(c.model));
    const RenderResult first = rendered(c, 32);
    REQUIRE(first.photons.photons_stored > 0);
    CHECK(first.film.names().size() == (c.knows_bias ? 8 : 7));  // one for each view; the error is that of the beauty
    check_same(first, rendered(c, 64));
    check_same(first, rendered(c, 32));
  }
}

TEST_CASE("another seed gives other bits") {
  Case c = cases[0];
  const RenderResult first = rendered(c, 32);
  c.overrides.push_back("render.seed=1");
  const RenderResult second = rendered(c, 32);
  CHECK(first.film.mean("radiance") != second.film.mean("radiance"));
  CHECK(first.film.mean("caustics") != second.film.mean("caustics"));
}

TEST_CASE("one thread and two write the same file") {
  const TemporaryFolder folder;
  for (const Case& c : cases) {
    CAPTURE(std::string(c.model));
    // A process reads the number of threads once.
    const auto file_by = [&](const std::string& threads) {
      const std::string file = folder / (threads + ".exr");
      std::string command = VITRUM_BINARY_DIR "/vitrum render '" + scene_path(c) + "' --quiet --threads " + threads +
                            " -o '" + file + "'";
      for (const View view : views_of(c)) command += std::string(" --view ") + view_name(view);
      for (const std::string& key : c.overrides) command += " --set \"" + key + "\"";
      REQUIRE(std::system(command.c_str()) == 0);
      return file_bytes(file);
    };
    const std::string by_one = file_by("1");
    REQUIRE(by_one.size() > 1000);
    const bool same_bytes = by_one == file_by("2");
    CHECK(same_bytes);
  }
}

}  // namespace vitrum
