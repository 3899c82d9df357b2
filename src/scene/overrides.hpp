#pragma once
// --set KEY=VALUE: changes to a scene file's tree before anything in it is interpreted.

#include <string>

#include "scene/toml_document.hpp"

namespace vitrum {

/// Lays "KEY=VALUE" over `root`: KEY is a dotted TOML key, absent tables are made; VALUE is TOML and replaces what
/// KEY held, tables whole. Text that is no TOML becomes a string. Every new node's place is "--set KEY=VALUE".
/// Throws Error for a key that is none, or that leads through what is no table.
void apply_override(toml::table& root, const std::string& override_text);

}  // namespace vitrum
