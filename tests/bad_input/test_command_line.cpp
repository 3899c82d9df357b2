// vitrum as its users meet it: every kind of bad input is told with its place and its mend, ends with an exit code
// other than 0 and leaves nothing behind; good input gives whole files that hold what was asked for.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "command_line.hpp"
#include "core/error.hpp"
#include "film/images.hpp"

using namespace vitrum;

namespace {

const std::string models = VITRUM_SOURCE_DIR "/models/";
const std::string default_scene = models + "default_scene/scene.toml";
const Words small{"--size", "16x16", "--samples", "1", "--photons", "1000"};

/// A scene of one mesh, in a folder that a render must leave as it is.
struct MeshScene {
  TemporaryFolder folder;
  std::string scene = folder / "scene.toml", obj = folder / "a.obj", mtl = folder / "a.mtl";

  MeshScene() {
    put_file(scene, "vitrum = 1\n[camera]\neye = [0, 0, 3]\nlook_at = [0, 0, 0]\n"
                    "[light.lamp]\ntype = \"point\"\nposition = [0, 0, 3]\nintensity = [1, 1, 1]\n"
                    "[shape.a]\ntype = \"mesh\"\nfile = \"a.obj\"\n");
    put_file(obj, "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n");
    put_file(mtl, "newmtl red\nKd 0.8 0.1 0.1\nillum 1\n");
  }
  void check_render_refused(const std::string& place, const std::string& problem, const std::string& mend) const {
    const int before = folder.entries();
    const std::string out = folder / "out.png", report = folder / "report.json";
    check_refused(Words{"render", scene, "-o", out, "--report", report} + small, folder / place, problem, mend);
    CHECK(folder.entries() == before);
  }
};

/// Names of an EXR file's channels, from its header (OpenEXR file layout: attribute "channels" of type chlist).
Words exr_channels(const std::string& path) {
  const std::string bytes = file_bytes(path);
  const std::string attribute = std::string("channels\0chlist\0", 16);
  size_t at = bytes.find(attribute);
  Words names;
  if (at == std::string::npos) return names;
  for (at += attribute.size() + 4; bytes[at] != '\0'; at += names.back().size() + 1 + 16) names.push_back(&bytes[at]);
  return names;
}

}  // namespace

TEST_CASE("a sound scene is rendered, so that what the tests below refuse is the fault they put in") {
  const MeshScene files;
  const Ended run = vitrum_run(Words{"render", files.scene, "-o", files.folder / "out.png"} + small);
  CHECK_MESSAGE(run.code == 0, run.err);
  CHECK(files.folder.entries() == 4);
}

TEST_CASE("bad scene file") {
  const MeshScene files;
  put_file(files.scene, "vitrum = 1\n[camera]\neye = [0, 0, 3\n");
  files.check_render_refused("scene.toml:3:16", "no TOML", "write an array");
  put_file(files.scene, "vitrum = 1\n[camera]\neye = [0, 0, 3]\nlook_at = [0, 0, 0]\n[render]\nsampels = 4\n");
  files.check_render_refused("scene.toml:6:1", "render.sampels is not a key", "did you mean 'samples'?");
  check_refused({"render", files.folder / "none.toml", "-o", files.folder / "out.png"}, files.folder / "none.toml",
                "there is no such scene file", "check the path");
  check_refused({"info", files.folder.path()}, files.folder.path(), "this is a folder", "name the .toml file in it");
}

TEST_CASE("bad OBJ") {
  const MeshScene files;
  put_file(files.obj, "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 9\n");
  files.check_render_refused("a.obj:6:1", "refers to vertex 9", "check the program");
  put_file(files.obj, "mtllib a.mtl\nv 0 0 zero\n");
  files.check_render_refused("a.obj:2:7", "", "");
}

TEST_CASE("bad MTL") {
  const MeshScene files;
  put_file(files.mtl, "newmtl red\nKd 0.8 x 0.1\nillum 1\n");
  files.check_render_refused("a.mtl:2:8", "", "");
}

