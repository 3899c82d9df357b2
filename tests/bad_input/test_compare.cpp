// `vitrum compare` as its users meet it: its numbers, its exit codes, the files that it writes, what it refuses.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "command_line.hpp"
#include "film/images.hpp"

using namespace vitrum;

namespace {

constexpr int width = 6, height = 4, values_of_picture = width * height * 3;

PictureLayer layer_of(const std::string& name, float value, int channels = 3) {
  return {name, channels, std::vector<float>(size_t(width * height * channels), value), true};
}

/// Pictures in a folder of their own, and runs of `vitrum compare` on them.
struct Pictures {
  TemporaryFolder folder;

  std::string write(const std::string& name, const std::vector<PictureLayer>& layers, int rows = height) const {
    write_picture(folder / name, width, rows, layers, {}, {});
    return folder / name;
  }
  std::string write(const std::string& name, float value) const { return write(name, {layer_of("beauty", value)}); }

  /// The report of a comparison that must end with `code`.
  nlohmann::json report(const Words& words, int code = 0) const {
    const std::string file = folder / "report.json";
    const Ended run = vitrum_run(Words{"compare"} + words + Words{"--report", file});
    CHECK_MESSAGE(run.code == code, run.out << run.err);
    CHECK(run.err == "wrote " + file + "\n");
    return nlohmann::json::parse(file_bytes(file));
  }
};

/// The end of a comparison without files to write.
Ended compare(const Words& words) { return vitrum_run(Words{"compare"} + words); }

}  // namespace

TEST_CASE("compare: bit-equal pictures") {
  const Pictures pictures;
  const std::string a = pictures.write("a.exr", 0.25f), b = pictures.write("b.exr", 0.25f);
  const Ended run = compare({a, b, "--threshold", "max=0", "--threshold", "pixels=0", "--threshold", "mean=0"});
  CHECK(run.code == 0);
  CHECK(run.err == "");
  CHECK(contains(run.out, "bit-equal"));
  CHECK_FALSE(contains(run.out, "EXCEEDED"));
}

TEST_CASE("compare: the numbers of known differences") {
  const Pictures pictures;
  PictureLayer layer = layer_of("beauty", 2.0f);
  layer.values[size_t((2 * width + 5) * 3 + 1)] = 2.5f;   // pixel (5, 2), green
  layer.values[0] = 1.75f;
  const std::string a = pictures.write("a.exr", {layer}), b = pictures.write("b.exr", 2.0f);
  const nlohmann::json report = pictures.report({a, b, "--epsilon", "1"});
  CHECK(report["size"] == nlohmann::json{width, height});
  CHECK(report["exceeded"] == false);
  const nlohmann::json& beauty = report["views"]["beauty"];
  const double mse = (0.25 + 0.0625) / values_of_picture;
  CHECK(beauty["mse"] == doctest::Approx(mse));
  CHECK(beauty["rmse"] == doctest::Approx(std::sqrt(mse)));
  CHECK(beauty["relative_mse"] == doctest::Approx(mse / 5));
  CHECK(beauty["relative_rmse"] == doctest::Approx(std::sqrt(mse / 5)));
  CHECK(beauty["mean"]["a"] == doctest::Approx(2 + 0.25 / values_of_picture));
  CHECK(beauty["mean"]["b"] == 2);
  CHECK(beauty["mean"]["ratio"] == doctest::Approx(1 + 0.125 / values_of_picture));
  CHECK(beauty["largest_difference"]["value"] == 0.5);
  CHECK(beauty["largest_difference"]["pixel"] == nlohmann::json{5, 2});
  CHECK(beauty["largest_difference"]["channel"] == 1);
  CHECK(beauty["largest_difference"]["a"] == 2.5);
  CHECK(beauty["largest_difference"]["b"] == 2);
  CHECK(beauty["differing_pixels"] == 2);
  CHECK_FALSE(beauty.contains("z_test"));
  CHECK_FALSE(beauty.contains("against_reference"));
  const Ended run = compare({a, b});
  CHECK(contains(run.out, "largest difference   0.5 at pixel (5, 2), G: A 2.5, B 2\n"));
  CHECK(contains(run.out, "pixels that differ   2 of 24\n"));
}

