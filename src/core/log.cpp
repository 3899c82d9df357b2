#include "core/log.hpp"

#include <atomic>
#include <cstdio>

namespace vitrum {
namespace {
std::atomic<bool> is_quiet{false};
}

void warn(const SourceLocation& where, const std::string& text) {
  const std::string place = to_string(where);
  std::fprintf(stderr, "warning: %s%s%s\n", place.c_str(), place.empty() ? "" : ": ", text.c_str());
}

void note(const std::string& text) {
  if (!is_quiet) std::fprintf(stderr, "%s\n", text.c_str());
}

void set_quiet(bool quiet) { is_quiet = quiet; }

bool quiet() { return is_quiet; }

}  // namespace vitrum
