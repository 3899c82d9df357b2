// [render] and [photons].

#include "scene/sections.hpp"

namespace vitrum {
namespace {

const std::vector<std::pair<std::string, Sampling>> samplings{{"low-discrepancy", Sampling::low_discrepancy},
                                                              {"independent", Sampling::independent}};
constexpr int deepest_path = 1000;

}  // namespace

RenderSettings read_render_settings(const TomlTable& table) {
  table.check_keys({}, {"samples", "passes", "seed", "reflectance", "caustics", "lights", "textures", "max_depth",
                        "min_weight", "sampling", "adaptive", "target_error", "time_limit"});
  RenderSettings settings;
  table.integer("samples", settings.samples, 1, 1 << 24);
  table.integer("passes", settings.passes, 1, 1 << 24);
  table.integer("seed", settings.seed, 0, std::numeric_limits<int64_t>::max());
  if (table.is_number("reflectance")) {
    double constant = 0;
    table.number("reflectance", constant, {0, 1});
    settings.constant_reflectance = constant;
  } else {
    std::string model = "fresnel";
    table.text("reflectance", model);
    if (model != "fresnel")
      table.fail("reflectance", "is '" + model + "'", "give \"fresnel\" or a number from 0 to 1, as in 0.1");
  }
  table.flag("caustics", settings.caustics);
  table.flag("lights", settings.lights);
  table.flag("textures", settings.textures);
  table.integer("max_depth", settings.max_depth, 1, deepest_path);
  table.number("min_weight", settings.min_weight, {0, 1});
  table.choice("sampling", settings.sampling, samplings);
  table.flag("adaptive", settings.adaptive);
  table.number("target_error", settings.target_error, {1e-6, 1});
  table.number("time_limit", settings.time_limit, {1e-3, 1e9});
  return settings;
}

PhotonSettings read_photon_settings(const TomlTable& table, const FileContext& context, const RenderSettings& render) {
  table.check_keys({}, {"count", "sampling", "estimate", "radius", "nearest", "max_radius", "progressive", "max_depth"});
  constexpr uint64_t most_photons = 1'000'000'000'000;
  PhotonSettings settings;
  table.integer("count", settings.count, 1, most_photons);
  table.choice("sampling", settings.sampling, samplings);
  table.choice("estimate", settings.estimate,
               {{"automatic", PhotonEstimate::automatic},
                {"automatic_radius", PhotonEstimate::automatic_radius},
                {"radius", PhotonEstimate::fixed_radius},
                {"nearest", PhotonEstimate::nearest},
                {"footprints", PhotonEstimate::footprints}});
  table.length("radius", settings.radius, positive_length, context.metres_per_unit);
  table.integer("nearest", settings.nearest, 1, 1 << 20);
  if (settings.estimate == PhotonEstimate::nearest && settings.nearest > most_nearest_photons)
    table.fail("nearest", "is more than can be searched for (" + std::to_string(most_nearest_photons) + ")",
               "give a smaller number, or use photons.estimate = \"automatic\", which may aim at any number");
  table.length("max_radius", settings.max_radius, positive_length, context.metres_per_unit);
  table.flag("progressive", settings.progressive);
  if (settings.progressive && settings.estimate == PhotonEstimate::nearest)
    table.fail("progressive", "needs a radius that can shrink, which the k nearest photons do not have",
               "use photons.estimate = \"automatic\" or \"radius\" with it");
  if (settings.progressive && settings.estimate == PhotonEstimate::footprints)
    table.fail("progressive", "needs a radius that can shrink, which footprints do not have",
               "leave it out: footprints shrink as photons.count grows");
  if (render.by_rounds()) {
    const std::string problem = std::string("does not go with render.") + (render.target_error > 0.0 ? "target_error" : "time_limit");
    if (settings.estimate == PhotonEstimate::fixed_radius || settings.estimate == PhotonEstimate::nearest)
      table.fail("estimate", problem + ": its error does not fall with the number of photons",
                 "use photons.estimate = \"automatic\" or \"footprints\" with it");
    if (settings.progressive)
      table.fail("progressive", problem + ", which lets the radius shrink as the error wants it", "leave it out");
  }
  table.integer("max_depth", settings.max_depth, 1, deepest_path);
  return settings;
}

}  // namespace vitrum