TEST_CASE("compare: two pictures against a third") {
  const Pictures pictures;
  const std::string a = pictures.write("a.exr", 1.1f), b = pictures.write("b.exr", 1.2f);
  const std::string r = pictures.write("r.exr", 1.0f);
  const Ended run = compare({a, b, "--reference", r});
  CHECK(contains(run.out, "against R"));
  const nlohmann::json against = pictures.report({a, b, "--reference", r})["views"]["beauty"]["against_reference"];
  CHECK(against["a"]["rmse"] == doctest::Approx(0.1));
  CHECK(against["b"]["mse"] == doctest::Approx(0.04));
  CHECK(against["b"]["relative_mse"] == doctest::Approx(0.04 / 1.01));
  CHECK(against["ratio"]["mse"] == doctest::Approx(0.25));
  CHECK(against["ratio"]["relative_mse"] == doctest::Approx(0.25));
  CHECK(against["ratio"]["rmse"] == doctest::Approx(0.5));
}

TEST_CASE("compare: thresholds decide the exit code") {
  const Pictures pictures;
  const std::string a = pictures.write("a.exr", 1.5f), b = pictures.write("b.exr", 1.0f);
  struct Limit {
    std::string measure;
    double value;
  };
  // All values differ by .5.
  const double relative = 0.25 / 1.01;
  for (const Limit& limit : {Limit{"mse", 0.25}, {"rmse", 0.5}, {"relmse", relative}, {"relrmse", std::sqrt(relative)},
                             {"max", 0.5}, {"mean", 0.5}, {"pixels", 24}}) {
    CAPTURE(limit.measure);
    const std::string name = limit.measure + "=";
    const Ended kept = compare({a, b, "--threshold", name + std::to_string(limit.value + 1e-5)});
    CHECK(kept.code == 0);
    CHECK(contains(kept.out, ": kept in beauty"));
    const Ended exceeded = compare({a, b, "--threshold", name + std::to_string(limit.value - 1e-5)});
    CHECK(exceeded.code == 3);
    CHECK(contains(exceeded.out, ": EXCEEDED in beauty"));
    CHECK(exceeded.err == "");
  }
  const nlohmann::json report = pictures.report({a, b, "--threshold", "max=1", "--threshold", "rmse=0.1"}, 3);
  CHECK(report["exceeded"] == true);
  CHECK(report["thresholds"][0]["exceeded"] == false);
  CHECK(report["thresholds"][1] ==
        nlohmann::json{{"measure", "rmse"}, {"limit", 0.1}, {"view", "beauty"}, {"value", 0.5}, {"exceeded", true}});
}

TEST_CASE("compare: views") {
  const Pictures pictures;
  PictureLayer depth = layer_of("depth", 3.0f, 1);
  depth.is_colour = false;
  const std::string a =
      pictures.write("a.exr", {layer_of("beauty", 1), layer_of("albedo", 1), depth, layer_of("error", 1)});
  const std::string b = pictures.write("b.exr", {layer_of("beauty", 1), layer_of("albedo", 2), depth});
  const Ended all = compare({a, b});
  for (const char* view : {"\nbeauty\n", "\nalbedo\n", "\ndepth\n"}) CHECK_MESSAGE(contains(all.out, view), view);
  const Ended depth_alone = compare({a, b, "--view", "depth", "--threshold", "max=0"});
  CHECK(depth_alone.code == 0);
  CHECK_FALSE(contains(depth_alone.out, "albedo"));
  CHECK(compare({a, b, "--threshold", "max=0"}).code == 3);  // the albedo
  CHECK(compare({a, b, "--view", "beauty", "--view", "albedo", "--threshold", "max=0"}).code == 3);
  // Errors are told of as such, and compared by themselves where that is asked for.
  CHECK_FALSE(contains(compare({a, a}).out, "\nerror\n"));
  CHECK(contains(compare({a, a, "--view", "error"}).out, "\nerror\n"));
}

