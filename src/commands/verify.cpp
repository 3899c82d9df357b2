#include "verify/check.hpp"

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands/commands.hpp"
#include "commands/outputs.hpp"
#include "commands/verify_document.hpp"
#include "commands/verify_page.hpp"
#include "core/error.hpp"
#include "core/log.hpp"
#include "core/progress.hpp"
#include "core/suggest.hpp"
#include "core/version.hpp"
#include "core/whole_file.hpp"
#include "verify/run_checks.hpp"

namespace vitrum {
namespace {

struct VerifyArguments {
  std::string device, against, report, report_html, report_markdown;
  std::vector<std::string> only;
  KernelFiles kernels;
  bool full = false, quick = false;
};

nlohmann::ordered_json device_json(const DeviceInfo& device) {
  return {{"name", device.name}, {"platform", device.platform}, {"version", device.version}, {"driver", device.driver}};
}

/// The groups named, all if none is. Throws Error for a name that is none.
std::vector<CheckGroup> chosen_groups(const std::vector<std::string>& names) {
  if (names.empty()) return check_groups();
  std::vector<CheckGroup> chosen;
  for (const std::string& name : names) {
    std::vector<std::string> known;
    const size_t before = chosen.size();
    for (const CheckGroup& group : check_groups()) {
      known.push_back(group.name);
      if (name == group.name) chosen.push_back(group);
    }
    if (chosen.size() == before)
      throw Error({"--only " + name}, "there is no such group of checks", suggestion(name, known, "groups"));
  }
  return chosen;
}

std::string table_row(const CheckResult& r) {
  char line[400];
  std::snprintf(line, sizeof line, "%-36s %10llu  %9.3g %9.3g  %-15s %-4s  %s\n", r.name.c_str(),
                static_cast<unsigned long long>(r.cases), r.worst, r.bound, r.unit.c_str(), r.passed() ? "pass" : "FAIL",
                r.truth.c_str());
  return line;
}

nlohmann::ordered_json plots_json(const std::vector<Plot>& plots) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const Plot& plot : plots) {
    nlohmann::ordered_json lines = nlohmann::ordered_json::array();
    for (const PlotLine& line : plot.lines) lines.push_back({{"name", line.name}, {"points", line.points}});
    all.push_back({{"title", plot.title}, {"x", plot.x}, {"y", plot.y}, {"lines", lines}});
  }
  return all;
}

std::string json_report(const VerifyRun& run) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const CheckResult& r : run.results)
    rows.push_back({{"check", r.name}, {"passed", r.passed()}, {"cases", r.cases}, {"worst", r.worst}, {"bound", r.bound},
                    {"unit", r.unit}, {"truth", r.truth}, {"worst_input", r.worst_input}, {"kernel", r.kernel},
                    {"plots", plots_json(r.plots)}});
  const nlohmann::ordered_json report = {
      {"version", version()},
      {"commit", commit()},
      {"device", device_json(run.device)},
      {"against", run.other ? device_json(*run.other) : nlohmann::ordered_json()},
      {"mode", run.full ? "full" : "quick"},
      {"seconds", run.seconds},
      {"checks", rows},
  };
  return report.dump(2) + "\n";
}

/// Writes the document, and what it shows in a folder beside it that is named as the file without its extension.
void write_document(const std::string& file, const VerifyRun& run) {
  const std::filesystem::path folder = std::filesystem::path(file).replace_extension();
  const Document document = verify_document(run, folder.filename().string());
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) throw Error({folder.string()}, "the folder cannot be made: " + failure.message(), "choose another --report-markdown");
  for (const auto& [name, bytes] : document.files) write_whole_file((folder / name).string(), bytes);
  write_whole_file(file, document.text);
}

