#include "scene/line_scanner.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <limits>

namespace vitrum {
namespace {

constexpr size_t window_bytes = size_t{1} << 18;    // fits the second-level cache
constexpr size_t max_line_bytes = size_t{1} << 30;  // columns are int
constexpr size_t max_quoted = 60;

std::string lower_format(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

}  // namespace

std::string quoted(std::string_view text) {
  std::string shown(text.substr(0, max_quoted));
  for (char& c : shown) {
    if (static_cast<unsigned char>(c) < 32 || c == 127) c = '?';
  }
  return "'" + shown + (text.size() > max_quoted ? "...'" : "'");
}

LineScanner::LineScanner(std::string path, std::string format, uint64_t max_bytes)
    : path_(std::move(path)), format_(std::move(format)), max_bytes_(max_bytes) {
  // O_NONBLOCK: opening a pipe must not wait for its writer.
  file_ = ::open(path_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
  if (file_ < 0) {
    const int reason = errno;
    fail_file("cannot read this " + format_ + " file: " + std::strerror(reason),
              reason == ENOENT ? "check the name, which counts from the folder of the file that gives it"
                               : "check the permissions of the file and its folders");
  }
  struct stat status {};
  std::string problem, mend = "name a regular ." + lower_format(format_) + " file";
  if (::fstat(file_, &status) != 0) {
    problem = std::strerror(errno);
  } else if (S_ISDIR(status.st_mode)) {
    problem = "this is a folder, no " + format_ + " file";
  } else if (!S_ISREG(status.st_mode)) {
    problem = "this is a pipe or a device, no " + format_ + " file";
  } else if (static_cast<uint64_t>(status.st_size) > max_bytes_) {
    problem = "this file has more than " + std::to_string(max_bytes_ >> 20) + " MiB, the most for " + format_;
    mend = "check that it is the file meant, or split it";
  }
  if (!problem.empty()) {
    ::close(file_);
    fail_file(problem, mend);
  }
  try {
    refill();
    check_first_bytes();
  } catch (...) {
    ::close(file_);
    throw;
  }
}

LineScanner::~LineScanner() { ::close(file_); }

void LineScanner::check_first_bytes() {
  const std::string_view start(buffer_.get(), filled_);
  if (start.starts_with("\xFF\xFE") || start.starts_with("\xFE\xFF")) {
    fail_file("this file is UTF-16", "save it as UTF-8: iconv -f UTF-16 -t UTF-8");
  }
  if (start.starts_with("version https://git-lfs.github.com/")) {
    fail_file("this is a Git LFS pointer in place of the file itself", "fetch the file: git lfs pull");
  }
  const size_t zero = start.find('\0');
  if (zero != std::string_view::npos) fail_file("this is no text but a binary file", "export it as a text " + format_);
  if (start.starts_with("\xEF\xBB\xBF")) next_ = 3;
  // A CR at the window's end may be half of a CR LF.
  const std::string_view sample = start.substr(0, start.empty() ? 0 : start.size() - 1);
  if (start.find('\n') == std::string_view::npos && sample.find('\r') != std::string_view::npos) {
    breaks_are_cr_ = true;
    std::replace(buffer_.get(), buffer_.get() + filled_, '\r', '\n');
  }
}

/// Slides the window to the line at next_ and reads on; false at the end of the file.
bool LineScanner::refill() {
  const size_t kept = filled_ - next_;
  if (kept >= max_line_bytes) fail_file("a line of more than 1 GiB", "check that this is an " + format_ + " file");
  const size_t wanted = std::max(window_bytes, kept > capacity_ / 2 ? capacity_ * 2 : capacity_);
  if (wanted > capacity_) {
    auto larger = std::make_unique_for_overwrite<char[]>(wanted);
    if (kept > 0) std::memcpy(larger.get(), buffer_.get() + next_, kept);
    buffer_ = std::move(larger);
    capacity_ = wanted;
  } else if (kept > 0) {
    std::memmove(buffer_.get(), buffer_.get() + next_, kept);
  }
  next_ = 0;
  filled_ = kept;
  ssize_t count;
  do {
    count = ::read(file_, buffer_.get() + filled_, capacity_ - filled_);
  } while (count < 0 && errno == EINTR);
  if (count < 0) fail_file(std::string("reading failed: ") + std::strerror(errno), "check the disk");
  at_end_ = count == 0;
  char* fresh = buffer_.get() + filled_;
  filled_ += static_cast<size_t>(count);
  bytes_read_ += static_cast<uint64_t>(count);
  if (bytes_read_ > max_bytes_) {
    fail_file("this file has more than " + std::to_string(max_bytes_ >> 20) + " MiB, the most for " + format_,
              "check that it is the file meant, or split it");
  }
  if (breaks_are_cr_) std::replace(fresh, buffer_.get() + filled_, '\r', '\n');
  const bool is_first = bytes_read_ == static_cast<uint64_t>(count);
  if (!is_first && std::memchr(fresh, 0, static_cast<size_t>(count)) != nullptr) {
    fail_file("this file turns into binary data after line " + std::to_string(next_line_number_),
              "export it again as a text " + format_);
  }
  return !at_end_;
}

/// Whether the line that starts at `begin` and breaks at `line_break` goes on after it. Blanks the backslash if so.
bool LineScanner::continues(size_t begin, size_t line_break) {
  char* const text = buffer_.get();
  size_t last = line_break;
  while (last > begin && is_space(text[last - 1]) && text[last - 1] != '\n') --last;
  if (last == begin || text[last - 1] != '\\') return false;
  // A comment is not continued: headers are full of "# File: C:\models\".
  const std::string_view line(text + begin, last - begin);
  for (size_t hash = line.find('#'); hash != std::string_view::npos; hash = line.find('#', hash + 1)) {
    if (hash == 0 || is_space(line[hash - 1])) return false;
  }
  text[last - 1] = ' ';
  return true;
}

/// Sets begin_, cursor_ and end_ to the next line with its continuations; line breaks inside count as white space.
bool LineScanner::fetch_line() {
  line_number_ = next_line_number_;
  size_t scanned = 0;  // bytes of this line known to hold no end of it
  for (;;) {
    char* const from = buffer_.get() + next_ + scanned;
    const size_t ahead = filled_ - next_ - scanned;
    const void* found = ahead > 0 ? std::memchr(from, '\n', ahead) : nullptr;
    if (found == nullptr) {
      scanned += ahead;
      if (!at_end_ && refill()) continue;
      if (scanned == 0) return false;
    } else {
      const auto line_break = static_cast<size_t>(static_cast<const char*>(found) - buffer_.get());
      if (next_line_number_ == std::numeric_limits<int>::max()) {
        fail_file("this file has more than 2147483647 lines", "split it");
      }
      ++next_line_number_;
      scanned = line_break - next_;
      if (continues(next_, line_break)) {
        ++scanned;
        continue;
      }
    }
    begin_ = buffer_.get() + next_;
    cursor_ = begin_;
    end_ = begin_ + scanned;
    next_ += scanned + (found != nullptr ? 1 : 0);
    return true;
  }
}

bool LineScanner::next_line() {
  do {
    if (!fetch_line()) return false;
    keyword_ = next_word();
  } while (keyword_.empty());
  return true;
}

std::string_view LineScanner::rest() {
  skip_space();
  const char* const first = cursor_;
  const char* last = first;
  for (; last != end_; ++last) {
    if (*last == '#' && (last == first || is_space(last[-1])) && (last + 1 == end_ || is_space(last[1]))) break;
  }
  cursor_ = end_;
  while (last != first && is_space(last[-1])) --last;
  // Only a name that is continued on the next line has breaks inside.
  std::replace(begin_ + (first - begin_), begin_ + (last - begin_), '\n', ' ');
  return {first, static_cast<size_t>(last - first)};
}

std::string_view LineScanner::line() const {
  const char* last = keyword_.data() + keyword_.size();
  for (const char* c = last; c != end_; ++c) {
    if (*c == '#' && is_space(c[-1]) && (c + 1 == end_ || is_space(c[1]))) break;
    if (!is_space(*c)) last = c + 1;
  }
  return {keyword_.data(), static_cast<size_t>(last - keyword_.data())};
}

SourceLocation LineScanner::where(std::string_view word) const {
  if (word.data() == nullptr) word = keyword_;
  const char* line_start = begin_;
  int line = line_number_;
  for (const char* c = begin_; c != word.data(); ++c) {
    if (*c != '\n') continue;
    ++line;
    line_start = c + 1;
  }
  return {path_, line, static_cast<int>(word.data() - line_start) + 1};
}

void LineScanner::fail(std::string_view word, const std::string& problem, const std::string& mend) const {
  throw Error(where(word.empty() ? keyword_ : word), problem, mend);
}

void LineScanner::fail_file(const std::string& problem, const std::string& mend) const {
  throw Error({path_, 0, 0}, problem, mend);
}

/// What std::from_chars alone does not take: a plus sign and numbers too small for the type are read; all others are
/// the user's faults, with the mend that fits.
double LineScanner::unusual_number(bool single_precision) {
  const std::string_view word = next_word();
  std::string_view digits = word;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  const char* const last = digits.data() + digits.size();
  long double value = 0;
  const auto [stop, problem] = std::from_chars(digits.data(), last, value);
  if (stop != last || problem == std::errc::invalid_argument) {
    if (word.find(',') != std::string_view::npos) {
      fail(word, quoted(word) + " is no number", "write the decimal sign as a point, not as a comma");
    }
    fail(word, quoted(word) + " is no number", "write a number, such as 0.5 or 1e-3");
  }
  if (std::isnan(value) || std::isinf(value)) fail(word, quoted(word) + " is not finite", "write a finite number");
  const long double largest = single_precision ? std::numeric_limits<float>::max() : std::numeric_limits<double>::max();
  if (problem == std::errc::result_out_of_range || std::abs(value) > largest) {
    fail(word, quoted(word) + " is beyond what a " + (single_precision ? "32" : "64") + " bit number holds",
         "scale the model to sensible units");
  }
  return static_cast<double>(value);
}

}  // namespace vitrum
