#include <algorithm>
#include <cstdio>
#include <limits>
#include <optional>

#include "commands/commands.hpp"
#include "commands/comparison.hpp"
#include "commands/outputs.hpp"
#include "commands/usage.hpp"
#include "core/log.hpp"
#include "core/printed.hpp"
#include "core/version.hpp"
#include "core/whole_file.hpp"
#include "film/false_colour.hpp"
#include "film/film.hpp"

namespace vitrum {
namespace {

struct CompareArguments {
  std::string a, b, reference;
  std::vector<std::string> views, thresholds;
  std::string output, scale, report;
  std::string epsilon = "0.01", alpha = "0.001", degrees = std::to_string(Film::max_replicates - 1);
};

NamedPicture read_named(const std::string& file) { return {file, read_layers(file, {file})}; }

/// Throws Error for a view that is named twice.
void check_each_once(const std::vector<std::string>& views) {
  for (size_t i = 0; i < views.size(); ++i)
    if (std::find(views.begin(), views.begin() + static_cast<std::ptrdiff_t>(i), views[i]) !=
        views.begin() + static_cast<std::ptrdiff_t>(i))
      throw Error({"--view " + views[i]}, "this view is named twice", "name it once");
}

/// Where one of them holds linear light and another values for the screen, no number below means much.
void warn_of_other_kind(const NamedPicture& picture, const NamedPicture& first) {
  if (picture.picture.is_float == first.picture.is_float) return;
  const NamedPicture& screen = picture.picture.is_float ? first : picture;
  const NamedPicture& linear = picture.picture.is_float ? picture : first;
  warn({screen.file}, "this file holds integers, as a rule values for the screen, and is compared with floats, as a "
                      "rule linear light, in '" + linear.file + "'");
}

/// Writes the differences of a view in false colours; `scale` is that of their white, or nothing: false_colour_scale.
void write_differences(const std::string& file, const NamedPicture& a, const NamedPicture& b, const std::string& view,
                       std::optional<double> scale) {
  const PictureLayer &layer_a = *a.layer(view), &layer_b = *b.layer(view);
  const std::vector<float> differences = pixel_differences(layer_a.values, layer_b.values, layer_a.channels);
  const double white = scale ? *scale : false_colour_scale(differences);
  const Picture picture = false_colour_picture(differences, a.picture.width, a.picture.height, white);
  PictureLayer layer;
  for (const glm::vec3& pixel : picture.pixels) layer.values.insert(layer.values.end(), {pixel.x, pixel.y, pixel.z});
  const std::string scale_text = printed("%.6g", white);
  write_picture(file, picture.width, picture.height, {layer}, DisplaySettings{},
                {{"version", version()}, {"difference", a.file + " - " + b.file}, {"view", view}, {"scale", scale_text}});
  note("wrote " + file + ": |A - B| of the " + view + ", from 0 (black) to " + scale_text + " (white, and all above)");
}

int run_compare(const CompareArguments& arguments) {
  start_image_process();
  constexpr double least_float = std::numeric_limits<float>::denorm_min();
  constexpr double most_float = std::numeric_limits<float>::max();
  ComparisonSettings settings;
  settings.epsilon = real_number("--epsilon " + arguments.epsilon, arguments.epsilon, least_float, most_float);
  settings.alpha = real_number("--alpha " + arguments.alpha, arguments.alpha, 1e-12, 0.5);
  settings.degrees = static_cast<double>(whole_number("--degrees-of-freedom", arguments.degrees, 1, 1000000));
  std::optional<double> scale;
  if (!arguments.scale.empty())
    scale = real_number("--scale " + arguments.scale, arguments.scale, least_float, most_float);
  std::vector<Threshold> thresholds;
  for (const std::string& text : arguments.thresholds) thresholds.push_back(threshold_of(text));
  check_each_once(arguments.views);
  std::vector<std::string> inputs{arguments.a, arguments.b}, pictures;
  if (!arguments.reference.empty()) inputs.push_back(arguments.reference);
  if (!arguments.output.empty()) pictures.push_back(arguments.output);
  check_outputs(pictures, arguments.report, inputs);

  const NamedPicture a = read_named(arguments.a), b = read_named(arguments.b);
  std::optional<NamedPicture> reference;
  if (!arguments.reference.empty()) reference = read_named(arguments.reference);
  const Comparison comparison =
      compare_pictures(a, b, reference ? &*reference : nullptr, arguments.views, settings);
  const std::vector<Verdict> all = verdicts(comparison, thresholds);
  warn_of_other_kind(b, a);
  if (reference) warn_of_other_kind(*reference, a);

  std::fputs(comparison_text(comparison, all).c_str(), stdout);
  if (!arguments.output.empty()) write_differences(arguments.output, a, b, comparison.views.front().name, scale);
  end_image_process();  // while the report is written
  if (!arguments.report.empty()) {
    write_whole_file(arguments.report, comparison_report(comparison, all));
    note("wrote " + arguments.report);
  }
  return is_any_exceeded(all) ? exit_exceeded : 0;
}

std::string compare_footer() {
  std::string text = "Measures, by view, for values a of A and b of B, over all pixels and channels:\n";
  for (const Measure& measure : measures()) {
    text += "  " + measure.name + std::string(10 - measure.name.size(), ' ') + measure.meaning + "\n";
  }
  return text +
         "PNG and the like are compared as the values of 0 to 1 in the file.\n"
         "Exit code: 0; 3 if a threshold is exceeded or, with any threshold, a pixel is NaN or infinite;\n"
         "1 for an error; 2 for unknown or missing options.\n"
         "docs/compare.md tells more.\n\nExample:\n"
         "  vitrum compare a.exr b.exr --threshold rmse=1e-3 -o difference.png";
}

}  // namespace

void add_compare_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("compare", "Tell how far two pictures are from each other, and from a third");
  const auto arguments = std::make_shared<CompareArguments>();
  command->add_option("A", arguments->a, "Picture: EXR with its layers, PNG, JPEG, TIFF, ...")
      ->required()
      ->type_name("");
  command->add_option("B", arguments->b, "Picture of the same size; relative errors are relative to it")
      ->required()
      ->type_name("");
  command->add_option("--reference", arguments->reference, "Hold both against this picture, too")->type_name("FILE");
  command->add_option("--view", arguments->views,
                      "Layer to compare (repeatable); without it, all that they have in common")
      ->type_name("NAME")
      ->allow_extra_args(false);
  const auto output = command->add_option("-o,--output", arguments->output,
                                          "Picture of |A - B| in false colours, with its scale, of the first view")
                          ->type_name("FILE");
  command->add_option("--scale", arguments->scale,
                      "Difference that is white in it; without it, one that 99 % stay below")
      ->type_name("MAX")
      ->needs(output);
  command->add_option("--report", arguments->report, "Write all numbers as JSON")->type_name("FILE");
  command->add_option("--threshold", arguments->thresholds,
                      "End with exit code 3 if a measure exceeds VALUE in any view compared (repeatable)")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  command->add_option("--epsilon", arguments->epsilon,
                      "Keeps black pixels from deciding the relative errors; in units of b^2 (0.01)")
      ->type_name("E");
  command->add_option("--alpha", arguments->alpha, "False-alarm rate of the z-test, over the whole picture (0.001)")
      ->type_name("P");
  command->add_option("--degrees-of-freedom", arguments->degrees,
                      "Of the standard errors in the layer error: replicates - 1 (7, as vitrum writes them)")
      ->type_name("N");
  command->footer(compare_footer());
  command->callback([arguments, &exit_code] { exit_code = run_compare(*arguments); });
}

}  // namespace vitrum
