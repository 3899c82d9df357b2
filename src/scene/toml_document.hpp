#pragma once
// TOML text to toml++'s tree, whatever the text: sizes and depths are bounded, every error is a vitrum::Error.

#include <string>
#include <string_view>

#include <toml++/toml.h>

#include "core/error.hpp"

namespace vitrum {

/// Begins the `source` of every node that comes from an override: "--set KEY=VALUE".
inline constexpr std::string_view override_prefix = "--set ";

/// Reads and parses a TOML file of at most 16 MiB. Throws Error for what is no file, no text or no TOML.
toml::table read_toml_file(const std::string& path);

/// Parses TOML text; `source` is the file's name in errors and in every node's place. Throws Error, also for text
/// nested so deep that toml++, which recurses, might exhaust the stack.
toml::table parse_toml(std::string_view text, const std::string& source);

/// The place that toml++ noted. A place in an override has no line: the override itself says where it is.
SourceLocation location(const toml::source_region& region);

/// True for places within an override.
bool is_override(const SourceLocation& where);

}  // namespace vitrum
