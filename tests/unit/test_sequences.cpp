// The numbers that photons and pixels start from: each seed, replicate, pair of light and caster, and dimension has its
// own, and a sequence goes on where it was left.
#include <doctest/doctest.h>

#include <set>

#include "render/sequences.hpp"

using namespace vitrum;

namespace {

struct Run {
  uint64_t seed = 0;
  uint32_t replicate = 0, pair = 0;
  uint64_t first = 0;
};

auto sequences(const Run& run, Sampling sampling = Sampling::low_discrepancy, bool area_light = true) {
  return photon_sequences(sampling, run.seed, run.replicate, run.pair, run.first, area_light);
}

}  // namespace

TEST_CASE("photon sequences differ by seed, replicate, pair and dimension") {
  for (const Sampling sampling : {Sampling::low_discrepancy, Sampling::independent}) {
    std::set<uint64_t> starts;
    size_t count = 0;
    for (const Run& run : {Run{}, Run{1, 0, 0}, Run{0, 1, 0}, Run{0, 0, 1}, Run{1, 1, 0}, Run{0, 1, 1}})
      for (const kernel::SequenceData& data : sequences(run, sampling)) {
        starts.insert(data.start);
        ++count;
      }
    CHECK(starts.size() == count);
  }
}

TEST_CASE("no two dimensions of a photon go in step") {
  for (const bool area_light : {false, true}) {
    const auto dimensions = sequences({}, Sampling::low_discrepancy, area_light);
    const size_t used = area_light ? 6 : 3;
    std::set<uint64_t> alphas;
    for (size_t d = 0; d < used; ++d) alphas.insert(dimensions[d].alpha);
    CHECK(alphas.size() == used);
    CHECK(!alphas.contains(0));
  }
}

TEST_CASE("a photon sequence goes on where it was left") {
  const auto whole = sequences({5, 2, 1, 0}), rest = sequences({5, 2, 1, 123'456'789'012});
  for (size_t d = 0; d < whole.size(); ++d) {
    CHECK(rest[d].alpha == whole[d].alpha);
    CHECK(rest[d].start == whole[d].start + 123'456'789'012 * whole[d].alpha);
  }
  // Independent ones cannot go on, but must not begin again.
  const auto before = sequences({5, 2, 1, 0}, Sampling::independent);
  const auto after = sequences({5, 2, 1, 65536}, Sampling::independent);
  for (size_t d = 0; d < before.size(); ++d) CHECK(before[d].start != after[d].start);
}

TEST_CASE("points of pixels fill the square evenly in both coordinates together") {
  // Of 1024 points of R2 each of 16 x 16 squares has about 4; coordinates that go in step leave most empty.
  int in_square[16][16] = {}, in_part[16] = {};
  for (uint64_t i = 0; i < 1024; ++i) {
    const std::array<float, 2> point = r2_point(i);
    ++in_square[static_cast<int>(point[0] * 16)][static_cast<int>(point[1] * 16)];
    ++in_part[static_cast<int>(golden_point(i) * 16)];
  }
  for (const auto& row : in_square)
    for (const int n : row) {
      CHECK(n >= 2);
      CHECK(n <= 6);
    }
  for (const int n : in_part) {
    CHECK(n >= 63);
    CHECK(n <= 65);
  }
}
