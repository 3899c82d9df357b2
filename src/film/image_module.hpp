#pragma once
// Finds and opens the image module, once.

#include "core/error.hpp"
#include "film/module/image_module.h"

namespace vitrum {

/// The module's functions. The first call opens it (some .3 s; thread-safe), later calls cost nothing.
/// Throws Error at `asked_by` if there is no module, or one of another version.
const VitrumImageModule& image_module(const SourceLocation& asked_by);

}  // namespace vitrum
