#include "film/mean_square.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "film/statistics.hpp"

namespace vitrum {

double MeanSquare::deviation() const { return value * std::sqrt(2.0 / estimate_degrees); }

MeanSquare::Interval MeanSquare::interval(double share) const {
  const double tail = 0.5 * (1.0 - share);
  return {value / fisher_limit(tail, estimate_degrees, degrees), value * fisher_limit(tail, degrees, estimate_degrees)};
}

MeanSquare mean_square_error(const std::vector<std::vector<double>>& replicates) {
  const size_t count = replicates.size(), values = replicates.front().size();
  assert(count >= 3 && values >= 1);
  // Products of what each replicate is off the mean of all.
  std::vector<double> products(count * count, 0.0), off(count);
  for (size_t i = 0; i < values; ++i) {
    double mean = 0.0;
    for (const std::vector<double>& replicate : replicates) mean += replicate[i] / static_cast<double>(count);
    for (size_t r = 0; r < count; ++r) off[r] = replicates[r][i] - mean;
    for (size_t r = 0; r < count; ++r)
      for (size_t s = 0; s <= r; ++s) products[r * count + s] += off[r] * off[s];
  }
  const double n = static_cast<double>(count) - 1.0;
  double trace = 0.0, squares = 0.0;
  for (size_t r = 0; r < count; ++r) {
    trace += products[r * count + r] / n;
    for (size_t s = 0; s <= r; ++s) {
      const double product = products[r * count + s] / n;
      squares += (s < r ? 2.0 : 1.0) * product * product;
    }
  }
  MeanSquare result;
  result.value = trace / (static_cast<double>(count) * static_cast<double>(values));
  // Few products tell it: twice as much, so that intervals are rather too wide.
  const double trace_of_square = 2.0 * n * n / ((n - 1.0) * (n + 2.0)) * (squares - trace * trace / n);
  // No more than there are values, no fewer than 1: the estimate may be anything where it is noise.
  const double most = static_cast<double>(values);
  result.degrees = trace * trace < most * trace_of_square ? std::max(trace * trace / trace_of_square, 1.0) : most;
  result.estimate_degrees = n * result.degrees;
  return result;
}

}  // namespace vitrum
