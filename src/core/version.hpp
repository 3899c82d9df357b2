#pragma once

namespace vitrum {

/// Version of vitrum, "major.minor.patch".
const char* version();

}  // namespace vitrum
