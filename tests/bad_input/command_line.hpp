#pragma once
// Command lines for vitrum, and the check that one is refused.

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "vitrum_process.hpp"

using Words = std::vector<std::string>;

inline Words operator+(Words a, const Words& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

inline bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// A run with `words` must be refused at `place`, for a `problem`, with a `mend`, in one line and nothing else.
inline void check_refused(const Words& words, const std::string& place, const std::string& problem,
                          const std::string& mend, const Words& settings = {}) {
  const Ended run = vitrum_run(words, settings);
  CAPTURE(run.err);
  CHECK(run.code > 0);
  CHECK(run.out.empty());
  const std::string start = "vitrum: error: " + (place.empty() ? "" : place + ": ");
  CAPTURE(start);
  CHECK(run.err.rfind(start, 0) == 0);
  const size_t at = run.err.find(problem);
  CHECK_MESSAGE(at != std::string::npos, problem);
  if (at != std::string::npos) CHECK_MESSAGE(contains(run.err.substr(at), "; " + mend), mend);
  CHECK(run.err.find('\n') == run.err.size() - 1);
}
