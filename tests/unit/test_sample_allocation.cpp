// Where samples go.

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

#include "render/camera_pass.hpp"
#include "render/sample_allocation.hpp"

using namespace vitrum;

TEST_CASE("samples go to pixels by the root of their variance, and none is left out") {
  constexpr int width = 64, height = 48;
  std::vector<double> variance(width * height, 1.0);
  for (int y = 0; y < height; ++y)
    for (int x = 32; x < width; ++x) variance[static_cast<size_t>(y * width + x)] = x < 48 ? 16.0 : 0.0;
  for (const double mean : {1.0, 6.0, 40.0}) {
    CAPTURE(mean);
    const std::vector<uint32_t> samples = allot_samples(variance, width, mean);
    const double total = std::accumulate(samples.begin(), samples.end(), 0.0);
    // Three kinds of pixels in powers of two: no closer.
    CHECK(total / (width * height) <= std::max(mean, 1.0));
    CHECK(total / (width * height) > 0.5 * mean);
    for (const uint32_t n : samples) {
      CHECK(n >= 1);
      CHECK((n & (n - 1)) == 0);
    }
    const size_t row = 20 * width;
    CHECK(samples[row + 40] >= samples[row + 10]);
    CHECK(samples[row + 10] >= samples[row + 60]);
    if (mean >= 6.0) CHECK(samples[row + 40] == 4 * samples[row + 10]);
  }
  // Before anything is known, all alike.
  for (const uint32_t n : allot_samples(std::vector<double>(width * height, 0.0), width, 4.0)) CHECK(n == 4);
}

TEST_CASE("slots keep every pixel once, those with the most samples first") {
  const std::vector<uint32_t> wanted = [] {
    std::vector<uint32_t> n(100, 1);
    for (size_t i = 0; i < n.size(); i += 7) n[i] = 8;
    return n;
  }();
  const SampleCounts counts = SampleCounts::of(wanted);
  std::vector<int> seen(wanted.size(), 0);
  uint64_t total = 0;
  for (size_t slot = 0; slot < wanted.size(); ++slot) {
    const uint32_t pixel = counts.pixel_of_slot[slot];
    ++seen[pixel];
    CHECK(counts.in_slot(slot) >= wanted[pixel]);
    if (slot > 0) CHECK(counts.in_slot(slot) <= counts.in_slot(slot - 1));
    total += counts.in_slot(slot);
  }
  for (const int n : seen) CHECK(n == 1);
  CHECK(counts.total() == total);
  CHECK(counts.most() == 8);
}

TEST_CASE("what is spent grows where it gains most") {
  // Camera rays leave four times the error at the same cost: twice as much for them.
  const Spending spent{100.0, 100.0, 1.0, 4.0};
  const Growth growth = best_growth(spent, 3.0);
  CHECK(std::abs(growth.photons - 2.0) < 1e-12);
  CHECK(std::abs(growth.samples - 4.0) < 1e-12);
  const auto error = [&](const Growth& g) { return spent.photon_error / g.photons + spent.camera_error / g.samples; };
  for (const double photons : {1.5, 1.9, 2.1, 3.0}) {
    const Growth other{photons, 6.0 - photons};
    if (other.samples <= 4.0) CHECK(error(other) >= error(growth));
  }
  // No photons; and no error at all.
  CHECK(best_growth({0.0, 10.0, 0.0, 1.0}, 2.0).samples == 2.0);
  CHECK(best_growth({10.0, 10.0, 0.0, 0.0}, 2.0).photons == 2.0);
  CHECK(best_growth({10.0, 10.0, 0.0, 1.0}, 2.0).photons == 0.5);
}
