#pragma once
// Text by printf's formats.

#include <string>

namespace vitrum {

/// What printf would print.
std::string printed(const char* format, ...) __attribute__((format(printf, 1, 2)));

}  // namespace vitrum
