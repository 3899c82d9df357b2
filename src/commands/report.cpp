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

const char* name_of(Sampling sampling) {
  return sampling == Sampling::independent ? "independent" : "low-discrepancy";
}

const char* name_of(PhotonEstimate estimate) {
  switch (estimate) {
    case PhotonEstimate::automatic: return "automatic";
    case PhotonEstimate::fixed_radius: return "radius";
    case PhotonEstimate::nearest: return "nearest";
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
      {"samples", scene.render.samples},
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
    json["settings"]["photons"] = {{"count", scene.photons.count},
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
                       {"direct", p.photons_direct},     {"lost", p.photons_lost},     {"cut", p.photons_cut}};
    json["photon_power_watts"] = {{"shot", numbers(p.shot)},     {"stored", numbers(p.stored)},
                                  {"absorbed", numbers(p.absorbed)}, {"direct", numbers(p.direct)},
                                  {"lost", numbers(p.lost)},     {"cut", numbers(p.cut)},
                                  {"not_aimed", numbers(p.not_aimed)}};
  }
  const std::vector<double> cut = result.film.mean("cut");
  double sum = 0.0;
  for (double value : cut) sum += value;
  json["cut_weight"] = {{"mean", cut.empty() ? 0.0 : sum / static_cast<double>(cut.size())},
                        {"worst_pixel", cut.empty() ? 0.0 : *std::max_element(cut.begin(), cut.end())}};
  json["memory_bytes"] = result.memory;
  return json.dump(2) + "\n";
}

}  // namespace vitrum