TEST_CASE("bad texture") {
  const MeshScene files;
  put_file(files.obj, "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl red\nf 1/1 2/2 3/3\n");
  put_file(files.mtl, "newmtl red\nillum 1\nmap_Kd wood.png\n");
  files.check_render_refused("a.mtl:3:1", "wood.png' does not exist", "check the name");
  put_file(files.folder / "wood.png", "");
  files.check_render_refused("a.mtl:3:1", "is empty", "put a picture");
}

TEST_CASE("a texture that turns out to be broken leaves no output") {
  const MeshScene files;
  put_file(files.obj, "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl red\nf 1/1 2/2 3/3\n");
  put_file(files.mtl, "newmtl red\nillum 1\nmap_Kd wood.png\n");
  const std::string grass = file_bytes(models + "default_scene/grass.png");
  std::string damaged = grass;
  for (size_t i = 0; i < 64; ++i) damaged[grass.size() / 2 + i] = '\0';
  const auto check = [&](const std::string& bytes, const std::string& problem, const std::string& mend) {
    put_file(files.folder / "wood.png", bytes);
    const int before = files.folder.entries();
    const Words outputs{"-o", files.folder / "a.png", "-o", files.folder / "b.exr", "--report", files.folder / "r.json"};
    // Standard error holds that one line: nothing that a decoder has to say beside it.
    check_refused(Words{"render", files.scene, "--quiet"} + outputs + small, files.mtl + ":3:1", problem, mend);
    check_refused({"info", files.scene}, files.mtl + ":3:1", problem, mend);
    CHECK(files.folder.entries() == before);
  };
  check("this is no picture", "is no picture", "use a PNG");
  check(grass.substr(0, grass.size() / 2), "is damaged or cut short", "put a sound copy");
  check(damaged, "is damaged or cut short", "put a sound copy");
}

TEST_CASE("bad command line") {
  const TemporaryFolder folder;
  const std::string out = folder / "out.png";
  const Words render{"render", default_scene, "-o", out};
  check_refused({}, "", "subcommand is required", "`vitrum --help`");
  check_refused({"rendr"}, "rendr", "there is no such command", "did you mean 'render'?");
  check_refused({"devices", "all"}, "all", "one word too many", "");
  check_refused({"render"}, "", "SCENE is required", "`vitrum render --help`");
  check_refused({"render", default_scene}, "", "--output is required", "`vitrum render --help`");
  check_refused(render + Words{"--sample", "3"}, "--sample", "there is no such option", "did you mean '--samples'?");
  check_refused(render + Words{"more"}, "more", "one word too many", "put text with spaces between quotes");
  check_refused(render + Words{"--samples"}, "", "--samples", "`vitrum render --help`");
  check_refused(render + Words{"--samples", "1", "--samples", "2"}, "", "--samples", "`vitrum render --help`");
  check_refused(render + Words{"--samples", "0"}, "--samples 0", "out of range", "it must be between 1");
  check_refused(render + Words{"--samples", "1e3"}, "--samples 1e3", "no whole number", "write digits only");
  check_refused(render + Words{"--photons", "-1"}, "--photons -1", "no whole number", "write digits only");
  check_refused(render + Words{"--target-error", "x"}, "--target-error x", "this is no number", "write one");
  check_refused(render + Words{"--target-error", "2"}, "--target-error 2", "out of range", "it must be between");
  check_refused(render + Words{"--time-limit", "1e999"}, "--time-limit 1e999", "this is no number", "write one");
  check_refused(render + Words{"--target-error", "0.1", "--samples", "4"}, "--target-error 0.1", "does not go with --samples",
                "leave one of them out");
  check_refused(render + Words{"--time-limit", "9", "--photons", "4"}, "--time-limit 9", "does not go with --photons",
                "leave one of them out");
  check_refused(render + Words{"--seed", "9223372036854775808"}, "--seed 9223372036854775808", "out of range", "write");
  check_refused(render + Words{"--size", "640"}, "--size 640", "this is no size", "write width and height");
  check_refused(render + Words{"--size", "0x4"}, "--size 0x4", "out of range", "it must be between 1");
  check_refused(render + Words{"--threads", "x"}, "--threads x", "no whole number", "write digits only");
  check_refused(render + Words{"--threads", "1025"}, "--threads 1025", "out of range", "write digits only");
  check_refused(render + Words{"--group-size", "0"}, "--group-size 0", "out of range", "write digits only");
  check_refused(render + Words{"--kernels", "/nowhere"}, "--kernels /nowhere", "no such folder", "name the folder");
  CHECK(folder.entries() == 0);
}

