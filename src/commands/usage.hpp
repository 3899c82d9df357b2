#pragma once
// What the command line itself gets wrong: words that are no command or option, values that are no numbers.

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

#include "core/error.hpp"

namespace vitrum {

/// What CLI11 found wrong, as an Error that names the word and the nearest word that would do. `app` has parsed already.
Error usage_error(const CLI::App& app, const CLI::ParseError& error);

/// The whole number of `text`, from `least` to `most`. Throws Error at "OPTION TEXT" for anything else.
uint64_t whole_number(const std::string& option, const std::string& text, uint64_t least, uint64_t most);

/// The number of `text`, from `least` to `most`, as in "0.001" or "1e-3". Throws Error at `place` for anything else.
double real_number(const std::string& place, const std::string& text, double least, double most);

}  // namespace vitrum
