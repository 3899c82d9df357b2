#include "core/error.hpp"

#include <utility>

namespace vitrum {

std::string to_string(const SourceLocation& where) {
  std::string text = where.file;
  if (where.line > 0) text += ':' + std::to_string(where.line);
  if (where.line > 0 && where.column > 0) text += ':' + std::to_string(where.column);
  return text;
}

namespace {
std::string message(const SourceLocation& where, const std::string& problem, const std::string& mend) {
  std::string text = to_string(where);
  if (!text.empty()) text += ": ";
  text += problem;
  if (!mend.empty()) text += "; " + mend;
  return text;
}
}  // namespace

Error::Error(SourceLocation where, std::string problem, std::string mend)
    : std::runtime_error(message(where, problem, mend)),
      where_(std::move(where)),
      problem_(std::move(problem)),
      mend_(std::move(mend)) {}

}  // namespace vitrum