TEST_CASE("compare: what is not finite is counted, and no threshold lets it pass") {
  const Pictures pictures;
  PictureLayer bad = layer_of("beauty", 1.0f), depth = layer_of("depth", 1.0f, 1);
  bad.values[4] = bad.values[5] = std::numeric_limits<float>::quiet_NaN();
  bad.values[20] = std::numeric_limits<float>::infinity();
  depth.is_colour = false;
  depth.values[3] = std::numeric_limits<float>::infinity();
  const std::string a = pictures.write("a.exr", {bad}), b = pictures.write("b.exr", 1.0f);
  const Ended run = compare({a, b});
  CHECK(run.code == 0);
  CHECK(contains(run.out, "not finite           A 2 pixels, B 0 pixels\n"));
  CHECK(compare({a, b, "--threshold", "pixels=1000"}).code == 3);
  CHECK(compare({b, a, "--threshold", "pixels=1000"}).code == 3);
  CHECK(compare({a, a, "--threshold", "pixels=1000"}).code == 3);
  const nlohmann::json beauty = pictures.report({a, b})["views"]["beauty"];
  CHECK(beauty["not_finite_pixels"] == nlohmann::json{{"a", 2}, {"b", 0}});
  CHECK(beauty["has_faults"] == true);
  CHECK(beauty["mse"].is_null());
  // The depth of the sky is infinite in both.
  const std::string sky = pictures.write("sky.exr", {depth});
  CHECK(compare({sky, sky, "--threshold", "max=0"}).code == 0);
}

TEST_CASE("compare: the z-test tells an error of one per cent from noise") {
  const Pictures pictures;
  std::mt19937_64 random(42);
  std::normal_distribution<float> noise(0.0f, 0.001f);
  // Noise of .1 % whose error is known: an error of 1 % is 7 times that of a difference, and the limit of alpha = .001
  // for 72 values is 4.35. One value stays below it with a chance of 4e-3, all of them never.
  const auto picture = [&](const std::string& name, float truth) {
    PictureLayer beauty = layer_of("beauty", 0.0f);
    for (float& value : beauty.values) value = truth + noise(random);
    return pictures.write(name, {beauty, layer_of("error", 0.001f)});
  };
  const std::string a = picture("a.exr", 1.0f), b = picture("b.exr", 1.0f), wrong = picture("wrong.exr", 1.01f);
  const Words test{"--degrees-of-freedom", "1000000", "--threshold", "z=0.001"};
  const nlohmann::json same = pictures.report(Words{a, b} + test, 0)["views"]["beauty"]["z_test"];
  CHECK(same["differ"] == false);
  CHECK(same["tested_values"] == values_of_picture);
  CHECK(same["p_value"] > 0.001);
  CHECK(same["limit"] == doctest::Approx(4.35).epsilon(0.01));
  const nlohmann::json different = pictures.report(Words{a, wrong} + test, 3)["views"]["beauty"]["z_test"];
  CHECK(different["differ"] == true);
  CHECK(different["largest_z"] < -7);
  const Ended run = compare(Words{a, wrong} + test);
  CHECK(contains(run.out, "THEY DIFFER"));
  CHECK(contains(run.out, "threshold z=0.001: EXCEEDED"));
  CHECK(contains(compare({a, b}).out, "no difference seen: p = "));
}

TEST_CASE("compare: renders that tell their errors, and one that is one per cent brighter") {
  const Pictures pictures;
  const auto render = [&](const std::string& name, const std::string& seed, const std::string& intensity) {
    const std::string file = pictures.folder / name;
    const Ended run = vitrum_run({"render", VITRUM_SOURCE_DIR "/models/default_scene/scene.toml", "-o", file, "--quiet", "--size",
                                  "24x18", "--samples", "2048", "--photons", "200000", "--seed", seed, "--view", "beauty",
                                  "--view", "error", "--set", "light.lamp.intensity=" + intensity});
    REQUIRE_MESSAGE(run.code == 0, run.err);
    return file;
  };
  const std::string a = render("a.exr", "1", "3.1416"), b = render("b.exr", "2", "3.1416");
  const std::string brighter = render("brighter.exr", "3", "3.173");
  // Pictures of the same settings have the same errors: 14 degrees.
  const Words test{"--degrees-of-freedom", "14", "--threshold", "z=0.001"};
  const nlohmann::json same = pictures.report(Words{a, b} + test, 0)["views"]["beauty"]["z_test"];
  CHECK(same["tested_values"] > 500);
  // About 1.17 if the errors are right (14 degrees); pixels share photons, so that its own error is not known.
  CHECK(same["mean_square"] > 0.9);
  CHECK(same["mean_square"] < 1.5);
  const nlohmann::json different = pictures.report(Words{a, brighter} + test, 3)["views"]["beauty"]["z_test"];
  CHECK(different["differ"] == true);
  CHECK(different["largest_z"] < 0);
}

