#pragma once
// The one error type of vitrum: where the trouble is, what it is, and how to mend it.

#include <stdexcept>
#include <string>

namespace vitrum {

/// A place in a text file. Lines and columns count from 1; 0 means that the place is the file as a whole.
struct SourceLocation {
  std::string file;
  int line = 0;
  int column = 0;
};

/// "file:line:column", leaving out what is 0 or empty.
std::string to_string(const SourceLocation& where);

/// Thrown for whatever the user can mend: bad input, a missing device, a place that cannot be written.
/// Our own bugs are asserts. `what()` is the whole message: "file:line:column: what; mend".
class Error : public std::runtime_error {
 public:
  /// `what` says what is wrong, `mend` what the user can do about it; neither ends in a full stop.
  Error(SourceLocation where, std::string what, std::string mend);

  const SourceLocation& where() const { return where_; }
  const std::string& problem() const { return problem_; }
  const std::string& mend() const { return mend_; }

 private:
  SourceLocation where_;
  std::string problem_;
  std::string mend_;
};

}  // namespace vitrum