TEST_CASE("bad view") {
  const TemporaryFolder folder;
  const Words render{"render", default_scene, "-o", folder / "out.png"};
  check_refused(render + Words{"--view", "nromal"}, "--view nromal", "there is no such view", "did you mean 'normal'?");
  check_refused(render + Words{"--view", "depth", "--view", "depth"}, "--view depth", "named twice", "name it once");
  // One sample tells no scatter.
  const Words one = render + Words{"--quiet", "--samples", "1"};
  check_refused(one + Words{"--view", "error"}, "--view error", "one sample a pixel", "take at least --samples 2");
  check_refused(one + Words{"--view", "bias"}, "--view bias", "one sample a pixel", "take at least --samples 2");
  check_refused(render + Words{"--quiet", "--view", "bias", "--set", "photons.estimate=nearest"}, "--view bias", "k nearest photons",
                "take photons.estimate");
  check_refused(render + Words{"--quiet", "--view", "bias", "--set", "photons.estimate=footprints"}, "--view bias", "footprints",
                "take photons.estimate");
  CHECK(folder.entries() == 0);
}

TEST_CASE("views of errors: the picture's, what was cut, the radius' bias") {
  const TemporaryFolder folder;
  const std::string file = folder / "report.json", exr = folder / "a.exr";
  const Words words = Words{"render", default_scene, "-o", exr, "--report", file, "--size", "16x16", "--photons", "20000",
                            "--view", "beauty", "--view", "error", "--view", "cut", "--view", "bias"};
  const auto report_of = [&](const Words& more) {
    const Ended run = vitrum_run(words + more);
    REQUIRE_MESSAGE(run.code == 0, run.err);
    return nlohmann::json::parse(file_bytes(file));
  };
  const nlohmann::json report = report_of({"--samples", "16", "--set", "render.max_depth=3"});
  const LayeredPicture picture = read_layers(exr, {"test"});
  REQUIRE(picture.layers.size() == 4);
  CHECK(report["settings"]["passes"] == 8);
  CHECK(report["standard_error"]["degrees_of_freedom"] == 7);
  // The report has mean and worst pixel of what the layers show.
  const auto check = [&](const std::string& layer, const std::string& key) {
    CAPTURE(layer);
    const auto found = std::find_if(picture.layers.begin(), picture.layers.end(),
                                    [&](const PictureLayer& candidate) { return candidate.name == layer; });
    REQUIRE(found != picture.layers.end());
    REQUIRE(found->channels == 3);
    double sum = 0, worst = 0;
    size_t at = 0;
    for (size_t i = 0; i < found->values.size(); ++i) {
      const double value = static_cast<double>(found->values[i]);
      sum += value;
      if (std::abs(value) > std::abs(worst)) {
        worst = value;
        at = i / 3;
      }
    }
    CHECK(worst != 0);
    const nlohmann::json& told = key == "bias" ? report["photon_estimate"]["bias"] : report[key];
    CHECK(told["mean"] == doctest::Approx(sum / (16 * 16 * 3)).epsilon(1e-5));
    CHECK(told["worst_pixel"] == doctest::Approx(worst).epsilon(1e-5));
    CHECK(told["pixel"] == nlohmann::json{at % 16, at / 16});
  };
  check("error", "standard_error");
  check("cut", "cut_radiance");
  check("bias", "bias");
  CHECK(report["cut_radiance"]["is_bound"] == false);  // its lamp is a point
  // Fewer samples are fewer replicates; more passes than asked for are not taken.
  CHECK(report_of({"--samples", "3"})["standard_error"]["degrees_of_freedom"] == 2);
  CHECK(report_of({"--samples", "24", "--set", "render.passes=12"})["settings"]["passes"] == 12);
}

