#include "core/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "core/log.hpp"

namespace vitrum {
namespace {

constexpr auto interval = std::chrono::milliseconds(100);

/// "2 h 5 min", without the smaller part if it is 0.
std::string two_units(long large, const char* large_unit, long small, const char* small_unit) {
  std::string text = std::to_string(large) + ' ' + large_unit;
  if (small > 0) text += ' ' + std::to_string(small) + ' ' + small_unit;
  return text;
}

}  // namespace

std::string duration_text(double seconds) {
  const long whole_seconds = std::lround(std::ceil(std::min(seconds, 1e9)));
  if (whole_seconds < 60) return std::to_string(whole_seconds) + " s";
  if (whole_seconds < 3600) return two_units(whole_seconds / 60, "min", whole_seconds % 60, "s");
  const long minutes = (whole_seconds + 59) / 60;
  if (minutes < 24 * 60) return two_units(minutes / 60, "h", minutes % 60, "min");
  const long hours = (minutes + 59) / 60;
  return two_units(hours / 24, "d", hours % 24, "h");
}

std::string progress_text(const std::string& what, double done, double elapsed) {
  done = std::clamp(done, 0.0, 1.0);
  std::string text = what + "  " + std::to_string(int(100 * done)) + " %";
  if (done >= 0.02 && elapsed >= 0.5) text += ", " + duration_text(elapsed * (1 - done) / done) + " left";
  return text;
}

Progress::Progress(std::string what) : what_(std::move(what)), is_shown_(!quiet() && ::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (has_line_) std::fputs("\r\x1b[K", stderr);
}

void Progress::update(double done) {
  if (!is_shown_) return;
  const auto now = Clock::now();
  if (now - last_ < interval) return;
  last_ = now;
  has_line_ = true;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  std::fprintf(stderr, "\r\x1b[K%s", progress_text(what_, done, elapsed).c_str());
  std::fflush(stderr);
}

}  // namespace vitrum
