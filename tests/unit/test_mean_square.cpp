// The error of a picture by its replicates, and the bias by pictures of several areas.

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "film/bias_fit.hpp"
#include "film/mean_square.hpp"

using namespace vitrum;

namespace {

/// Replicates of a picture of nothing, whose values share `common` of their variance in groups of `group`.
std::vector<std::vector<double>> replicates_of_noise(std::mt19937& bits, size_t count, size_t values, size_t group, double common) {
  std::normal_distribution<double> normal;
  std::vector<std::vector<double>> replicates(count);
  for (std::vector<double>& replicate : replicates) {
    double shared = 0.0;
    for (size_t i = 0; i < values; ++i) {
      if (i % group == 0) shared = normal(bits);
      replicate.push_back(std::sqrt(common) * shared + std::sqrt(1.0 - common) * normal(bits));
    }
  }
  return replicates;
}

double mean_square(const std::vector<std::vector<double>>& replicates) {
  double sum = 0.0;
  for (size_t i = 0; i < replicates.front().size(); ++i) {
    double mean = 0.0;
    for (const std::vector<double>& replicate : replicates) mean += replicate[i] / static_cast<double>(replicates.size());
    sum += mean * mean / static_cast<double>(replicates.front().size());
  }
  return sum;
}

}  // namespace

TEST_CASE("the mean squared error of a picture lies in its interval as often as that says, whatever its pixels share") {
  std::mt19937 bits(1);
  for (const auto& [group, common] : {std::pair{size_t{1}, 0.0}, std::pair{size_t{50}, 0.9}, std::pair{size_t{400}, 1.0}}) {
    CAPTURE(group);
    const int tries = 400;
    int within = 0;
    double estimate = 0.0, truth = 0.0;
    for (int i = 0; i < tries; ++i) {
      const auto replicates = replicates_of_noise(bits, 4, 400, group, common);
      const MeanSquare error = mean_square_error(replicates);
      const double square = mean_square(replicates);
      const MeanSquare::Interval interval = error.interval(0.95);
      within += interval.low <= square && square <= interval.high;
      estimate += error.value / tries;
      truth += square / tries;
      CHECK(error.estimate_degrees == 3 * error.degrees);
    }
    MESSAGE("within " << within << " of " << tries << ", estimate " << estimate << ", truth " << truth);
    // 380 are claimed, with a standard deviation of 4.4.
    CHECK(within >= 370);
    CHECK(within <= 399);
    CHECK(std::abs(estimate / 0.25 - 1.0) < (group == 1 ? 0.01 : 0.15));
  }
}

TEST_CASE("the bias of pictures by the area of their estimates") {
  for (const double exponent : {0.4, 0.65, 0.9}) {
    CAPTURE(exponent);
    const auto bias = [exponent](double area) { return 0.3 * std::pow(area, exponent); };
    std::vector<BiasStep> steps;
    const double areas[] = {1.0, 0.4, 0.15, 0.05};
    for (int a = 0; a < 4; ++a)
      for (int b = a + 1; b < 4; ++b)
        steps.push_back({areas[a], areas[b], std::pow(bias(areas[a]) - bias(areas[b]), 2.0), 1e-6});
    const double weights[] = {1.0, 9.0};
    const SquaredBias last = fit_bias(steps, std::vector{0.05}, std::vector{1.0});
    CHECK(last.low <= std::pow(bias(0.05), 2.0));
    CHECK(last.high >= std::pow(bias(0.05), 2.0));
    CHECK(std::abs(std::sqrt(last.value) / bias(0.05) - 1.0) < 0.35);
    const SquaredBias both = fit_bias(steps, std::span(areas).subspan(2), weights);
    const double mean = 0.1 * bias(0.15) + 0.9 * bias(0.05);
    CHECK(both.low <= mean * mean);
    CHECK(both.high >= mean * mean);
  }
  // Noise alone: no more than it hides, on average over what is not negative.
  const SquaredBias none = fit_bias(std::vector<BiasStep>{{1.0, 0.5, -1e-5, 1e-4}}, std::vector{0.5}, std::vector{1.0});
  double sum = 0.0, all = 0.0;
  for (double square = 0.5e-7; square < 1e-3; square += 1e-7) {
    const double density = std::exp(-0.5 * std::pow((square + 1e-5) / 1e-4, 2.0));
    sum += density * square;
    all += density;
  }
  const double at_half = std::pow(std::pow(0.5, 0.65) / (1.0 - std::pow(0.5, 0.65)), 2.0);
  CHECK(std::abs(none.value / (at_half * sum / all) - 1.0) < 1e-4);
  CHECK(none.low == 0.0);
  CHECK(none.high > 1e-4);
}