int run_verify(const VerifyArguments& arguments) {
  const auto start = std::chrono::steady_clock::now();
  const std::vector<CheckGroup> groups = chosen_groups(arguments.only);
  for (const std::string& file : {arguments.report, arguments.report_html, arguments.report_markdown})
    if (!file.empty()) check_whole_file(file);
  if (!arguments.report_html.empty() || !arguments.report_markdown.empty()) start_image_process();  // pictures as PNG
  if (!arguments.kernels.folder.empty() && !std::filesystem::is_directory(arguments.kernels.folder))
    throw Error({"--kernels " + arguments.kernels.folder}, "there is no such folder",
                "name the folder kernels/ of vitrum's sources");
  if (arguments.against.empty() && arguments.only == std::vector<std::string>{"devices"})
    throw Error({"--only devices"}, "there is no second device",
                "name one with --against, as `vitrum devices` lists them");
  prepare_opencl(0);
  VerifyRun run;
  run.full = arguments.full;
  run.device = Device(arguments.device).info();
  std::printf("%s, %s\n", run.device.name.c_str(), run.device.platform.c_str());
  if (!arguments.against.empty()) {
    run.other = Device(arguments.against).info();
    std::printf("against %s, %s\n", run.other->name.c_str(), run.other->platform.c_str());
  }
  std::printf("%-36s %10s  %9s %9s  %-15s %-4s  %s\n", "check", "cases", "worst", "bound", "unit", "", "truth");
  std::fflush(stdout);
  {
    Progress progress("verify");
    const bool was_quiet = quiet();
    set_quiet(true);            // the pictures that are rendered on the way are nobody's business
    run.results = run_checks(groups, {arguments.device, arguments.against, arguments.kernels, arguments.full},
                             [&](double done) { progress.update(done); });
    set_quiet(was_quiet);
  }
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  for (const CheckResult& result : run.results) std::fputs(table_row(result).c_str(), stdout);
  std::printf("%zu checks, %zu failed, %.1f s\n", run.results.size(), run.failed(), run.seconds);
  for (const CheckResult& result : run.results)
    if (!result.passed())
      std::printf("FAIL %s: %g %s, more than %g, at %s; kernels/%s\n", result.name.c_str(), result.worst,
                  result.unit.c_str(), result.bound, result.worst_input.c_str(), result.kernel.c_str());
  if (!arguments.report.empty()) write_whole_file(arguments.report, json_report(run));
  if (!arguments.report_html.empty()) write_whole_file(arguments.report_html, verify_page(run));
  if (!arguments.report_markdown.empty()) write_document(arguments.report_markdown, run);
  return run.failed() == 0 ? 0 : exit_unverified;
}

}  // namespace

void add_verify_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("verify", "Check the device's answers against closed forms");
  const auto arguments = std::make_shared<VerifyArguments>();
  command->add_option("--device", arguments->device, "OpenCL device: number or piece of its name, as `vitrum devices` lists")
      ->type_name("NAME");
  command->add_option("--against", arguments->against, "Also hold this device's answers against those of --device")
      ->type_name("NAME");
  const auto quick = command->add_flag("--quick", arguments->quick, "Some seconds of checks (the default)");
  command->add_flag("--full", arguments->full, "Minutes of checks: more inputs, larger pictures, more photons")->excludes(quick);
  command->add_option("--only", arguments->only, "Run this group of checks only (repeatable)")
      ->type_name("GROUP")
      ->allow_extra_args(false);
  command->add_option("--report", arguments->report, "Write the table with the worst inputs as JSON")->type_name("FILE");
  command->add_option("--report-html", arguments->report_html, "Write it as a page, with plots and pictures")
      ->type_name("FILE");
  command->add_option("--report-markdown", arguments->report_markdown,
                      "Write it for a reader, with plots and pictures in a folder beside it, beside the usual forms")
      ->type_name("FILE");
  command->add_option("--kernels", arguments->kernels.folder, "Read the kernels from this folder instead of the binary")
      ->type_name("DIR");
  std::string footer = "Groups of checks:\n";
  for (const CheckGroup& group : check_groups())
    footer += "  " + std::string(group.name) + std::string(16 - std::string(group.name).size(), ' ') + group.what + "\n";
  command->footer(footer +
                  "Exit code: 0 if all checks hold; 1 if one fails, with the input that shows it, or for an error;\n"
                  "2 for unknown options. docs/verify.md tells more.");
  command->callback([arguments, &exit_code] { exit_code = run_verify(*arguments); });
}

}  // namespace vitrum