TEST_CASE("bad --set") {
  const TemporaryFolder folder;
  const auto check = [&](const std::string& set, const std::string& problem, const std::string& mend) {
    check_refused({"render", default_scene, "-o", folder / "out.png", "--set", set}, "--set " + set, problem, mend);
  };
  check("render.reflectance", "there is no '='", "write --set KEY=VALUE");
  check("render.reflectanse=1", "is not a key", "did you mean 'reflectance'?");
  check("render.reflectance=2", "out of range", "it must be between 0 and 1");
  check("render.samples=many", "wants a whole number", "give it a whole number");
  check("material.glas.Kd=1", "no shape has a material 'glas'", "did you mean 'glass'?");
  CHECK(folder.entries() == 0);
}

TEST_CASE("no device") {
  const TemporaryFolder folder, vendors;
  const Words no_vendor{"OCL_ICD_VENDORS=" + vendors.path()};
  const std::string mend = "install one, for a CPU: apt-get install pocl-opencl-icd";
  check_refused({"devices"}, "", "no OpenCL device was found", mend, no_vendor);
  check_refused(Words{"render", default_scene, "-o", folder / "out.png"} + small, "", "no OpenCL device was found", mend,
                no_vendor);
  check_refused(Words{"render", default_scene, "-o", folder / "out.png", "--device", "abacus"} + small,
                "--device abacus", "there is no such device", "choose by number");
  CHECK(folder.entries() == 0);
}

TEST_CASE("output that cannot be written") {
  const TemporaryFolder folder;
  const std::string none = folder / "none/out.png", good = folder / "out.png";
  const Words render{"render", default_scene};
  check_refused(render + Words{"-o", none}, none, "does not exist", "make it first");
  check_refused(render + Words{"-o", folder.path() + "/."}, folder.path() + "/.", "", "let the name end in");
  check_refused(render + Words{"-o", folder / "out"}, folder / "out", "no ending", "let the name end in .exr");
  check_refused(render + Words{"-o", folder / "out.gif"}, folder / "out.gif", "'.gif'", "let the name end in .exr");
  check_refused(render + Words{"-o", good, "--report", none}, none, "does not exist", "make it first");
  check_refused(render + Words{"-o", good, "-o", good}, good, "written twice", "give every picture");
  check_refused(render + Words{"-o", good, "--report", good}, good, "written twice", "give every picture");
  CHECK(folder.entries() == 0);
}

TEST_CASE("a render that is interrupted leaves nothing, and what was there as it was") {
  const TemporaryFolder folder;
  const std::string old_picture = folder / "old.png";
  put_file(old_picture, "old");
  for (const int signal_number : {SIGINT, SIGTERM}) {
    VitrumProcess process({"render", default_scene, "-o", old_picture, "-o", folder / "new.exr", "--report",
                           folder / "report.json", "--size", "256x256", "--samples", "1000000"});
    REQUIRE(process.has_said("features:"));
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    process.send(signal_number);
    CHECK(process.wait() == -signal_number);
    CHECK(folder.entries() == 1);
    CHECK(file_bytes(old_picture) == "old");
  }
}

TEST_CASE("a picture holds every view, who made it and how") {
  const TemporaryFolder folder;
  const std::string exr = folder / "a.exr", png = folder / "a.png";
  const Ended run = vitrum_run(Words{"render", "-o", exr, "-o", png, default_scene, "--seed", "77"} + small +
                               Words{"--view", "beauty", "--view", "photons", "--view", "caustics", "--view", "albedo",
                                     "--view", "normal", "--view", "depth"});
  REQUIRE_MESSAGE(run.code == 0, run.err);
  CHECK(run.out.empty());
  CHECK_FALSE(contains(run.err, "\r"));      // progress is for terminals
  CHECK_FALSE(contains(run.err, "warning"));  // a sound scene and our kernels give no cause
  CHECK(folder.entries() == 2);
  // The order is that of the file format: by name.
  const Words channels{"B", "G", "R", "albedo.B", "albedo.G", "albedo.R", "caustics.B", "caustics.G", "caustics.R",
                       "depth.Z", "normal.X", "normal.Y", "normal.Z", "photons.B", "photons.G", "photons.R"};
  CHECK(exr_channels(exr) == channels);
  for (const std::string& file : {exr, png}) {
    const std::string bytes = file_bytes(file);
    for (const char* key : {"version", "seed", "samples", "photons", "device", "scene"})
      CHECK_MESSAGE(contains(bytes, std::string("vitrum:") + key), file << " lacks " << key);
    CHECK(contains(bytes, "77"));
    const Picture picture = read_picture(file, {"test"});
    CHECK(picture.width == 16);
    CHECK(picture.height == 16);
  }
}

