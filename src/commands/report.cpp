#include "commands/report.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/version.hpp"

namespace vitrum {
namespace {

using nlohmann::ordered_json;

ordered_json numbers(const Spectrum& s) {
  ordered_json values = ordered_json::array();
  for (int c = 0; c < 3; ++c) values.push_back(std::isfinite(s[c]) ? ordered_json(s[c]) : ordered_json(nullptr));
  return values;
}

/// Mean and greatest magnitude of a picture's values, 3 to a pixel; null where a value is not finite.
ordered_json summary(const std::vector<double>& values, int width) {
  double sum = 0.0;
  size_t worst = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    sum += values[i];
    if (std::abs(values[i]) > std::abs(values[worst])) worst = i;
  }
  const size_t pixel = worst / 3, columns = static_cast<size_t>(width);
  return {{"mean", sum / static_cast<double>(values.size())},
          {"worst_pixel", values[worst]},
          {"pixel", {pixel % columns, pixel / columns}}};
}

/// What is to be known of the photons' estimate: its radius, its noise and, where its view was asked for, its bias.
ordered_json photon_estimate(const Scene& scene, const RenderResult& result) {
  const bool nearest = scene.photons.estimate == PhotonEstimate::nearest;
  const double photons = result.photons_in_estimate();
  // Of n photons the circle has the relative error 1 / sqrt(n), Epanechnikov's kernel, whose mean square is 4/3 of its
  // squared mean, sqrt(4 / (3 n)). Photons of a lattice tell nothing by their number.
  const double noise = std::sqrt((nearest ? 1.0 : 4.0 / 3.0) / photons);
  ordered_json json = {{"radius_m", result.photon_radius},
                       {"photons", photons},
                       {"noise", photons > 0.0 && !result.features.footprints ? ordered_json(noise) : ordered_json(nullptr)}};
  const std::vector<double> bias = result.film.mean("bias"), variance = result.film.variance_of_mean("bias");
  if (variance.empty()) return json;
  json["bias"] = summary(bias, result.film.width());
  // The bias is seen through noise, whose mean square is known.
  double squares = 0.0, noise_squares = 0.0;
  for (size_t i = 0; i < bias.size(); ++i) {
    squares += bias[i] * bias[i];
    noise_squares += variance[i];
  }
  const double count = static_cast<double>(bias.size());
  json["bias"]["rms"] = std::sqrt(std::max(squares - noise_squares, 0.0) / count);
  json["bias"]["rms_of_noise"] = std::sqrt(noise_squares / count);
  return json;
}

/// How rendering to an error or a time limit went.
ordered_json rounds_json(const Scene& scene, const RoundsResult& rounds) {
  using End = RoundsResult::End;
  const RelativeError& error = rounds.error;
  const auto limit = [](double value) { return value > 0.0 ? ordered_json(value) : ordered_json(nullptr); };
  return {{"ended_by", rounds.end == End::target ? "target_error" : rounds.end == End::time ? "time_limit" : "most footprints"},
          {"target_error", limit(scene.render.target_error)},
          {"time_limit_s", limit(scene.render.time_limit)},
          {"rounds", rounds.rounds},
          {"relative_error", error.value},
          {"interval", {error.low, error.high}},
          {"confidence", RoundsResult::confidence},
          {"noise", error.noise},
          {"bias", error.bias_known ? ordered_json(error.bias) : ordered_json(nullptr)}};
}

const char* name_of(Sampling sampling) {
  return sampling == Sampling::independent ? "independent" : "low-discrepancy";
}

const char* name_of(PhotonEstimate estimate) {
  switch (estimate) {
    case PhotonEstimate::automatic: return "automatic";
    case PhotonEstimate::automatic_radius: return "automatic_radius";
    case PhotonEstimate::fixed_radius: return "radius";
    case PhotonEstimate::nearest: return "nearest";
    case PhotonEstimate::footprints: return "footprints";
  }
  return "";
}

}  // namespace

std::string render_report(const Scene& scene, const Device& device, const RenderResult& result) {
  ordered_json json;
  json["vitrum"] = version();
  json["scene"] = scene.file;
  json["settings"] = {
      {"size", {scene.film.width, scene.film.height}},
      {"samples", result.samples},
      {"passes", result.passes},
      {"seed", scene.render.seed},
      {"sampling", name_of(scene.render.sampling)},
      {"max_depth", scene.render.max_depth},
      {"min_weight", scene.render.min_weight},
  };
  if (scene.render.constant_reflectance)
    json["settings"]["reflectance"] = *scene.render.constant_reflectance;
  else
    json["settings"]["reflectance"] = "fresnel";
  if (result.features.caustics)
    json["settings"]["photons"] = {{"count", result.rounds ? result.photons.photons_shot : scene.photons.count},
                                   {"sampling", name_of(scene.photons.sampling)},
                                   {"estimate", name_of(scene.photons.estimate)},
                                   {"radius_m", result.photon_radius},
                                   {"progressive", scene.photons.progressive},
                                   {"max_depth", scene.photons.max_depth}};
  json["device"] = {{"name", device.info().name},
                    {"platform", device.info().platform},
                    {"version", device.info().version},
                    {"driver", device.info().driver},
                    {"compute_units", device.info().compute_units},
                    {"rays_per_work_item", device.width()}};
  json["features"] = result.features.names();
  json["seconds"] = result.seconds;
  json["cpu_seconds"] = result.cpu_seconds;
  json["rays"] = {{"camera", result.rays.camera},
                  {"secondary", result.rays.secondary},
                  {"shadow", result.rays.shadow},
                  {"photon", result.photons.surfaces_met}};
  if (result.features.caustics) {
    const PhotonBalance& p = result.photons;
    json["photons"] = {{"shot", p.photons_shot},         {"stored", p.photons_stored}, {"absorbed", p.photons_absorbed},
                       {"direct", p.photons_direct},     {"lost", p.photons_lost},     {"cut", p.photons_cut},
                       {"branched", p.photons_branched}, {"rejected", p.photons_rejected}};
    json["photon_power_watts"] = {{"shot", numbers(p.shot)},     {"stored", numbers(p.stored)},
                                  {"absorbed", numbers(p.absorbed)}, {"direct", numbers(p.direct)},
                                  {"lost", numbers(p.lost)},     {"cut", numbers(p.cut)},
                                  {"split", numbers(p.split)},
                                  {"not_aimed", numbers(p.not_aimed)}};
    json["photon_estimate"] = photon_estimate(scene, result);
  }
  const std::vector<double> cut = result.film.mean("cut");
  double sum = 0.0;
  for (double value : cut) sum += value;
  json["cut_weight"] = {{"mean", cut.empty() ? 0.0 : sum / static_cast<double>(cut.size())},
                        {"worst_pixel", cut.empty() ? 0.0 : *std::max_element(cut.begin(), cut.end())}};
  json["cut_radiance"] = summary(cut_radiance(result.film, result.limit), result.film.width());
  json["cut_radiance"]["limit"] = numbers(result.limit.radiance);
  json["cut_radiance"]["is_bound"] = result.limit.is_bound;
  if (const std::vector<double> error = result.standard_error(); !error.empty()) {
    json["standard_error"] = summary(error, result.film.width());
    json["standard_error"]["degrees_of_freedom"] = result.film.replicates() - 1;
  }
  if (result.rounds) json["rounds"] = rounds_json(scene, *result.rounds);
  json["rejected_values"] = result.rejected_values;
  json["memory_bytes"] = result.memory;
  return json.dump(2) + "\n";
}

}  // namespace vitrum
