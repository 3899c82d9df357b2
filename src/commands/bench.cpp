#include "bench/benchmark.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <thread>

#include "commands/commands.hpp"
#include "commands/scene_arguments.hpp"
#include "core/error.hpp"
#include "core/log.hpp"
#include "core/progress.hpp"
#include "core/suggest.hpp"
#include "core/version.hpp"
#include "core/whole_file.hpp"
#include "film/images.hpp"
#include "scene/scene_file.hpp"
#include "scene/textures.hpp"

namespace vitrum {
namespace {

struct BenchArguments {
  std::string what, scene, device, report, plot, truth;
  unsigned threads = 0;
  KernelFiles kernels;
  bool quick = false;
};

const Benchmark& benchmark_of(const std::string& name) {
  std::vector<std::string> known;
  for (const Benchmark& benchmark : benchmarks()) {
    if (name == benchmark.name) return benchmark;
    known.push_back(benchmark.name);
  }
  throw Error({"bench " + name}, "there is no such benchmark", suggestion(name, known, "benchmarks"));
}

std::string json_report(const Benchmark& benchmark, const BenchResult& result, const DeviceInfo& device, unsigned threads) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const BenchRow& row : result.rows) {
    nlohmann::ordered_json figures = {{"what", row.what}};
    for (const Figure& figure : row.figures) figures[figure.name] = figure.value;
    rows.push_back(figures);
  }
  const nlohmann::ordered_json report = {
      {"benchmark", benchmark.name},
      {"version", version()},
      {"commit", commit()},
      {"device", {{"name", device.name}, {"platform", device.platform}, {"version", device.version}, {"driver", device.driver}}},
      {"threads", threads},
      {"rows", rows},
      {"findings", result.findings},
  };
  return report.dump(2) + "\n";
}

void print_rows(const std::vector<BenchRow>& rows) {
  if (rows.empty()) return;
  size_t width = 4;
  for (const BenchRow& row : rows) width = std::max(width, row.what.size());
  std::printf("%-*s", static_cast<int>(width), "");
  for (const Figure& figure : rows.front().figures) std::printf("  %15s", figure.name.c_str());
  std::printf("\n");
  for (const BenchRow& row : rows) {
    std::printf("%-*s", static_cast<int>(width), row.what.c_str());
    for (const Figure& figure : row.figures) std::printf("  %15.5g", figure.value);
    std::printf("\n");
  }
}

void run_bench(const BenchArguments& arguments) {
  const Benchmark& benchmark = benchmark_of(arguments.what);
  if (!arguments.scene.empty() && !benchmark.takes_scene)
    throw Error({arguments.scene}, std::string("the benchmark ") + benchmark.name + " takes no scene", "leave it out");
  if (!arguments.plot.empty() && !benchmark.has_plot)
    throw Error({"--plot " + arguments.plot}, std::string("the benchmark ") + benchmark.name + " has no plot", "leave it out");
  for (const std::string& file : {arguments.report, arguments.plot})
    if (!file.empty()) check_whole_file(file);
  if (!arguments.truth.empty()) check_writable(arguments.truth);
  prepare_opencl(arguments.threads);
  Scene scene;
  if (!arguments.scene.empty()) {
    scene = load_scene(arguments.scene, {});
    load_textures(scene);
  }
  Device device(arguments.device);
  const unsigned all = device.info().is_cpu ? device.info().compute_units : std::thread::hardware_concurrency();
  const unsigned threads = arguments.threads == 0 ? all : arguments.threads;
  std::printf("%s, %s, %u threads\n", device.info().name.c_str(), device.info().platform.c_str(), threads);
  BenchResult result;
  {
    Progress progress("bench");
    const bool was_quiet = quiet();
    set_quiet(true);            // each render would tell of itself
    result = benchmark.run({device, arguments.device, threads, arguments.kernels, arguments.scene.empty() ? nullptr : &scene,
                            arguments.quick, [&](double done) { progress.update(std::min(done, 1.0)); }});
    set_quiet(was_quiet);
  }
  print_rows(result.rows);
  for (const std::string& finding : result.findings) std::printf("%s\n", finding.c_str());
  if (!arguments.report.empty())
    write_whole_file(arguments.report, json_report(benchmark, result, device.info(), threads));
  if (!arguments.plot.empty()) write_whole_file(arguments.plot, plot_svg(result.plot));
  if (!arguments.truth.empty())
    write_picture(arguments.truth, result.width, result.height, {result.truth}, DisplaySettings{},
                  {{"version", version()}, {"truth", arguments.what}});
}

}  // namespace

void add_bench_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("bench", "Measure errors, rates and times beside others'");
  const auto arguments = std::make_shared<BenchArguments>();
  command->add_option("benchmark", arguments->what, "What to measure, see below")->required()->type_name("WHAT");
  command->add_option("scene", arguments->scene, "Scene file to measure with, in place of the benchmark's own")->type_name("SCENE");
  command->add_option("--device", arguments->device, "OpenCL device: number or piece of its name, as `vitrum devices` lists")
      ->type_name("NAME");
  command->add_option("--threads", arguments->threads, "Threads of a CPU device (0: all)")->type_name("N");
  command->add_option("--report", arguments->report, "Write the figures as JSON")->type_name("FILE");
  command->add_option("--plot", arguments->plot, "Write a plot as SVG")->type_name("FILE");
  command->add_option("--truth", arguments->truth, "Write the picture that errors are from, best as EXR")->type_name("FILE");
  command->add_flag("--quick", arguments->quick, "Seconds instead of minutes, to see that it runs: the figures say little");
  command->add_option("--kernels", arguments->kernels.folder, "Read the kernels from this folder instead of the binary")
      ->type_name("DIR");
  std::string footer = "Benchmarks:\n";
  for (const Benchmark& benchmark : benchmarks())
    footer += "  " + std::string(benchmark.name) + std::string(12 - std::string(benchmark.name).size(), ' ') + benchmark.what + "\n";
  command->footer(footer + "Times are processor times of all threads, but for startup. docs/bench.md tells more.");
  command->callback([arguments] { run_bench(*arguments); });
}

}  // namespace vitrum
