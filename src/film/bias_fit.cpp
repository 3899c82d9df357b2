#include "film/bias_fit.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace vitrum {
namespace {

constexpr double least_exponent = 0.25, most_exponent = 1.0, exponent_step = 0.05;
constexpr double usual_exponent = 0.65, exponent_deviation = 0.2;
constexpr double model_deviation = 0.1;  // of a squared difference: one exponent for a whole picture is a rough law

/// Mean of a value that is not negative, of which `found` is known with a normal deviation: what is not known counts.
double mean_if_positive(double found, double deviation) {
  const double z = std::max(found / deviation, -5.0);
  const double density = std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi), share = 0.5 * std::erfc(-z / std::numbers::sqrt2);
  return deviation * (z + density / share);
}

/// With a given exponent.
struct Fit {
  double exponent = 0.0;
  double misfit = 0.0;          // sum of squares over variances, with that of the exponent
  SquaredBias bias;
};

Fit fit_with(double exponent, std::span<const BiasStep> steps, std::span<const double> areas,
             std::span<const double> weights) {
  // square = first * (a^c - b^c)^2 + noise, by weighted least squares.
  double products = 0.0, norms = 0.0;
  const auto change = [exponent](const BiasStep& step) {
    const double difference = std::pow(step.area_a, exponent) - std::pow(step.area_b, exponent);
    return difference * difference;
  };
  const auto variance = [](const BiasStep& step) {
    return step.deviation * step.deviation + std::pow(model_deviation * step.square, 2.0);
  };
  for (const BiasStep& step : steps) {
    products += step.square * change(step) / variance(step);
    norms += change(step) * change(step) / variance(step);
  }
  const double found = products / norms, first = std::max(found, 0.0), deviation = 1.0 / std::sqrt(norms);
  Fit fit;
  fit.exponent = exponent;
  fit.misfit = std::pow((exponent - usual_exponent) / exponent_deviation, 2.0);
  for (const BiasStep& step : steps) fit.misfit += std::pow(step.square - first * change(step), 2.0) / variance(step);
  double all = 0.0, sum = 0.0;
  for (size_t i = 0; i < areas.size(); ++i) {
    sum += weights[i] * std::pow(areas[i], exponent);
    all += weights[i];
  }
  const double share = sum / all * (sum / all);
  fit.bias = {share * mean_if_positive(found, deviation), share * std::max(first - 2.0 * deviation, 0.0), share * (first + 2.0 * deviation), exponent};
  return fit;
}

}  // namespace

SquaredBias fit_bias(std::span<const BiasStep> steps, std::span<const double> areas, std::span<const double> weights) {
  assert(!steps.empty() && areas.size() == weights.size() && !areas.empty());
  std::vector<Fit> fits;
  for (double c = least_exponent; c < most_exponent + 0.5 * exponent_step; c += exponent_step)
    fits.push_back(fit_with(c, steps, areas, weights));
  const Fit& best = *std::min_element(fits.begin(), fits.end(), [](const Fit& a, const Fit& b) { return a.misfit < b.misfit; });
  SquaredBias bias = best.bias;
  for (const Fit& fit : fits)
    if (fit.misfit <= best.misfit + 4.0) {
      bias.low = std::min(bias.low, fit.bias.low);
      bias.high = std::max(bias.high, fit.bias.high);
    }
  return bias;
}

}  // namespace vitrum
