// Kernels that give values which are no numbers: nothing is hidden, and nothing else is lost.
#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "broken_kernels.hpp"
#include "command_line.hpp"
#include "film/images.hpp"

using namespace vitrum;

namespace {

struct Rendered {
  std::string err;
  nlohmann::json report;
  Picture picture;
};

/// A picture of 16 x 16 pixels and 4 samples.
Rendered rendered(const std::string& kernels, const Words& more) {
  const TemporaryFolder folder;
  const std::string exr = folder / "a.exr", report = folder / "r.json";
  const Ended run = vitrum_run(Words{"render", VITRUM_SOURCE_DIR "/models/default_scene/scene.toml", "-o", exr, "--report", report,
                                     "--kernels", kernels, "--size", "16x16", "--samples", "4", "--photons", "1000"} +
                               more);
  REQUIRE_MESSAGE(run.code == 0, run.err);
  return {run.err, nlohmann::json::parse(file_bytes(report)), read_picture(exr, {"test"})};
}

}  // namespace

TEST_CASE("a NaN on the film is counted and told of, and its pixel keeps the other passes") {
  const Rendered sound = rendered(VITRUM_SOURCE_DIR "/kernels", {});
  CHECK(sound.report["rejected_values"] == 0);
  CHECK_FALSE(contains(sound.err, "warning"));
  // Red of pixel 5, in the passes of the first 4 samples.
  const std::string store = "  store_film3(film, FILM_BEAUTY, film_stride, i, beauty);";
  const auto broken = [&store](const std::string& where) {
    return BrokenKernels("stages/camera.cl", store,
                         "  beauty.x = ((LANES + i) == (Uint)5)" + where + " ? (Float)NAN : beauty.x;\n" + store);
  };
  const Rendered all = rendered(broken("").folder.path(), {"--set", "render.passes=2"});
  CHECK(all.report["rejected_values"] == 2);
  CHECK(contains(all.err, "warning: 2 values of the picture and 0 photons were not finite"));
  CHECK(std::isnan(all.picture.pixels[5].x));  // nothing is left of it
  CHECK(all.picture.pixels[5].y == doctest::Approx(sound.picture.pixels[5].y).epsilon(0.5));
  // The first of the sequence's points is (0, 0).
  const Rendered one =
      rendered(broken(" & (Mask)(samples[0].x == 0.0f ? -1 : 0)").folder.path(), {"--set", "render.passes=2"});
  CHECK(one.report["rejected_values"] == 1);
  CHECK(contains(one.err, "warning: 1 values"));
  size_t not_finite = 0;
  for (const glm::vec3& pixel : one.picture.pixels) not_finite += !std::isfinite(pixel.x + pixel.y + pixel.z);
  CHECK(not_finite == 0);
  CHECK(one.picture.pixels[5].x == doctest::Approx(sound.picture.pixels[5].x).epsilon(0.5));
}

TEST_CASE("photons whose power or place is no number are counted and told of, and not stored") {
  const std::string power = "  photons.power = scale3(share * weight, emission.power);";
  const std::string place = "        if (k == OUTCOME_STORED) {\n          const Mask sound";
  const BrokenKernels powers("stages/photons.cl", power,
                             power + "\n  photons.power.x = (first + LANES) % 100 == (Uint)7 ? (Float)NAN : photons.power.x;");
  const BrokenKernels places("stages/photons.cl", place,
                             "        photons.origin.y = (photons.path & 63u) == (Uint)0 ? (Float)INFINITY : photons.origin.y;\n" +
                                 place);
  for (const BrokenKernels* kernels : {&powers, &places}) {
    const Rendered broken = rendered(kernels->folder.path(), {});
    const int rejected = broken.report["photons"]["rejected"];
    CHECK(rejected > 5);
    CHECK(rejected < 50);
    CHECK(broken.report["rejected_values"] == 0);
    CHECK(contains(broken.err, "0 values of the picture and " + std::to_string(rejected) + " photons were not finite"));
    const auto& photons = broken.report["photons"];
    CHECK(photons["shot"].get<int>() + photons["branched"].get<int>() ==
          photons["stored"].get<int>() + photons["absorbed"].get<int>() + photons["direct"].get<int>() +
              photons["lost"].get<int>() + photons["cut"].get<int>() + rejected);
  }
}
