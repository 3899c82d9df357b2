#pragma once
// Estimates by chance: is their mean over randomised replicates the truth?

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/fit.hpp"
#include "film/statistics.hpp"
#include "verify/check.hpp"

namespace vitrum {

/// Several estimates, each by the same number of replicates and with its truth, that are tested together.
class Estimates {
 public:
  /// How often a row alarms although nothing is wrong, over all its estimates.
  static constexpr double false_alarm = 1e-4;

  /// `values`: one of each replicate, at least 2. `rounding`: by how much floats may take the mean off the truth.
  void add(const std::vector<double>& values, double truth, double rounding, const std::string& what) {
    replicates_ = values.size();
    const double n = static_cast<double>(replicates_);
    double sum = 0.0, squares = 0.0;
    for (const double value : values) sum += value;
    const double mean = sum / n;
    for (const double value : values) squares += (value - mean) * (value - mean);
    const double error = std::sqrt(squares / (n - 1) / n);
    const double beyond = std::max(std::abs(mean - truth) - rounding, std::isnan(mean) ? NAN : 0.0);
    const double t = beyond == 0.0 ? 0.0 : beyond / error;
    if (!(t <= worst_.error)) where_ = what + printed(": found %.9g +- %.1e, truth %.9g", mean, error, truth);
    worst_.add(t, worst_.cases);
    largest_error_ = std::max(largest_error_, std::isnan(error) ? std::numeric_limits<double>::infinity() : error);
  }

  /// A row of significance: Student's test of each estimate with Sidak's correction. And a row `NAME: error`, which
  /// shows how small a fault the test could see: the largest standard error, up to `error_bound` in `error_unit`.
  void rows(const std::string& name, const char* truth, double error_bound, const char* error_unit,
            const char* error_truth, std::vector<CheckResult>& rows) const {
    rows.push_back({name, worst_.cases, worst_.error,
                    student_limit(sidak_level(false_alarm, worst_.cases), static_cast<double>(replicates_ - 1)),
                    "standard errors", truth, where_});
    rows.push_back({name + ": error", worst_.cases, largest_error_, error_bound, error_unit, error_truth, ""});
  }

 private:
  Worst worst_;
  std::string where_;
  double largest_error_ = 0.0;
  size_t replicates_ = 0;
};

}  // namespace vitrum
