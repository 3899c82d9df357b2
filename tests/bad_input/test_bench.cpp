// `vitrum bench`: runs at a small size and writes what it found, refuses what it does not know.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "command_line.hpp"
#include "film/images.hpp"

using namespace vitrum;

namespace {

/// What `vitrum bench NAME --quick` reports.
nlohmann::json quick_report(const std::string& name, const Words& more = {}) {
  const TemporaryFolder folder;
  const std::string json = folder / "report.json";
  const Ended run = vitrum_run(Words{"bench", name, "--quick", "--threads", "2", "--report", json} + more);
  REQUIRE_MESSAGE(run.code == 0, run.err);
  const auto report = nlohmann::json::parse(file_bytes(json));
  CHECK(report["benchmark"] == name);
  CHECK(report["threads"] == 2);
  CHECK(report.contains("commit"));
  CHECK(report["device"]["driver"] != "");
  return report;
}

}  // namespace

TEST_CASE("benchmarks of errors write their figures and a plot") {
  const TemporaryFolder folder;
  for (const std::string name : {"photons", "camera"}) {
    CAPTURE(name);
    const std::string svg = folder / (name + ".svg"), exr = folder / (name + ".exr");
    const auto report = quick_report(name, {"--plot", svg, "--truth", exr});
    CHECK(report["rows"].size() >= 2);
    for (const auto& row : report["rows"]) {
      CHECK(row["CPU s"] > 0.0);
      CHECK(row["error"] > 0.0);
    }
    CHECK(contains(report["findings"].dump(), "error ~ "));
    CHECK(contains(file_bytes(svg), "relative RMSE"));
    const Picture truth = read_picture(exr, {"test"});
    CHECK(truth.width == (name == "photons" ? 128 : 32));
    CHECK(truth.pixels[truth.pixels.size() / 2 + static_cast<size_t>(truth.width) / 2].x > 0.0f);
  }
}

TEST_CASE("rays go as fast as the figures say, and meet what they meet in Embree") {
  const TemporaryFolder folder;
  const auto report = quick_report("traversal", {"--plot", folder / "a.svg"});
  REQUIRE(report["rows"].size() == 4);
  const char* const kinds[] = {"primary", "diffuse", "shadow", "photon"};
  for (size_t k = 0; k < 4; ++k) {
    const auto& row = report["rows"][k];
    CAPTURE(row.dump());
    CHECK(row["what"] == kinds[k]);
    CHECK(row["triangles"] == 4096);
    CHECK(row["rays"] > 3000);
    CHECK(row["M rays/CPU s"] > 0.0);
    CHECK(row["Embree's"] > 0.0);
    CHECK(row["times as fast"] > 0.0);
    // Rays that pass an edge within rounding.
    CHECK(row["differ"] <= 4);
    // Corners and their indices alone take 18 bytes a triangle.
    CHECK(row["B/triangle"] > 18.0);
    CHECK(row["Embree's B"] > 18.0);
  }
  CHECK(contains(report["findings"].dump(), "RTC_SCENE_FLAG_ROBUST"));
  CHECK(contains(report["findings"].dump(), "built for SSE2"));
  CHECK(contains(file_bytes(folder / "a.svg"), "times as fast as Embree"));
}

TEST_CASE("gathered irradiance is what nanoflann's photons give") {
  const TemporaryFolder folder;
  const auto report = quick_report("gather", {"--plot", folder / "a.svg"});
  REQUIRE(report["rows"].size() == 4);
  for (const auto& row : report["rows"]) {
    CAPTURE(row.dump());
    CHECK(row["photons"] == 20000);
    CHECK(row["a query"] == doctest::Approx(50).epsilon(0.1));
    CHECK(row["M queries/CPU s"] > 0.0);
    CHECK(row["nanoflann's"] > 0.0);
    CHECK(row["times as fast"] > 0.0);
    CHECK(row["difference"] < 1e-5);  // sums of 50 floats in another order
  }
  CHECK(contains(report["findings"].dump(), "nanoflann 1."));
  CHECK(contains(file_bytes(folder / "a.svg"), "times as fast as nanoflann"));
}

