#include "commands/scene_arguments.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "commands/usage.hpp"
#include "core/error.hpp"
#include "core/printed.hpp"
#include "scene/scene_file.hpp"

namespace vitrum {
namespace {

/// The digits of a whole number, without zeros in front; what range it must have is the scene's business.
std::string digits(const std::string& option, const std::string& text) {
  return std::to_string(whole_number(option, text, 0, std::numeric_limits<int64_t>::max()));
}

/// A number as TOML has it; what range it must have is the scene's business.
std::string decimal(const std::string& option, const std::string& text) {
  double number = 0.0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (failure != std::errc() || end != text.data() + text.size() || !std::isfinite(number))
    throw Error({option + " " + text}, "this is no number", "write one, as in 0.02 or 60");
  return printed("%.17g", number);
}

/// "[640,480]" of "640x480".
std::string pixels(const std::string& size) {
  const size_t x = size.find('x');
  const auto is_number = [](const std::string& text) {
    return !text.empty() && text.size() < 10 && text.find_first_not_of("0123456789") == std::string::npos;
  };
  if (x == std::string::npos || !is_number(size.substr(0, x)) || !is_number(size.substr(x + 1)))
    throw Error({"--size " + size}, "this is no size", "write width and height in pixels, as in --size 640x480");
  return "[" + digits("--size", size.substr(0, x)) + "," + digits("--size", size.substr(x + 1)) + "]";
}

}  // namespace

void SceneArguments::add_to(CLI::App& command) {
  command.add_option("SCENE", scene, "Scene file (TOML; docs/scene-file.md)")->required()->type_name("");
  command.add_option("--set", sets, "Set any key of the scene file: KEY=VALUE, as in render.reflectance=0.1 (repeatable)")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command.add_option("--samples", samples, "Samples per pixel; 1 is the centre of the pixel")->type_name("N");
  command.add_option("--photons", photons, "Photons to shoot; 0: no caustics")->type_name("N");
  command.add_option("--target-error", target_error,
                     "Go on until the picture's relative error is estimated to be below E, as in 0.02: samples and\n"
                     "photons go where the error is, in place of --samples and --photons (docs/errors.md)")
      ->type_name("E");
  command.add_option("--time-limit", time_limit, "The same until so many seconds are over, or what comes first of both")
      ->type_name("S");
  command.add_option("--seed", seed, "Seed of all random numbers")->type_name("N");
  command.add_option("--size", size, "Size of the picture in pixels")->type_name("WxH");
}

Scene SceneArguments::load() const {
  std::vector<std::string> overrides = sets;
  std::map<std::string, std::string> places;  // of what an option stands for: the option as it was written
  const auto set = [&](const std::string& override_text, const std::string& option) {
    overrides.push_back(override_text);
    places["--set " + override_text] = option;
  };
  for (const auto& [option, key, value] : {std::tuple{"--target-error", "target_error", target_error},
                                           std::tuple{"--time-limit", "time_limit", time_limit}}) {
    if (!value) continue;
    const std::string place = option + (" " + *value);
    for (const auto& [other, number] : {std::pair{"--samples", samples}, std::pair{"--photons", photons}})
      if (number && *number != "0")
        throw Error({place}, std::string("does not go with ") + other, "leave one of them out: with it, samples and photons are as many as it takes");
    set(std::string("render.") + key + "=" + decimal(option, *value), place);
  }
  if (samples) set("render.samples=" + digits("--samples", *samples), "--samples " + *samples);
  if (photons) {
    const std::string count = digits("--photons", *photons);
    set(count == "0" ? "render.caustics=false" : "photons.count=" + count, "--photons " + *photons);
  }
  if (seed) set("render.seed=" + digits("--seed", *seed), "--seed " + *seed);
  if (size) set("film.size=" + pixels(*size), "--size " + *size);
  try {
    return load_scene(scene, overrides);
  } catch (const Error& error) {
    const auto place = places.find(error.where().file);
    if (place == places.end()) throw;
    throw Error({place->second}, error.problem(), error.mend());
  }
}

}  // namespace vitrum
