#include "commands/scene_arguments.hpp"

#include "core/error.hpp"
#include "scene/scene_file.hpp"

namespace vitrum {
namespace {

bool is_number(const std::string& text) {
  return !text.empty() && text.size() < 19 && text.find_first_not_of("0123456789") == std::string::npos;
}

std::string count_option(const std::string& option, const std::string& key, const std::string& value) {
  if (!is_number(value))
    throw Error({option + " " + value, 0, 0}, "this is no whole number", "write for example " + option + " 16");
  return key + "=" + value;
}

}  // namespace

void SceneArguments::add_to(CLI::App& command) {
  command.add_option("SCENE", scene, "Scene file (TOML; docs/scene-file.md)")->required();
  command.add_option("--set", sets, "Set any key of the scene file: KEY=VALUE, as in render.reflectance=0.1 (repeatable)")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command.add_option("--samples", samples, "Samples per pixel; 1 is the centre of the pixel")->type_name("N");
  command.add_option("--photons", photons, "Photons to shoot; 0: no caustics")->type_name("N");
  command.add_option("--seed", seed, "Seed of all random numbers")->type_name("N");
  command.add_option("--size", size, "Size of the picture in pixels")->type_name("WxH");
}

Scene SceneArguments::load() const {
  std::vector<std::string> overrides = sets;
  if (!samples.empty()) overrides.push_back(count_option("--samples", "render.samples", samples));
  if (photons == "0") {
    overrides.push_back("render.caustics=false");
  } else if (!photons.empty()) {
    overrides.push_back(count_option("--photons", "photons.count", photons));
  }
  if (!seed.empty()) overrides.push_back(count_option("--seed", "render.seed", seed));
  if (!size.empty()) {
    const size_t x = size.find('x');
    if (x == std::string::npos || !is_number(size.substr(0, x)) || !is_number(size.substr(x + 1)))
      throw Error({"--size " + size, 0, 0}, "this is no size", "write width and height in pixels, as in --size 640x480");
    overrides.push_back("film.size=[" + size.substr(0, x) + "," + size.substr(x + 1) + "]");
  }
  return load_scene(scene, overrides);
}

}  // namespace vitrum
