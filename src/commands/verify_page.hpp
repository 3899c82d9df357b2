#pragma once
// `vitrum verify --report-html`.

#include <string>

#include "commands/verify_run.hpp"

namespace vitrum {

/// One HTML page with nothing beside it: the table, the plots, the pictures.
std::string verify_page(const VerifyRun& run);

}  // namespace vitrum
