#pragma once
// Checks that something is refused: what the message says, at which place, and that it has a mend.

#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include "core/error.hpp"

/// `action` must throw vitrum::Error at `place` ("a.obj:3:7", the file without folders) with `problem` in its text.
template <typename Action>
void check_refused(const Action& action, const std::string& place, const std::string& problem) {
  CAPTURE(place);
  CAPTURE(problem);
  try {
    action();
  } catch (const vitrum::Error& error) {
    vitrum::SourceLocation where = error.where();
    where.file = std::filesystem::path(where.file).filename().string();
    CHECK(vitrum::to_string(where) == place);
    CHECK_MESSAGE(error.problem().find(problem) != std::string::npos, error.what());
    CHECK_FALSE(error.mend().empty());
    return;
  }
  FAIL_CHECK("it was not refused");
}
