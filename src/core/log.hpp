#pragma once
// Warnings and notes for the user, on standard error, so that standard output stays a result.

#include <string>

#include "core/error.hpp"

namespace vitrum {

/// Prints "warning: file:line: text" once to standard error. Warnings are printed also with --quiet.
void warn(const SourceLocation& where, const std::string& text);

/// Prints a note to standard error, unless set_quiet(true) was called.
void note(const std::string& text);

/// Silences notes (not warnings).
void set_quiet(bool quiet);

/// True when notes are silenced.
bool quiet();

}  // namespace vitrum
