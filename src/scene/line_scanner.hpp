#pragma once
// The text of OBJ and MTL files, line by line and word by word, each with its place. The guards against what is no
// such text (folders, pipes, devices, UTF-16, binary formats, Git LFS pointers) are here.

#include <charconv>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/error.hpp"

namespace vitrum {

/// Reads a text file through a window that slides over it, so that its size costs no memory and a file that shrinks
/// meanwhile is harmless. Lines end in LF, CR LF or CR; a backslash at a line's end joins it with the next;
/// `#` begins a comment; a byte order mark of UTF-8 is skipped.
class LineScanner {
 public:
  /// Opens `path`. `format` ("OBJ", "MTL") appears in messages. Throws Error for what is no regular text file or is
  /// larger than `max_bytes`.
  LineScanner(std::string path, std::string format, uint64_t max_bytes);
  ~LineScanner();
  LineScanner(const LineScanner&) = delete;
  LineScanner& operator=(const LineScanner&) = delete;

  /// Goes to the next line that holds more than a comment; false at the end of the file. Views of the line before die.
  bool next_line();

  /// First word of the line.
  std::string_view keyword() const { return keyword_; }

  /// Next word of the line, empty at its end.
  std::string_view next_word() {
    skip_space();
    const char* const begin = cursor_;
    const char* c = begin;
    while (c != end_ && !is_delimiter(*c)) ++c;
    cursor_ = c;
    return {begin, static_cast<size_t>(c - begin)};
  }

  /// The word that next_word would give.
  std::string_view peek_word() {
    const char* before = cursor_;
    const std::string_view word = next_word();
    cursor_ = before;
    return word;
  }

  /// Where the next word begins and the line ends, for those who take words apart themselves and then say how far
  /// they came.
  struct Ahead {
    const char *begin, *end;
  };
  Ahead ahead() {
    skip_space();
    return {cursor_, end_};
  }
  void go_on_from(const char* place) { cursor_ = place; }

  /// Whether a word ends before `place`: at white space, a comment, or the line's end.
  bool is_word_end(const char* place) const { return place == end_ || is_delimiter(*place); }

  /// Next number of the line, nothing at its end. Throws Error for what is no finite number of that type.
  /// Locale-free and correctly rounded (std::from_chars).
  template <typename Number>
  std::optional<Number> next_number() {
    skip_space();
    if (cursor_ == end_ || *cursor_ == '#') return std::nullopt;
    Number value;
    const auto [stop, problem] = std::from_chars(cursor_, end_, value);
    if (problem == std::errc{} && is_word_end(stop) && std::isfinite(value)) [[likely]] {
      cursor_ = stop;
      return value;
    }
    return static_cast<Number>(unusual_number(sizeof(Number) == sizeof(float)));
  }

  /// All that is left of the line, as names and paths are written: inner spaces kept, outer ones cut, and `#` a comment
  /// only between white space, so that "Material #25" is a name.
  std::string_view rest();

  /// The text of the whole line, without what rest() cuts.
  std::string_view line() const;

  /// Place of the line's keyword.
  SourceLocation where() const { return where(keyword_); }
  /// Place of a word of this line.
  SourceLocation where(std::string_view word) const;

  /// Throws Error at a word of this line, or at its keyword if the word is empty.
  [[noreturn]] void fail(std::string_view word, const std::string& problem, const std::string& mend) const;

  /// Name of the file as it was given.
  const std::string& path() const { return path_; }

 private:
  static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
  static bool is_delimiter(char c) { return is_space(c) || c == '#'; }
  void skip_space() {
    const char* c = cursor_;
    while (c != end_ && is_space(*c)) ++c;
    cursor_ = c;
  }
  bool fetch_line();
  bool continues(size_t begin, size_t line_break);
  bool refill();
  void check_first_bytes();
  double unusual_number(bool single_precision);
  [[noreturn]] void fail_file(const std::string& problem, const std::string& mend) const;

  std::string path_, format_;
  uint64_t max_bytes_, bytes_read_ = 0;
  int file_ = -1;
  bool at_end_ = false, breaks_are_cr_ = false;
  std::unique_ptr<char[]> buffer_;
  size_t capacity_ = 0, filled_ = 0, next_ = 0;  // bytes; next_: where the next line starts
  int line_number_ = 0, next_line_number_ = 1;
  char *begin_ = nullptr;                        // the line, its continuations included
  const char *cursor_ = nullptr, *end_ = nullptr;
  std::string_view keyword_;
};

/// `text` in quotes, for messages: cut when long, with control characters as '?'.
std::string quoted(std::string_view text);

}  // namespace vitrum
