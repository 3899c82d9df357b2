#include "core/plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/printed.hpp"

namespace vitrum {
namespace {

constexpr double width = 640, height = 320;
constexpr double left = 74, right = 12, top = 12, bottom = 44;  // margins of the frame
// Told apart also by those who see colours badly, and in print: M. Okabe and K. Ito, "Color universal design" (2008).
constexpr std::array colours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#555555"};

struct Axis {
  bool is_log = false;
  double low = INFINITY, high = -INFINITY;  ///< logarithms where it is logarithmic
  std::vector<double> ticks{};

  bool takes(double value) const { return std::isfinite(value) && (!is_log || value > 0); }
  double place(double value) const { return is_log ? std::log10(value) : value; }
  void include(double value) {
    low = std::min(low, place(value));
    high = std::max(high, place(value));
  }
  double share(double value) const { return (place(value) - low) / (high - low); }

  /// Widens the range to whole steps, and finds the ticks: some 4 to 8 of 1, 2 or 5 times a power of ten, on a
  /// logarithmic axis whole decades.
  void finish() {
    if (!(low <= high)) low = 0, high = 1;  // no points
    if (!is_log) low = std::min(low, 0.0);
    if (high - low < 1e-12 * std::max(std::abs(low), 1.0)) high = low + 1;
    double step = std::pow(10.0, std::floor(std::log10((high - low) / 4)));
    for (const double factor : {1.0, 2.0, 5.0, 10.0})
      if ((high - low) / (step * factor) <= 8) {
        step *= factor;
        break;
      }
    if (is_log) step = std::max(std::round(step), 1.0);
    low = step * std::floor(low / step + 1e-9);
    high = step * std::ceil(high / step - 1e-9);
    for (double tick = low; tick <= high + 0.5 * step; tick += step)
      ticks.push_back(std::abs(tick) < 1e-9 * step ? 0.0 : tick);
  }
  std::string label(double tick) const {
    if (!is_log) return printed("%g", tick);
    return tick >= -2 && tick <= 3 ? printed("%g", std::pow(10.0, tick)) : printed("1e%d", static_cast<int>(tick));
  }
};

std::string text(double x, double y, const char* anchor, const std::string& what, const char* more = "") {
  return printed("<text x='%.1f' y='%.1f' text-anchor='%s'%s>", x, y, anchor, more) + escaped(what) + "</text>\n";
}

}  // namespace

std::string escaped(const std::string& plain) {
  std::string safe;
  for (const char c : plain) {
    if (c == '<') safe += "&lt;";
    else if (c == '>') safe += "&gt;";
    else if (c == '&') safe += "&amp;";
    else safe += c;
  }
  return safe;
}

std::string plot_svg(const Plot& plot) {
  Axis x{plot.log_x}, y{plot.log_y};
  const auto shown = [&](const std::pair<double, double>& point) { return x.takes(point.first) && y.takes(point.second); };
  for (const PlotLine& line : plot.lines)
    for (const auto& point : line.points)
      if (shown(point)) {
        x.include(point.first);
        y.include(point.second);
      }
  if (plot.bound > 0) y.include(plot.bound);
  x.finish();
  y.finish();
  const auto across = [&](double share) { return left + share * (width - left - right); };
  const auto down = [&](double share) { return height - bottom - share * (height - top - bottom); };

  std::string svg = printed("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 %g %g' width='%g' height='%g' "
                            "font-family='sans-serif' font-size='12'>\n<rect width='%g' height='%g' fill='#fff'/>\n",
                            width, height, width, height, width, height);
  for (const double tick : x.ticks) {
    const double at = across((tick - x.low) / (x.high - x.low));
    svg += printed("<path d='M%.1f %.1fV%.1f' stroke='#ddd'/>\n", at, top, height - bottom);
    svg += text(at, height - bottom + 16, "middle", x.label(tick));
  }
  for (const double tick : y.ticks) {
    const double at = down((tick - y.low) / (y.high - y.low));
    svg += printed("<path d='M%.1f %.1fH%.1f' stroke='#ddd'/>\n", left, at, width - right);
    svg += text(left - 6, at + 4, "end", y.label(tick));
  }
  svg += printed("<path d='M%.1f %.1fV%.1fH%.1f' fill='none' stroke='#333'/>\n", left, top, height - bottom, width - right);
  svg += text(across(0.5), height - 8, "middle", plot.x);
  svg += text(0, 0, "middle", plot.y, printed(" transform='translate(14 %.1f) rotate(-90)'", down(0.5)).c_str());

  // Legend: a row for each line in the upper corner that has fewer points.
  double points_left = 0, points_right = 0;
  for (const PlotLine& line : plot.lines)
    for (const auto& point : line.points)
      if (shown(point) && y.share(point.second) > 0.6) (x.share(point.first) < 0.5 ? points_left : points_right) += 1;
  const double legend = points_left < points_right ? left + 12 : across(0.58);
  double row = top + 16;
  const auto named = [&](const std::string& name, const std::string& stroke) {
    svg += printed("<path d='M%.1f %.1fh22' ", legend, row - 4) + stroke + "/>\n" + text(legend + 28, row, "start", name);
    row += 16;
  };
  if (plot.bound > 0) {
    const std::string stroke = "stroke='#c00' stroke-dasharray='5 4'";
    svg += printed("<path d='M%.1f %.1fH%.1f' ", left, down(y.share(plot.bound)), width - right) + stroke + "/>\n";
    named(printed("bound %.3g", plot.bound), stroke);
  }
  // The first line comes last, on top of the others.
  for (size_t k = plot.lines.size(); k-- > 0;) {
    const std::string stroke = printed("stroke='%s' stroke-width='%s'", colours[std::min(k, colours.size() - 1)], k == 0 ? "2.5" : "1.5");
    std::string points;
    for (const auto& point : plot.lines[k].points)
      if (shown(point)) points += printed("%.1f,%.1f ", across(x.share(point.first)), down(y.share(point.second)));
    svg += "<polyline fill='none' " + stroke + " points='" + points + "'/>\n";
  }
  for (size_t k = 0; k < plot.lines.size(); ++k)
    named(plot.lines[k].name, printed("stroke='%s' stroke-width='%s'", colours[std::min(k, colours.size() - 1)], k == 0 ? "2.5" : "1.5"));
  return svg + "</svg>\n";
}

}  // namespace vitrum