TEST_CASE("--quiet prints nothing") {
  const TemporaryFolder folder;
  // A cache of its own, so that the kernels are compiled and their compiler has occasion to talk.
  const TemporaryFolder cache;
  const Ended run = vitrum_run(Words{"render", default_scene, "-o", folder / "a.png", "--quiet"} + small,
                               {"POCL_CACHE_DIR=" + cache.path()});
  CHECK(run.code == 0);
  CHECK(run.out.empty());
  CHECK(run.err == "");
  CHECK(folder.entries() == 1);
}

TEST_CASE("the report is complete") {
  const TemporaryFolder folder;
  const std::string file = folder / "report.json";
  const Ended run = vitrum_run(Words{"render", default_scene, "-o", folder / "a.png", "--report", file, "--seed", "5",
                                     "--set", "render.max_depth=7"} + small);
  REQUIRE_MESSAGE(run.code == 0, run.err);
  const nlohmann::json report = nlohmann::json::parse(file_bytes(file));
  CHECK(report["settings"]["size"] == nlohmann::json{16, 16});
  CHECK(report["settings"]["samples"] == 1);
  CHECK(report["settings"]["seed"] == 5);
  CHECK(report["settings"]["max_depth"] == 7);
  CHECK(report["settings"]["reflectance"] == "fresnel");
  CHECK(report["settings"]["photons"]["count"] == 1000);
  for (const char* key : {"name", "platform", "version", "driver"}) CHECK_FALSE(report["device"][key].empty());
  CHECK(contains(report["features"], "caustics"));
  CHECK_FALSE(contains(report["features"], "mesh"));
  for (const char* stage : {"load", "tree", "build", "photons", "sort", "camera", "write", "total"}) {
    CHECK_MESSAGE(report["seconds"].contains(stage), stage);
    CHECK_MESSAGE(report["seconds"].value(stage, -1.0) >= 0.0, stage);
  }
  CHECK(report["rays"]["camera"] == 16 * 16);
  CHECK(report["rays"]["secondary"] > 0);
  CHECK(report["rays"]["shadow"] > 0);
  CHECK(report["rays"]["photon"] > 1000);
  CHECK(report["photons"]["shot"] == 1000);
  CHECK(report["photons"]["stored"] > 500);
  CHECK(report["photons"]["stored"] <= 2000);  // one may branch off each
  const nlohmann::json& power = report["photon_power_watts"];
  for (int c = 0; c < 3; ++c) {
    const auto watts = [&](const char* what) { return power[what][c].get<double>(); };
    CHECK(watts("shot") + watts("split") == doctest::Approx(watts("stored") + watts("absorbed") + watts("direct") + watts("lost") +
                                           watts("cut")).epsilon(1e-5));
    CHECK(watts("absorbed") > 0.0);
  }
  CHECK(report["cut_weight"]["mean"] >= 0.0);
  CHECK(report["cut_radiance"]["mean"] >= 0.0);
  CHECK(report["rejected_values"] == 0);
  CHECK(report["photons"]["rejected"] == 0);
  const nlohmann::json& estimate = report["photon_estimate"];
  CHECK(estimate["radius_m"] > 0.0);
  CHECK(estimate["noise"] == doctest::Approx(std::sqrt(4 / (3 * estimate["photons"].get<double>()))));
  CHECK_FALSE(estimate.contains("bias"));
  CHECK_FALSE(report.contains("standard_error"));  // of a single pass
  CHECK(report["memory_bytes"]["film"] > 0);
  CHECK(report["memory_bytes"]["photon map"] > 0);
}

