#include "commands/verify_page.hpp"

#include <algorithm>
#include <cmath>

#include "core/version.hpp"

namespace vitrum {
namespace {

std::string escaped(const std::string& plain) {
  std::string html;
  for (const char c : plain) {
    if (c == '<') html += "&lt;";
    else if (c == '>') html += "&gt;";
    else if (c == '&') html += "&amp;";
    else html += c;
  }
  return html;
}

/// Error against input, with the bound as a line.
std::string plot(const CheckResult& result) {
  constexpr double width = 640, height = 180;
  const auto place = [&](double x) { return result.plots[0].log_input ? std::log2(std::max(x, 0x1p-149)) : x; };
  double low = INFINITY, high = -INFINITY, top = result.bound;
  for (const auto& [x, error] : result.plots[0].lines[0].points) {
    low = std::min(low, place(x));
    high = std::max(high, place(x));
    if (std::isfinite(error)) top = std::max(top, error);
  }
  const auto y = [&](double error) { return height - std::min(error / top, 1.0) * (height - 10); };
  std::string points;
  for (const auto& [x, error] : result.plots[0].lines[0].points)
    points += printed("%.1f,%.1f ", (place(x) - low) / (high - low) * width, y(std::isfinite(error) ? error : top));
  return "<figure><svg viewBox='0 0 640 180' width='640' height='180'>" +
         printed("<line x1='0' x2='640' y1='%.1f' y2='%.1f' stroke='#c33' stroke-dasharray='4'/>", y(result.bound),
              y(result.bound)) +
         "<polyline fill='none' stroke='#246' points='" + points + "'/></svg><figcaption>" + escaped(result.name) +
         printed(": largest error [%s] from 0 to %.3g, dashed: the bound %.3g; %s from %.3g to %.3g%s</figcaption></figure>\n",
              result.unit.c_str(), top, result.bound, result.plots[0].input.c_str(), result.plots[0].lines[0].points.front().first,
              result.plots[0].lines[0].points.back().first, result.plots[0].log_input ? ", logarithmic" : "");
}

}  // namespace

std::string verify_page(const VerifyRun& run) {
  const auto failed = std::count_if(run.results.begin(), run.results.end(), [](const CheckResult& r) { return !r.passed(); });
  std::string page =
      "<!doctype html><html lang='en'><head><meta charset='utf-8'><title>vitrum verify</title><style>"
      "body{font:15px sans-serif;margin:2em;max-width:100em}td,th{padding:.2em .8em;text-align:left;vertical-align:top}"
      "td.n{text-align:right}tr.fail{background:#fcc}svg{background:#f6f6f6}figure{margin:1em 0}</style></head><body>\n"
      "<h1>vitrum verify</h1>\n<p>" +
      escaped("vitrum " + std::string(version()) + ", " + run.device.name + ", " + run.device.platform + ", " +
              run.device.version + ", driver " + run.device.driver +
              (run.other ? ", against " + run.other->name + ", " + run.other->platform + ", driver " + run.other->driver
                         : "")) +
      printed("; %s, %.1f s: %zu checks, %lld failed.</p>\n", run.full ? "full" : "quick", run.seconds, run.results.size(),
           static_cast<long long>(failed)) +
      "<table><tr><th>check<th>cases<th>worst error<th>bound<th>unit<th><th>where the truth comes from<th>worst input</tr>\n";
  for (const CheckResult& r : run.results)
    page += std::string(r.passed() ? "<tr>" : "<tr class='fail'>") + "<td>" + escaped(r.name) +
            printed("<td class='n'>%llu<td class='n'>%.3g<td class='n'>%.3g<td>", static_cast<unsigned long long>(r.cases), r.worst,
                 r.bound) +
            escaped(r.unit) + "<td>" + (r.passed() ? "pass" : "FAIL") + "<td>" + escaped(r.truth) + "<td>" +
            escaped(r.worst_input) + "</tr>\n";
  page += "</table>\n";
  for (const CheckResult& r : run.results)
    if (!r.plots.empty()) page += plot(r);
  return page + "</body></html>\n";
}

}  // namespace vitrum
