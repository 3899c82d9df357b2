#pragma once
// The arguments that say which scene and how it differs from its file; `render` and `info` share them.

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace vitrum {

struct SceneArguments {
  std::string scene;
  std::vector<std::string> sets;      ///< --set KEY=VALUE
  std::optional<std::string> samples, photons, target_error, time_limit, seed, size;

  /// Adds SCENE, --set, --samples, --photons, --target-error, --time-limit, --seed and --size to a command.
  void add_to(CLI::App& command);
  /// Reads the scene with everything that the command line says about it. --samples and its like are short for --set,
  /// and come after it. Throws Error.
  Scene load() const;
};

}  // namespace vitrum
