#pragma once
// Plots of numbers against numbers, as SVG. Pure functions.

#include <string>
#include <utility>
#include <vector>

namespace vitrum {

/// A line of a plot. Points whose numbers are not finite, or not above 0 on a logarithmic axis, are left out.
struct PlotLine {
  std::string name;
  std::vector<std::pair<double, double>> points;  ///< x, y; in the order of x
};

struct Plot {
  std::string title;
  std::string x, y;             ///< what the axes show, with units
  std::vector<PlotLine> lines;  ///< the first is drawn boldest; at most 6 have colours of their own
  bool log_x = false, log_y = false;
  double bound = 0.0;           ///< drawn dashed, with its name in the legend, where it is above 0
};

/// What can stand in text of XML and HTML for `plain`.
std::string escaped(const std::string& plain);

/// The plot as an SVG element of 640 x 320 pixels, with axes, grid and legend, but without the title. Can be put into a
/// page as it is, and stand in a file by itself.
std::string plot_svg(const Plot& plot);

}  // namespace vitrum
