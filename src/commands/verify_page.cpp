#include "commands/verify_page.hpp"

#include <cstdint>

namespace vitrum {
namespace {

/// RFC 4648, section 4.
std::string base64(const std::string& bytes) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t three = 0;
    for (size_t k = 0; k < 3; ++k) three = three << 8 | (i + k < bytes.size() ? static_cast<uint8_t>(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : digits[three >> (18 - 6 * k) & 63];
  }
  return text;
}

}  // namespace

std::string verify_page(const VerifyRun& run) {
  std::string page =
      "<!doctype html><html lang='en'><head><meta charset='utf-8'><title>vitrum verify</title><style>"
      "body{font:15px sans-serif;margin:2em;max-width:100em}td,th{padding:.2em .8em;text-align:left;vertical-align:top}"
      "td.n{text-align:right}tr.fail{background:#fcc}figure{margin:1em 0;max-width:640px}"
      "div.pictures{display:flex;flex-wrap:wrap;gap:1em}</style></head><body>\n"
      "<h1>vitrum verify</h1>\n<p>" +
      escaped(run.made_by()) +
      printed("; %s, %.1f s: %zu checks, %zu failed.</p>\n", run.full ? "full" : "quick", run.seconds, run.results.size(),
              run.failed()) +
      "<table><tr><th>check<th>cases<th>worst error<th>bound<th>unit<th><th>where the truth comes from<th>worst input"
      "<th>kernel</tr>\n";
  for (const CheckResult& r : run.results)
    page += std::string(r.passed() ? "<tr>" : "<tr class='fail'>") + "<td>" + escaped(r.name) +
            printed("<td class='n'>%llu<td class='n'>%.3g<td class='n'>%.3g<td>", static_cast<unsigned long long>(r.cases),
                    r.worst, r.bound) +
            escaped(r.unit) + "<td>" + (r.passed() ? "pass" : "FAIL") + "<td>" + escaped(r.truth) + "<td>" +
            escaped(r.worst_input) + "<td>" + escaped(r.kernel) + "</tr>\n";
  page += "</table>\n";
  std::string pictures;
  for (const CheckResult& r : run.results) {
    for (const Plot& plot : r.plots)
      page += "<figure>" + plot_svg(plot) + "<figcaption>" + escaped(r.name + ": " + plot.title) + "</figcaption></figure>\n";
    for (const CheckPicture& picture : r.pictures)
      pictures += "<figure><img alt='' src='data:image/png;base64," + base64(png_of(picture)) + "'><figcaption>" +
                  escaped(r.name + ": " + picture.caption) + "</figcaption></figure>\n";
  }
  return page + "<div class='pictures'>\n" + pictures + "</div>\n</body></html>\n";
}

}  // namespace vitrum
