// `vitrum bench`: runs at a small size and writes what it found, refuses what it does not know.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "command_line.hpp"
#include "film/images.hpp"

using namespace vitrum;

TEST_CASE("each benchmark runs and writes its figures and a plot") {
  const TemporaryFolder folder;
  for (const std::string name : {"photons", "camera"}) {
    CAPTURE(name);
    const std::string json = folder / (name + ".json"), svg = folder / (name + ".svg"), exr = folder / (name + ".exr");
    const Ended run =
        vitrum_run({"bench", name, "--quick", "--threads", "2", "--report", json, "--plot", svg, "--truth", exr});
    REQUIRE_MESSAGE(run.code == 0, run.err);
    const auto report = nlohmann::json::parse(file_bytes(json));
    CHECK(report["benchmark"] == name);
    CHECK(report["threads"] == 2);
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

TEST_CASE("more photons make the exact ball's caustic better, and the figures say so") {
  const TemporaryFolder folder;
  const std::string json = folder / "b.json";
  REQUIRE(vitrum_run({"bench", "photons", "--quick", "--report", json}).code == 0);
  const auto rows = nlohmann::json::parse(file_bytes(json))["rows"];
  CHECK(rows[0]["what"] == "exact ball");
  CHECK(rows[0]["photons"] < rows[1]["photons"]);
  CHECK(rows[1]["error"] < rows[0]["error"]);
}

TEST_CASE("bench refuses what it does not know") {
  check_refused({"bench", "photon"}, "bench photon", "there is no such benchmark", "did you mean 'photons'?");
  check_refused({"bench", "photons", "/nowhere.toml"}, "/nowhere.toml", "there is no such scene file", "check the path");
  CHECK(vitrum_run({"bench"}).code == 2);
}
