#include "core/version.hpp"

namespace vitrum {

const char* version() { return VITRUM_VERSION; }

}  // namespace vitrum
