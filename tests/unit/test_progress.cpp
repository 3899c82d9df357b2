#include <doctest/doctest.h>

#include "core/progress.hpp"

using namespace vitrum;

TEST_CASE("durations are rounded up to the unit that matters") {
  CHECK(duration_text(0) == "0 s");
  CHECK(duration_text(0.2) == "1 s");
  CHECK(duration_text(59) == "59 s");
  CHECK(duration_text(59.5) == "1 min");
  CHECK(duration_text(80) == "1 min 20 s");
  CHECK(duration_text(3599.5) == "1 h");
  CHECK(duration_text(2 * 3600 + 4 * 60 + 1) == "2 h 5 min");
  CHECK(duration_text(24 * 3600 - 1) == "1 d");
  CHECK(duration_text(76 * 3600) == "3 d 4 h");
  CHECK(duration_text(1e300) == duration_text(1e9));
}

TEST_CASE("the rest of the work is thought to go on as it began") {
  CHECK(progress_text("camera", 0.25, 10) == "camera  25 %, 30 s left");
  CHECK(progress_text("camera", 0.5, 60) == "camera  50 %, 1 min left");
  CHECK(progress_text("photons", 1, 60) == "photons  100 %, 0 s left");
  CHECK(progress_text("photons", 0.999, 1) == "photons  99 %, 1 s left");
}

TEST_CASE("there is no estimate from next to nothing") {
  CHECK(progress_text("camera", 0, 0) == "camera  0 %");
  CHECK(progress_text("camera", 0.01, 10) == "camera  1 %");
  CHECK(progress_text("camera", 0.5, 0.1) == "camera  50 %");
}