TEST_CASE("compare: the picture of the differences is written whole, and nothing else") {
  const Pictures pictures;
  PictureLayer layer = layer_of("beauty", 1.0f);
  layer.values[3] = 1.5f;
  layer.values[6] = 1.25f;
  const std::string a = pictures.write("a.exr", {layer}), b = pictures.write("b.exr", 1.0f);
  for (const std::string ending : {"png", "exr", "jpg"}) {
    CAPTURE(ending);
    const std::string file = pictures.folder / ("d." + ending);
    const Ended run = compare({a, b, "-o", file});
    CHECK(run.code == 0);
    CHECK(run.err == "wrote " + file + ": |A - B| of the beauty, from 0 (black) to 0.5 (white, and all above)\n");
    const Picture picture = read_picture(file, {"test"});
    CHECK(picture.width > width + 16);
    CHECK(picture.height == 120);
    if (ending == "jpg") continue;
    CHECK(picture.pixels[0] == glm::vec3(0));
    CHECK(picture.pixels[1] == glm::vec3(1));
  }
  CHECK(pictures.folder.entries() == 5);
  // With a scale of 1, .5 is no longer white.
  CHECK(compare({a, b, "-o", pictures.folder / "d.png", "--scale", "1"}).code == 0);
  CHECK(read_picture(pictures.folder / "d.png", {"test"}).pixels[1] != glm::vec3(1));
  // It is written also where a threshold is exceeded.
  CHECK(compare({a, b, "-o", pictures.folder / "e.png", "--threshold", "max=0"}).code == 3);
  CHECK(read_picture(pictures.folder / "e.png", {"test"}).height == 120);
}

TEST_CASE("compare: pictures for the screen, and a warning where one is not") {
  const Pictures pictures;
  const std::string a = pictures.write("a.png", 0.5f), b = pictures.write("b.bmp", 0.5f);
  const std::string linear = pictures.write("c.exr", 0.5f);
  const Ended same = compare({a, b, "--threshold", "pixels=0"});
  CHECK(same.code == 0);
  CHECK(same.err == "");
  const Ended mixed = compare({a, linear});
  CHECK(mixed.code == 0);
  CHECK(mixed.err.rfind("warning: " + a + ": ", 0) == 0);
  CHECK(contains(mixed.err, linear));
}

