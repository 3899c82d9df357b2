#pragma once
// Straight lines through points on logarithmic axes.

#include <cmath>
#include <utility>
#include <vector>

namespace vitrum {

/// The b of y = a x^b that fits best, by least squares of the logarithms. At least two points, all positive.
inline double fitted_exponent(const std::vector<std::pair<double, double>>& points) {
  double x = 0, y = 0, xx = 0, xy = 0;
  for (const auto& point : points) {
    const double u = std::log(point.first), v = std::log(point.second);
    x += u, y += v, xx += u * u, xy += u * v;
  }
  const double n = static_cast<double>(points.size());
  return (n * xy - x * y) / (n * xx - x * x);
}

/// The x at which y first falls to `level`, on the line through the points before and behind on logarithmic axes; NaN if
/// it does not. The points are in the order of x.
inline double first_at_level(const std::vector<std::pair<double, double>>& points, double level) {
  for (size_t k = 1; k < points.size(); ++k) {
    const auto [x0, y0] = points[k - 1];
    const auto [x1, y1] = points[k];
    if (!(y0 >= level && y1 < level)) continue;
    return std::exp(std::log(x0) + (std::log(level) - std::log(y0)) / (std::log(y1) - std::log(y0)) * (std::log(x1) - std::log(x0)));
  }
  return std::nan("");
}

}  // namespace vitrum
