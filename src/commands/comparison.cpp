#include "commands/comparison.hpp"

#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>

#include "commands/usage.hpp"
#include "core/error.hpp"
#include "core/printed.hpp"
#include "core/suggest.hpp"
#include "core/version.hpp"

namespace vitrum {
namespace {

// ---------------------------------------------------------------------------------------------- comparing

std::vector<std::string> layer_names(const NamedPicture& of) {
  std::vector<std::string> names;
  for (const PictureLayer& layer : of.picture.layers) names.push_back(layer.name);
  return names;
}

void check_same_size(const NamedPicture& picture, const NamedPicture& first) {
  const auto size = [](const NamedPicture& of) {
    return std::to_string(of.picture.width) + " x " + std::to_string(of.picture.height);
  };
  if (size(picture) != size(first))
    throw Error({picture.file},
                "this picture has " + size(picture) + " pixels, '" + first.file + "' has " + size(first),
                "compare pictures of one size");
}

/// The layer `name`, which must have as many channels as `first`, if that is given. Throws Error.
const PictureLayer& needed_layer(const NamedPicture& of, const std::string& name, const PictureLayer* first) {
  const PictureLayer* layer = of.layer(name);
  if (!layer) throw Error({of.file}, "there is no layer '" + name + "'", suggestion(name, layer_names(of), "layers"));
  if (first && layer->channels != first->channels)
    throw Error({of.file},
                "the layer '" + name + "' has " + std::to_string(layer->channels) + " channels in place of " +
                    std::to_string(first->channels),
                "compare pictures whose layers are alike, or others with --view");
  return *layer;
}

/// All that every picture has, but the errors, in the order of the first. Throws Error if there are none.
std::vector<std::string> common_layers(const std::vector<const NamedPicture*>& pictures) {
  std::vector<std::string> common;
  for (const std::string& name : layer_names(*pictures.front())) {
    const bool is_common = std::all_of(pictures.begin(), pictures.end(),
                                       [&](const NamedPicture* picture) { return picture->layer(name) != nullptr; });
    if (is_common && name != error_layer) common.push_back(name);
  }
  if (!common.empty()) return common;
  std::string lists;
  for (const NamedPicture* picture : pictures) {
    lists += (lists.empty() ? "'" : ", '") + picture->file + "' has";
    for (const std::string& name : layer_names(*picture)) lists += " " + name;
  }
  throw Error({pictures.back()->file}, "the pictures have no layer in common (" + lists + ")",
              "render the same --view into both");
}

std::optional<ZTest> z_test_of(const NamedPicture& a, const NamedPicture& b, const PictureLayer& layer_a,
                               const PictureLayer& layer_b, const ComparisonSettings& settings) {
  if (layer_a.name != "beauty" || !a.layer(error_layer) || !b.layer(error_layer)) return std::nullopt;
  const PictureLayer& error_a = needed_layer(a, error_layer, &layer_a);
  const PictureLayer& error_b = needed_layer(b, error_layer, &layer_a);
  return z_test({layer_a.values, error_a.values}, {layer_b.values, error_b.values}, a.picture.width, layer_a.channels,
                settings.degrees, settings.alpha);
}

/// a / b; equal numbers, also 0 and 0, are in the ratio of 1.
double ratio(double a, double b) { return a == b ? 1.0 : a / b; }

// ---------------------------------------------------------------------------------------------- text

char channel_letter(const ViewComparison& view, int channel) { return (view.is_colour ? "RGB" : "XYZ")[channel]; }

/// "(3, 5), G": a pixel and, where there are several, its channel.
std::string place_text(const ViewComparison& view, int x, int y, int channel) {
  const std::string pixel = printed("(%d, %d)", x, y);
  return view.channels == 1 ? pixel : pixel + ", " + channel_letter(view, channel);
}

std::string means_text(double a, double b) { return printed("A %.6g, B %.6g, A/B %.6g\n", a, b, ratio(a, b)); }

std::string z_test_text(const ZTest& z, const ViewComparison& view, const ComparisonSettings& settings) {
  std::string text;
  if (z.tested == 0) {
    text = "  z-test               no value tells its error\n";
  } else {
    const double n = settings.degrees;
    text = printed("  z-test               %s: p = %.3g by Sidak, alarm below %g\n",
                   z.p_value < settings.alpha ? "THEY DIFFER" : "no difference seen", z.p_value, settings.alpha) +
           printed("    tested             %" PRIu64 " values of %" PRIu64 " pixels, errors of %g degrees of freedom\n",
                   z.tested, z.tested_pixels, n) +
           printed("    largest |z|        %.4g at pixel %s; alarm above %.4g\n", std::abs(z.largest),
                   place_text(view, z.largest_x, z.largest_y, z.largest_channel).c_str(), z.limit) +
           printed("    mean of z^2        %.4g", z.mean_square);
    // The variance of Student's distribution, which of 2 n and n degrees is the least and the most that z can have.
    if (n > 2) text += printed("; %.4g to %.4g is expected", n / (n - 1), n / (n - 2));
    text += "\n";
  }
  if (z.not_testable > 0)
    text += printed("    not testable       %" PRIu64 " values: not finite, or their errors are not\n", z.not_testable);
  return text;
}

std::string reference_text(const PictureError& a, const PictureError& b) {
  const auto row = [](const char* name, double x, double y) {
    return printed("    %-18s %-12.6g %-12.6g %.6g\n", name, x, y, ratio(x, y));
  };
  return printed("  %-20s %-12s %-12s %s\n", "against R", "A", "B", "A/B") + row("MSE", a.mse, b.mse) +
         row("relative MSE", a.relative_mse, b.relative_mse) + row("RMSE", a.rmse, b.rmse) +
         row("relative RMSE", a.relative_rmse, b.relative_rmse);
}

std::string view_text(const ViewComparison& view, const Comparison& comparison) {
  const PictureError& e = view.error;
  const uint64_t pixels = uint64_t(comparison.width) * uint64_t(comparison.height);
  std::string text = "\n" + view.name + "\n";
  text += "  mean                 " + means_text(e.mean, e.truth_mean);
  for (int c = 0; view.channels > 1 && c < view.channels; ++c)
    text += printed("    %c                  ", channel_letter(view, c)) +
            means_text(e.channel_means[size_t(c)], e.truth_channel_means[size_t(c)]);
  text += printed("  MSE                  %.6g\n", e.mse);
  text += printed("  RMSE                 %.6g", e.rmse);
  if (e.truth_mean != 0.0) text += printed(" (%.4g %% of B's mean)", 100.0 * e.rmse / std::abs(e.truth_mean));
  text += "\n";
  text += printed("  relative MSE         %.6g\n", e.relative_mse);
  text += printed("  relative RMSE        %.6g\n", e.relative_rmse);
  text += printed("  largest difference   %.6g", e.maximum);
  if (e.maximum > 0.0)
    text += " at pixel " + place_text(view, e.maximum_x, e.maximum_y, e.maximum_channel) +
            printed(": A %.6g, B %.6g", static_cast<double>(view.largest_a), static_cast<double>(view.largest_b));
  text += "\n";
  text += printed("  pixels that differ   %" PRIu64 " of %" PRIu64 "%s\n", e.differing_pixels, pixels,
                  e.differing_pixels == 0 ? ": bit-equal" : "");
  if (view.not_finite_a + view.not_finite_b > 0)
    text += printed("  not finite           A %" PRIu64 " pixels, B %" PRIu64 " pixels%s\n", view.not_finite_a,
                    view.not_finite_b, view.has_faults() ? "" : ": the same infinities in both");
  if (view.z_test) text += z_test_text(*view.z_test, view, comparison.settings);
  if (view.a_to_reference) text += reference_text(*view.a_to_reference, *view.b_to_reference);
  return text;
}

// ---------------------------------------------------------------------------------------------- JSON

nlohmann::ordered_json error_json(const PictureError& error) {
  return {{"mse", error.mse},
          {"rmse", error.rmse},
          {"relative_mse", error.relative_mse},
          {"relative_rmse", error.relative_rmse}};
}

nlohmann::ordered_json view_json(const ViewComparison& view, const ComparisonSettings& settings) {
  const PictureError& e = view.error;
  nlohmann::ordered_json json;
  json["mean"] = {{"a", e.mean}, {"b", e.truth_mean}, {"ratio", ratio(e.mean, e.truth_mean)}};
  json["channel_means"] = {{"a", e.channel_means}, {"b", e.truth_channel_means}};
  json.update(error_json(e));
  json["largest_difference"] = {{"value", e.maximum},
                                {"pixel", {e.maximum_x, e.maximum_y}},
                                {"channel", e.maximum_channel},
                                {"a", view.largest_a},
                                {"b", view.largest_b}};
  json["differing_pixels"] = e.differing_pixels;
  json["not_finite_pixels"] = {{"a", view.not_finite_a}, {"b", view.not_finite_b}};
  json["has_faults"] = view.has_faults();
  if (view.z_test) {
    const ZTest& z = *view.z_test;
    json["z_test"] = {{"alpha", settings.alpha},
                      {"degrees_of_freedom", settings.degrees},
                      {"differ", z.p_value < settings.alpha},
                      {"p_value", z.p_value},
                      {"tested_pixels", z.tested_pixels},
                      {"tested_values", z.tested},
                      {"not_testable_values", z.not_testable},
                      {"largest_z", z.largest},
                      {"pixel", {z.largest_x, z.largest_y}},
                      {"channel", z.largest_channel},
                      {"limit", z.limit},
                      {"mean_square", z.mean_square}};
  }
  if (view.a_to_reference) {
    const PictureError &a = *view.a_to_reference, &b = *view.b_to_reference;
    json["against_reference"] = {{"a", error_json(a)},
                                 {"b", error_json(b)},
                                 {"ratio",
                                  {{"mse", ratio(a.mse, b.mse)},
                                   {"rmse", ratio(a.rmse, b.rmse)},
                                   {"relative_mse", ratio(a.relative_mse, b.relative_mse)},
                                   {"relative_rmse", ratio(a.relative_rmse, b.relative_rmse)}}}};
  }
  return json;
}

}  // namespace

const PictureLayer* NamedPicture::layer(const std::string& name) const {
  const auto found = std::find_if(picture.layers.begin(), picture.layers.end(),
                                  [&](const PictureLayer& candidate) { return candidate.name == name; });
  return found == picture.layers.end() ? nullptr : &*found;
}

bool ViewComparison::has_faults() const {
  return error.not_finite > 0 || (is_colour && not_finite_a + not_finite_b > 0);
}

Comparison compare_pictures(const NamedPicture& a, const NamedPicture& b, const NamedPicture* reference,
                            const std::vector<std::string>& wanted, const ComparisonSettings& settings) {
  std::vector<const NamedPicture*> pictures{&a, &b};
  if (reference) pictures.push_back(reference);
  for (const NamedPicture* picture : pictures) check_same_size(*picture, a);

  const int width = a.picture.width, height = a.picture.height;
  Comparison comparison{a.file, b.file, reference ? reference->file : "", width, height, settings, {}};
  for (const std::string& name : wanted.empty() ? common_layers(pictures) : wanted) {
    const PictureLayer& layer_a = needed_layer(a, name, nullptr);
    const PictureLayer& layer_b = needed_layer(b, name, &layer_a);
    const auto error_to = [&](const PictureLayer& layer, const PictureLayer& truth) {
      return values_error(layer.values, truth.values, width, height, layer.channels, settings.epsilon);
    };
    ViewComparison view;
    view.name = name;
    view.channels = layer_a.channels;
    view.is_colour = layer_a.is_colour;
    view.error = error_to(layer_a, layer_b);
    const size_t pixel = size_t(view.error.maximum_y) * size_t(width) + size_t(view.error.maximum_x);
    const size_t largest = pixel * size_t(view.channels) + size_t(view.error.maximum_channel);
    view.largest_a = layer_a.values[largest];
    view.largest_b = layer_b.values[largest];
    view.not_finite_a = pixels_not_finite(layer_a.values, view.channels);
    view.not_finite_b = pixels_not_finite(layer_b.values, view.channels);
    view.z_test = z_test_of(a, b, layer_a, layer_b, settings);
    if (reference) {
      const PictureLayer& truth = needed_layer(*reference, name, &layer_a);
      view.a_to_reference = error_to(layer_a, truth);
      view.b_to_reference = error_to(layer_b, truth);
    }
    comparison.views.push_back(std::move(view));
  }
  return comparison;
}

const std::vector<Measure>& measures() {
  using View = const ViewComparison&;
  static const std::vector<Measure> all{
      {"mse", "mean of (a - b)^2 over all pixels and channels", [](View v) { return v.error.mse; }},
      {"rmse", "square root of mse", [](View v) { return v.error.rmse; }},
      {"relmse", "mean of (a - b)^2 / (b^2 + epsilon)", [](View v) { return v.error.relative_mse; }},
      {"relrmse", "square root of relmse", [](View v) { return v.error.relative_rmse; }},
      {"max", "largest |a - b| of any pixel and channel", [](View v) { return v.error.maximum; }},
      {"mean", "|mean of A / mean of B - 1|",
       [](View v) { return std::abs(ratio(v.error.mean, v.error.truth_mean) - 1.0); }},
      {"pixels", "number of pixels that differ in any bit",
       [](View v) { return static_cast<double>(v.error.differing_pixels); }},
      {"z", "the z-test's p-value by Sidak; exceeded by less than VALUE, the false-alarm rate",
       [](View v) {
         return v.z_test->not_testable > 0 ? std::numeric_limits<double>::quiet_NaN() : v.z_test->p_value;
       },
       true},
  };
  return all;
}

Threshold threshold_of(const std::string& text) {
  const std::string place = "--threshold " + text;
  const size_t equals = text.find('=');
  if (equals == std::string::npos)
    throw Error({place}, "there is no '='", "write --threshold NAME=VALUE, as in --threshold rmse=1e-3");
  const std::string name = text.substr(0, equals);
  std::vector<std::string> names;
  for (const Measure& measure : measures()) {
    names.push_back(measure.name);
    if (measure.name != name) continue;
    const double most = measure.is_p_value ? 1.0 : std::numeric_limits<double>::max();
    return {&measure, real_number(place, text.substr(equals + 1), 0.0, most), text};
  }
  throw Error({place}, "there is no such measure", suggestion(name, names, "measures"));
}

std::vector<Verdict> verdicts(const Comparison& comparison, const std::vector<Threshold>& thresholds) {
  std::vector<Verdict> all;
  for (const Threshold& threshold : thresholds) {
    const Measure& measure = *threshold.measure;
    const size_t before = all.size();
    for (const ViewComparison& view : comparison.views) {
      if (!measure.applies_to(view)) continue;
      const double value = measure.value(view);
      const bool is_kept = measure.is_p_value ? value >= threshold.limit : value <= threshold.limit;
      all.push_back({&threshold, &view, value, !is_kept || view.has_faults()});
    }
    if (all.size() == before)
      throw Error({"--threshold " + threshold.text},
                  "the pictures do not tell the errors of their beauty, so there is no z-test",
                  "compare EXR pictures that both have the layers beauty and error");
  }
  return all;
}

bool is_any_exceeded(const std::vector<Verdict>& all) {
  return std::any_of(all.begin(), all.end(), [](const Verdict& verdict) { return verdict.is_exceeded; });
}

std::string comparison_text(const Comparison& comparison, const std::vector<Verdict>& all) {
  std::string text = "A  " + comparison.a + "\nB  " + comparison.b + "\n";
  if (!comparison.reference.empty()) text += "R  " + comparison.reference + "\n";
  text += printed("%d x %d pixels\n", comparison.width, comparison.height);
  for (const ViewComparison& view : comparison.views) text += view_text(view, comparison);
  if (!all.empty()) text += "\n";
  for (const Verdict& verdict : all) {
    text += "threshold " + verdict.threshold->text + ": " + (verdict.is_exceeded ? "EXCEEDED" : "kept") + " in " +
            verdict.view->name + printed(", %.6g", verdict.value) +
            (verdict.view->has_faults() ? ", with pixels that are not finite" : "") + "\n";
  }
  return text;
}

std::string comparison_report(const Comparison& comparison, const std::vector<Verdict>& all) {
  nlohmann::ordered_json json;
  json["vitrum"] = version();
  json["a"] = comparison.a;
  json["b"] = comparison.b;
  if (!comparison.reference.empty()) json["reference"] = comparison.reference;
  json["size"] = {comparison.width, comparison.height};
  json["epsilon"] = comparison.settings.epsilon;
  for (const ViewComparison& view : comparison.views) json["views"][view.name] = view_json(view, comparison.settings);
  json["thresholds"] = nlohmann::ordered_json::array();
  for (const Verdict& verdict : all) {
    json["thresholds"].push_back({{"measure", verdict.threshold->measure->name},
                                  {"limit", verdict.threshold->limit},
                                  {"view", verdict.view->name},
                                  {"value", verdict.value},
                                  {"exceeded", verdict.is_exceeded}});
  }
  json["exceeded"] = is_any_exceeded(all);
  // Names of files and layers may be no UTF-8.
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace vitrum
