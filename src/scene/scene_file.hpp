#pragma once
// Scene files: TOML to Scene (docs/scene-file.md is the format).

#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace vitrum {

/// Reads a scene file, the OBJ and MTL files that it names, and applies `overrides` ("KEY=VALUE", as after --set: VALUE
/// is TOML; text that is no TOML counts as a string where the key wants one; integers serve as floats) before anything
/// is interpreted. Textures are checked to be there; load_textures reads them. Throws Error with file, line and column;
/// errors in an override name it as "--set KEY=VALUE".
Scene load_scene(const std::string& path, const std::vector<std::string>& overrides = {});

}  // namespace vitrum
