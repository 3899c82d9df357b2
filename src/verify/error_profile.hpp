#pragma once
// The largest error by the binade of an input: the lines of plots.

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/plot.hpp"

namespace vitrum {

class ErrorProfile {
 public:
  /// Inputs from 2^least to 2^most; those outside belong to the nearest binade, and 0 to the lowest.
  ErrorProfile(int least, int most)
      : least_(least), errors_(static_cast<size_t>(most - least + 1), std::numeric_limits<double>::quiet_NaN()) {}

  /// An error that is no number counts as infinite; a plot leaves both out.
  void add(double input, double error) {
    if (std::isnan(input)) return;
    const int binade = input > 0 ? static_cast<int>(std::clamp(std::ilogb(input), least_, most())) : least_;
    double& worst = errors_[static_cast<size_t>(binade - least_)];
    if (std::isnan(error)) error = std::numeric_limits<double>::infinity();
    worst = std::isnan(worst) ? error : std::max(worst, error);
  }
  void merge(const ErrorProfile& other) {
    for (size_t k = 0; k < errors_.size(); ++k) add(std::ldexp(1.0, least_ + static_cast<int>(k)), other.errors_[k], other.has(k));
  }

  /// Binades without an input are left out. `floor` stands for smaller errors, 0 among them, which a logarithmic axis
  /// could not show.
  PlotLine line(const std::string& name, double floor) const {
    PlotLine line{name, {}};
    for (size_t k = 0; k < errors_.size(); ++k)
      if (has(k)) line.points.emplace_back(std::ldexp(1.0, least_ + static_cast<int>(k)), std::max(errors_[k], floor));
    return line;
  }

 private:
  int most() const { return least_ + static_cast<int>(errors_.size()) - 1; }
  bool has(size_t k) const { return !std::isnan(errors_[k]); }
  void add(double input, double error, bool is_there) {
    if (is_there) add(input, error);
  }

  int least_;
  std::vector<double> errors_;  ///< NaN where there was no input
};

}  // namespace vitrum
