#include "commands/verify_document.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

namespace vitrum {
namespace {

std::string count_text(uint64_t count) {
  std::string digits = printed("%llu", static_cast<unsigned long long>(count));
  for (size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, ",");
  return digits;
}

/// In a cell of a table.
std::string cell(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += c == '|' ? std::string("\\|") : c == '*' ? std::string("\\*") : std::string(1, c);
  return safe;
}

/// The name of a file for plot or picture `k` of a check.
std::string file_name(const CheckResult& result, const char* kind, size_t k, const char* extension) {
  std::string name = result.name;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '-';
  return name + printed("-%s%zu.%s", kind, k + 1, extension);
}

std::string group_of(const CheckResult& result) { return result.name.substr(0, result.name.find('/')); }

double largest(const PlotLine& line) {
  double error = 0.0;
  for (const auto& point : line.points)
    if (!std::isnan(point.second)) error = std::max(error, point.second);
  return error;
}

const char* const head =
    "Every row below is a question with a known answer that was put to the kernels of the device, the same ones that make\n"
    "pictures. `vitrum verify` asks them on your own device in seconds, `vitrum verify --full` as many as here in minutes;\n"
    "[verify.md](verify.md) says how the answers are known. *Worst* is the largest error over all *cases*. *Bound* is what\n"
    "it must keep; where it does not, the command fails and prints the input. An *ulp* is the distance to the next float of\n"
    "32 bits: no renderer that stores floats can be nearer than half of one.\n";

const char* const tail =
    "## What this does not say\n\n"
    "- The model is exact, not the world: light is unpolarised and has three channels, so no dispersion, no diffraction. Over\n"
    "  several bounces in a slab, true polarisation differs from the scalar model by up to .02 of the light.\n"
    "- A mesh is not the surface that it stands for: its facets deviate by about 1/n^2, which the rows of `mesh ball` state.\n"
    "- A picture has noise and, where photons are gathered, a bias besides. They differ from scene to scene, so each picture\n"
    "  tells its own: [errors.md](errors.md).\n"
    "- Light that crosses more borders than `render.max_depth`, or weighs less than `render.min_weight`, is cut; the report\n"
    "  of each render says how much that was.\n";

}  // namespace

Document verify_document(const VerifyRun& run, const std::string& folder) {
  Document document;
  std::string& text = document.text;
  const size_t failed = run.failed();
  text = "# What vitrum's numbers are worth\n\n";
  text += printed("Made by `vitrum verify%s --report-markdown` in %.0f s: %s.\n\n", run.full ? " --full" : "", run.seconds,
                  run.made_by().c_str());
  text += failed == 0 ? printed("**%zu checks, all hold.**\n\n", run.results.size())
                      : printed("**%zu checks, %zu FAIL.**\n\n", run.results.size(), failed);
  text += head;

  std::string beside, plots, pictures;
  for (const CheckResult& r : run.results) {
    for (size_t k = 0; k < r.plots.size(); ++k) {
      const Plot& plot = r.plots[k];
      const std::string name = file_name(r, "plot", k, "svg");
      document.files.emplace_back(name, plot_svg(plot));
      plots += "**" + plot.title + "** (`" + r.name + "`)\n\n![" + plot.y + " against " + plot.x + "](" + folder + "/" +
               name + ")\n\n";
      // Where the lines are other things, their largest errors side by side would tell nothing.
      if (plot.lines.size() < 2 || plot.lines[0].name != "vitrum") continue;
      beside += "| " + cell(plot.title) + " | " + cell(plot.y) + printed(" | %.3g | ", largest(plot.lines[0]));
      for (size_t line = 1; line < plot.lines.size(); ++line)
        beside += (line > 1 ? "; " : "") + cell(plot.lines[line].name) + printed(": %.3g", largest(plot.lines[line]));
      beside += " |\n";
    }
    for (size_t k = 0; k < r.pictures.size(); ++k) {
      const std::string name = file_name(r, "picture", k, "png");
      document.files.emplace_back(name, png_of(r.pictures[k]));
      pictures += "![" + r.pictures[k].caption + "](" + folder + "/" + name + ")\\\n`" + r.name + "`: " +
                  r.pictures[k].caption + "\n\n";
    }
  }
  if (!beside.empty())
    text += "\n## Beside the usual forms\n\nThe largest errors of vitrum and of forms as textbooks and other renderers have "
            "them, on the same inputs; the\nplots below show where they come from.\n\n"
            "| what | error | vitrum | others |\n| --- | --- | --- | --- |\n" + beside;
  if (!plots.empty()) text += "\n## Error against input\n\n" + plots;
  if (!pictures.empty()) text += "## Pictures with a known answer\n\n" + pictures;
  text += "## All checks\n";
  std::string group;
  for (const CheckResult& r : run.results) {
    if (group_of(r) != group) {
      group = group_of(r);
      text += "\n### " + group + "\n\n| check | cases | worst | bound | unit | | truth |\n"
              "| --- | ---: | ---: | ---: | --- | --- | --- |\n";
    }
    text += "| " + cell(r.name.substr(group.size() + 1)) + " | " + count_text(r.cases) + printed(" | %.3g | %.3g | ", r.worst, r.bound) +
            cell(r.unit) + (r.passed() ? " | holds | " : " | **FAILS** | ") + cell(r.truth) + " |\n";
  }
  text += std::string("\n") + tail;
  return document;
}

}  // namespace vitrum