TEST_CASE("what a photon costs is told by their number and by the threads") {
  const TemporaryFolder folder;
  const auto report = quick_report("scaling", {"--plot", folder / "a.svg"});
  REQUIRE(report["rows"].size() == 4);  // one pass and ten; one thread and two
  for (size_t k = 0; k < 4; ++k) {
    const auto& row = report["rows"][k];
    CAPTURE(row.dump());
    CHECK(row["what"] == (k < 2 ? "passes" : "threads"));
    CHECK(row[k < 2 ? "passes" : "threads"] == (k < 2 ? (k == 0 ? 1 : 10) : k - 1));
    CHECK(row["photons"].get<double>() * row["ns a photon"].get<double>() ==
          doctest::Approx(1e9 * row["photon CPU s"].get<double>()).epsilon(1e-5));
    CHECK(row[k < 2 ? "process MB" : "times that of one"] > 0.0);
  }
  CHECK(contains(report["findings"].dump(), "M photons/s on 2 threads"));
  CHECK(contains(file_bytes(folder / "a.svg"), "processor time a photon"));
}

TEST_CASE("what a device can do at best is arithmetic and memory") {
  const auto report = quick_report("limits");
  REQUIRE(report["rows"].size() == 6);
  CHECK(report["rows"][0]["what"] == "multiply and add");
  for (const auto& row : report["rows"]) CHECK(row["by CPU s of a thread"] > 0.0);
  CHECK(report["rows"][1]["all threads"] == doctest::Approx(2.0 * report["rows"][1]["by CPU s of a thread"].get<double>()).epsilon(1e-5));
}

TEST_CASE("a cold cache makes the start longer, a scene of one's own may be started with") {
  const auto report = quick_report("startup");
  REQUIRE(report["rows"].size() == 2);
  CHECK(report["rows"][0]["what"] == "warm");
  CHECK(report["rows"][1]["what"] == "cold");
  for (const auto& row : report["rows"]) {
    CHECK(row["first pixel s"] > 0.0);
    CHECK(row["process s"] > row["first pixel s"]);
    CHECK(row["CPU s"] > 0.0);
  }
  // Compiling takes many times what all the rest does.
  CHECK(report["rows"][1]["CPU s"] > 2.0 * report["rows"][0]["CPU s"].get<double>());
  const TemporaryFolder folder;
  put_file(folder / "a.toml", "vitrum = 1\ncamera = { eye = [0, 0, 5], look_at = [0, 0, 0] }\nmaterial.gray = { illum = 1 }\n"
                              "shape.ball = { type = \"sphere\", centre = [0, 0, 0], radius = 1, material = \"gray\" }\n");
  CHECK(quick_report("startup", {folder / "a.toml"})["rows"].size() == 2);
}

TEST_CASE("more photons make the exact ball's caustic better, and the figures say so") {
  const auto rows = quick_report("photons")["rows"];
  CHECK(rows[0]["what"] == "exact ball");
  CHECK(rows[0]["photons"] < rows[1]["photons"]);
  CHECK(rows[1]["error"] < rows[0]["error"]);
}

TEST_CASE("bench refuses what it does not know") {
  check_refused({"bench", "photon"}, "bench photon", "there is no such benchmark", "did you mean 'photons'?");
  check_refused({"bench", "photons", "/nowhere.toml"}, "/nowhere.toml", "there is no such scene file", "check the path");
  check_refused({"bench", "gather", "a.toml"}, "a.toml", "the benchmark gather takes no scene", "leave it out");
  check_refused({"bench", "startup", "--plot", "a.svg"}, "--plot a.svg", "the benchmark startup has no plot", "leave it out");
  CHECK(vitrum_run({"bench"}).code == 2);
}
