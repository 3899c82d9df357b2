#pragma once
// A line on the terminal that says how far the work is and how long it will still take.

#include <chrono>
#include <string>

namespace vitrum {

/// The line for `done` of 0..1 after `elapsed` seconds: "camera  42 %, 1 min 20 s left". There is no estimate before
/// 2 % or half a second, which are too little to go by. `what` is the name of the stage.
std::string progress_text(const std::string& what, double done, double elapsed);

/// "0 s", "59 s", "1 min 20 s", "2 h 5 min", "3 d 4 h": rounded up to the unit that matters. `seconds` >= 0.
std::string duration_text(double seconds);

/// Shows progress on standard error if that is a terminal and notes are not silenced; else it does nothing.
/// The line is rewritten at most ten times a second, and erased at the end. Used by one thread at a time.
class Progress {
 public:
  /// `what` names the stage, as in "camera".
  explicit Progress(std::string what);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Says that the fraction `done` of the work, 0..1, is finished.
  void update(double done);

 private:
  using Clock = std::chrono::steady_clock;

  std::string what_;
  bool is_shown_;
  bool has_line_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_ = start_;
};

}  // namespace vitrum