TEST_CASE("compare: pictures that cannot be compared") {
  const Pictures pictures;
  const std::string a = pictures.write("a.exr", 1), b = pictures.write("b.exr", 1);
  const std::string none = pictures.folder / "none.exr";
  const std::string small = pictures.write("small.exr", {{"beauty", 3, std::vector<float>(width * 2 * 3), true}}, 2);
  const std::string albedo = pictures.write("albedo.exr", {layer_of("albedo", 1)});
  const std::string grey = pictures.write("grey.exr", {layer_of("albedo", 1, 1)});
  const std::string junk = pictures.folder / "junk.exr", cut = pictures.folder / "cut.exr";
  put_file(junk, "this is no picture");
  put_file(cut, file_bytes(a).substr(0, file_bytes(a).size() - 20));
  const int before = pictures.folder.entries();
  const Words out{"-o", pictures.folder / "d.png", "--report", pictures.folder / "d.json"};
  check_refused(Words{"compare", a, none} + out, none, "does not exist", "check the name");
  check_refused(Words{"compare", junk, a} + out, junk, "is no picture", "use a PNG");
  check_refused(Words{"compare", a, b, "--reference", cut} + out, cut, "is damaged", "put a sound copy");
  check_refused(Words{"compare", a, small} + out, small, "6 x 2 pixels, '" + a + "' has 6 x 4", "compare pictures of");
  check_refused(Words{"compare", a, b, "--reference", small} + out, small, "6 x 2 pixels", "compare pictures of one");
  check_refused(Words{"compare", a, albedo} + out, albedo, "no layer in common ('" + a + "' has beauty", "render the");
  check_refused(Words{"compare", a, b, "--reference", albedo} + out, albedo, "no layer in common", "render the same");
  check_refused(Words{"compare", a, b, "--view", "beuty"} + out, a, "no layer 'beuty'", "did you mean 'beauty'?");
  check_refused(Words{"compare", albedo, grey} + out, grey, "has 1 channel", "compare pictures whose layers are alike");
  check_refused(Words{"compare", a, b, "--threshold", "z=0.01"} + out, "--threshold z=0.01", "no z-test",
                "compare EXR pictures that both have");
  CHECK(pictures.folder.entries() == before);
}

TEST_CASE("compare: bad command line") {
  const Pictures pictures;
  const std::string a = pictures.write("a.exr", 1), b = pictures.write("b.exr", 1), out = pictures.folder / "d.png";
  const Words words{"compare", a, b};
  check_refused({"compare", a}, "", "B is required", "`vitrum compare --help`");
  CHECK(compare({a}).code == 2);
  check_refused(words + Words{"--treshold", "max=1"}, "--treshold", "no such option", "did you mean '--threshold'?");
  check_refused(words + Words{"--scale", "1"}, "", "--output", "`vitrum compare --help`");
  check_refused(words + Words{"--threshold", "max"}, "--threshold max", "no '='", "write --threshold NAME=VALUE");
  check_refused(words + Words{"--threshold", "rms=1"}, "--threshold rms=1", "no such measure", "did you mean 'rmse'?");
  check_refused(words + Words{"--threshold", "max=-1"}, "--threshold max=-1", "out of range", "write a number from 0");
  check_refused(words + Words{"--threshold", "max=1x"}, "--threshold max=1x", "no number", "write a number from 0");
  check_refused(words + Words{"--threshold", "max=nan"}, "--threshold max=nan", "no number", "write a number from 0");
  check_refused(words + Words{"--threshold", "z=2"}, "--threshold z=2", "out of range", "write a number from 0 to 1");
  check_refused(words + Words{"-o", out, "--scale", "0"}, "--scale 0", "out of range", "write a number");
  check_refused(words + Words{"--epsilon", "0"}, "--epsilon 0", "out of range", "write a number");
  check_refused(words + Words{"--alpha", "1"}, "--alpha 1", "out of range", "write a number");
  check_refused(words + Words{"--degrees-of-freedom", "0"}, "--degrees-of-freedom 0", "out of range", "write digits");
  check_refused(words + Words{"--view", "beauty", "--view", "beauty"}, "--view beauty", "named twice", "name it once");
  check_refused(words + Words{"-o", a}, a, "read and written", "give what is written");
  check_refused(words + Words{"-o", out, "--report", out}, out, "written twice", "give every picture");
  const std::string gif = pictures.folder / "d.gif";
  check_refused(words + Words{"-o", gif}, gif, "'.gif'", "let the name end");
  CHECK(pictures.folder.entries() == 2);
}

TEST_CASE("compare: the help defines every measure and every exit code") {
  const Ended help = compare({"--help"});
  CHECK(help.code == 0);
  CHECK(help.err == "");
  for (const char* part : {"--reference", "--view", "--output", "--scale", "--report", "--threshold", "--epsilon",
                           "--alpha", "--degrees-of-freedom", "  mse ", "  rmse ", "  relmse ", "  relrmse ", "  max ",
                           "  mean ", "  pixels ", "  z ", "(a - b)^2 / (b^2 + epsilon)", "Exit code: 0; 3",
                           "docs/compare.md"})
    CHECK_MESSAGE(contains(help.out, part), part);
}
