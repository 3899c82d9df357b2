#include "render/render.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <future>

#include "commands/commands.hpp"
#include "commands/outputs.hpp"
#include "commands/report.hpp"
#include "commands/scene_arguments.hpp"
#include "commands/usage.hpp"
#include "core/log.hpp"
#include "core/printed.hpp"
#include "core/version.hpp"
#include "core/whole_file.hpp"
#include "film/images.hpp"
#include "scene/textures.hpp"

namespace vitrum {
namespace {

constexpr uint64_t most_threads = 1024;       // more than that PoCL may fail to start, without a word of why
constexpr uint64_t largest_group = 1u << 16;  // a device that takes less gets the most that it takes

struct RenderArguments {
  SceneArguments scene;
  std::vector<std::string> outputs, views;
  std::string threads = "0", group_size = "32";
  std::string device, report;
  KernelFiles kernels;
  bool quiet = false;
};

/// What a view shows, pixel by pixel; empty where the scene has nothing for it, such as photons without a caster.
std::vector<double> values_of(const RenderResult& result, View view) {
  if (view == View::beauty) return result.film.mean("radiance");
  if (view == View::cut) return cut_radiance(result.film, result.limit);
  if (view == View::error) return result.standard_error();
  return result.film.mean(view_name(view));
}

/// A view as a layer of a picture.
PictureLayer layer_of(const RenderResult& result, View view) {
  PictureLayer layer;
  layer.name = view_name(view);
  const bool scalar = view == View::depth || view == View::photons;
  layer.channels = scalar ? 1 : 3;
  layer.is_colour = view != View::depth && view != View::normal;
  const std::vector<double> values = values_of(result, view);
  layer.values.assign(values.begin(), values.end());
  if (layer.values.empty())
    layer.values.assign(static_cast<size_t>(result.film.width() * result.film.height() * layer.channels), 0.0f);
  if (view == View::photons) {
    // White dots: passes overlay each other. In three channels, so that every format shows them.
    std::vector<float> white;
    for (float value : layer.values) white.insert(white.end(), 3, value > 0.0f ? 1.0f : 0.0f);
    layer.values = std::move(white);
    layer.channels = 3;
  }
  return layer;
}

/// The views in the order given. Throws Error for one that is none, or is there already.
std::vector<View> views_of_names(const std::vector<std::string>& names) {
  std::vector<View> views;
  for (const std::string& name : names) {
    const View view = view_of_name(name);
    if (std::find(views.begin(), views.end(), view) != views.end())
      throw Error({"--view " + name}, "this view is named twice", "name it once");
    views.push_back(view);
  }
  return views;
}

/// "relative error .021 (95 %: .019 to .024) after 5 rounds, 120 samples a pixel and 2000000 photons".
std::string rounds_text(const RenderResult& result) {
  const RoundsResult& rounds = *result.rounds;
  const RelativeError& error = rounds.error;
  const std::string reason = rounds.end == RoundsResult::End::target ? ""
                             : rounds.end == RoundsResult::End::time ? "time is up: "
                                                                     : "there is no room for smaller footprints: ";
  const std::string bias = error.bias_known ? "" : ", and a bias by the photons that one round does not tell";
  return reason + printed("relative error %.3g (%.0f %%: %.3g to %.3g)%s after %d round%s, %.3g samples a pixel and %llu photons",
                          error.value, 100.0 * RoundsResult::confidence, error.low, error.high, bias.c_str(), rounds.rounds,
                          rounds.rounds == 1 ? "" : "s", result.samples, static_cast<unsigned long long>(result.photons.photons_shot));
}

void run_render(const RenderArguments& arguments) {
  const auto start = std::chrono::steady_clock::now();
  // Else textures start it, if there are any.
  if (std::any_of(arguments.outputs.begin(), arguments.outputs.end(), takes_image_process)) start_image_process();
  set_quiet(arguments.quiet);
  RenderOptions options;
  options.start = start;
  options.kernels = arguments.kernels;
  if (!arguments.views.empty()) options.views = views_of_names(arguments.views);
  const auto threads = static_cast<unsigned>(whole_number("--threads", arguments.threads, 0, most_threads));
  const auto group_size = static_cast<unsigned>(whole_number("--group-size", arguments.group_size, 1, largest_group));
  check_outputs(arguments.outputs, arguments.report);
  if (!options.kernels.folder.empty() && !std::filesystem::is_directory(options.kernels.folder))
    throw Error({"--kernels " + options.kernels.folder}, "there is no such folder",
                "name the folder kernels/ of vitrum's sources");

  // The device wakes up while the scene is read, and textures are decoded meanwhile in the process for pictures.
  prepare_opencl(threads);
  auto waking = std::async(std::launch::async, [&arguments, group_size] {
    return std::make_unique<Device>(arguments.device, group_size);
  });
  Scene scene = arguments.scene.load();
  const double load_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  options.textures_ready = std::async(std::launch::async, [&scene] { load_textures(scene); });
  const std::unique_ptr<Device> device = waking.get();
  note("device: " + device->info().name);

  RenderResult result = render(scene, *device, options);
  result.seconds["load"] = load_seconds;
  result.seconds["first pixels"] = std::chrono::duration<double>(result.first_pixels - start).count();

  if (result.rounds) note(rounds_text(result));

  const auto write_start = std::chrono::steady_clock::now();
  std::vector<PictureLayer> layers;
  for (View view : options.views) layers.push_back(layer_of(result, view));
  const std::map<std::string, std::string> metadata = {
      {"version", version()},
      {"scene", scene.file},
      {"seed", std::to_string(scene.render.seed)},
      {"samples", printed("%g", result.samples)},
      {"photons", std::to_string(result.photons.photons_shot)},
      {"device", device->info().name},
  };
  const DisplaySettings display{scene.film.display == DisplayTransform::srgb, scene.film.gamma, scene.film.exposure};
  for (const std::string& output : arguments.outputs) {
    write_picture(output, scene.film.width, scene.film.height, layers, display, metadata);
    note("wrote " + output);
  }
  end_image_process();  // while the device is let go
  result.seconds["write"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - write_start).count();
  result.seconds["total"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!arguments.report.empty()) {
    write_whole_file(arguments.report, render_report(scene, *device, result));
    note("wrote " + arguments.report);
  }
}

}  // namespace

void add_render_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("render", "Render a scene to one or more pictures");
  const auto arguments = std::make_shared<RenderArguments>();
  arguments->scene.add_to(*command);
  command->add_option("-o,--output", arguments->outputs,
                      "Picture to write (repeatable): .exr is linear with all views as layers;\n"
                      ".png, .jpg, .tif, .bmp and .hdr show the first view")
      ->required()
      ->type_name("FILE")
      ->allow_extra_args(false);
  command->add_option("--view", arguments->views,
                      "What to show (repeatable): beauty, photons, caustics, albedo, normal, depth;\n"
                      "error: standard error of the beauty, from 8 passes; cut: radiance that max_depth and\n"
                      "min_weight took, at most; bias: error of the caustics by the photons' radius")
      ->type_name("NAME")
      ->allow_extra_args(false);
  command->add_option("--threads", arguments->threads, "Threads of a CPU device; 0: all")->type_name("N");
  command->add_option("--device", arguments->device, "OpenCL device: number or piece of its name, as `vitrum devices` lists")
      ->type_name("NAME");
  command->add_option("--report", arguments->report, "Write settings, times, counts, errors and memory as JSON")->type_name("FILE");
  command->add_option("--kernels", arguments->kernels.folder, "Read the kernels from this folder instead of the binary")
      ->type_name("DIR");
  command->add_option("--dump-kernels", arguments->kernels.dump_folder, "Write the kernels as compiled to this folder")
      ->type_name("DIR");
  command->add_option("--group-size", arguments->group_size, "Work-items per group; the picture does not depend on it")
      ->type_name("N");
  command->add_flag("--quiet", arguments->quiet, "Print nothing but warnings and errors");
  command->callback([arguments] { run_render(*arguments); });
}

}  // namespace vitrum