TEST_CASE("a picture to a target error says how far it came") {
  const TemporaryFolder folder;
  const std::string report = folder / "report.json";
  const Ended run = vitrum_run({"render", default_scene, "-o", folder / "out.png", "--size", "24x24", "--target-error", "0.3",
                                "--report", report});
  CHECK_MESSAGE(run.code == 0, run.err);
  CHECK(run.err.find("relative error ") != std::string::npos);
  const auto json = nlohmann::json::parse(file_bytes(report));
  const auto& rounds = json["rounds"];
  CHECK(rounds["ended_by"] == "target_error");
  CHECK(rounds["target_error"] == 0.3);
  CHECK(rounds["time_limit_s"].is_null());
  CHECK(rounds["relative_error"] <= 0.3);
  CHECK(rounds["interval"][0] <= rounds["relative_error"]);
  CHECK(rounds["interval"][1] >= rounds["relative_error"]);
  CHECK(json["settings"]["samples"] >= 8.0);
  CHECK(json["rays"]["camera"] == std::round(json["settings"]["samples"].get<double>() * 24 * 24));
  CHECK(json["settings"]["photons"]["count"] >= 1024);
}

TEST_CASE("the seed alone decides the picture") {
  const TemporaryFolder folder;
  const auto rendered = [&](const std::string& name, const Words& more) {
    const std::string file = folder / (name + ".exr");
    const Ended run = vitrum_run(Words{"render", default_scene, "-o", file, "--size", "24x24", "--samples", "4",
                                       "--photons", "3000", "--set", "photons.estimate=nearest"} + more);
    REQUIRE_MESSAGE(run.code == 0, run.err);
    return file;
  };
  const std::string first = rendered("first", {"--seed", "1", "--threads", "1"});
  const std::string bytes = file_bytes(first);
  CHECK(file_bytes(rendered("again", {"--seed", "1", "--threads", "1"})) == bytes);
  CHECK(file_bytes(rendered("threads", {"--seed", "1", "--threads", "2"})) == bytes);
  CHECK(file_bytes(rendered("group", {"--seed", "1", "--group-size", "8"})) == bytes);
  const Picture one = read_picture(first, {"test"}), two = read_picture(rendered("other", {"--seed", "2"}), {"test"});
  CHECK(one.pixels != two.pixels);
}

TEST_CASE("info tells what was understood of every model, and from where") {
  const auto info = [](const std::string& model) {
    const Ended run = vitrum_run({"info", models + model + "/scene.toml"});
    CHECK(run.code == 0);
    CHECK(run.err == "");
    return run.out;
  };
  const std::string text = info("default_scene");
  for (const char* part : {"glossy volume", "(illum 12, scene.toml:48)", "index 1.5 (Ni, default_scene.mtl:16)",
                           "absorption 0.667 0.111 0.429 1/m (Kd by 1/rho_d - 1, scene.toml:49)", "3 shapes", "point",
                           "dielectric, absorption", "camera photons photon_sort", "MiB"})
    CHECK_MESSAGE(contains(text, part), text << " lacks " << part);
  CHECK(contains(info("caustic_plate"), "absorption 0 0 0 1/m"));
  const std::string cornell = info("cornell_glass");
  for (const char* part : {"102400 triangles", "114324 triangles", "emissive faces", "tree ", "priority 2"})
    CHECK_MESSAGE(contains(cornell, part), cornell << " lacks " << part);
}

TEST_CASE("help, version and devices go to standard output") {
  const Ended help = vitrum_run({"--help"}), render = vitrum_run({"render", "--help"}), version = vitrum_run({"--version"});
  for (const Ended& run : {help, render, version}) {
    CHECK(run.code == 0);
    CHECK(run.err == "");
  }
  for (const char* command : {"render", "compare", "info", "devices"}) CHECK(contains(help.out, command));
  for (const char* option : {"--output", "--samples", "--photons", "--seed", "--size", "--threads", "--device", "--view",
                             "--set", "--report", "--quiet", "--kernels"})
    CHECK_MESSAGE(contains(render.out, option), option);
  CHECK(contains(version.out, "vitrum "));
  const Ended devices = vitrum_run({"devices"});
  CHECK(devices.code == 0);
  CHECK(contains(devices.out, "can render"));
}
