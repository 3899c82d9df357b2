#pragma once
// What an OBJ file has that is odd but readable: one warning for each kind, at its first place and with a count.

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/error.hpp"

namespace vitrum {

enum class Oddity { two_vertices, no_area, crossing, zero_index, partly_given, zero_normal, count };

class ObjOddities {
 public:
  /// Counts an oddity; `where` is called for its place the first time.
  template <typename Where>
  void note(Oddity oddity, const Where& where) {
    Tally& tally = tallies_[static_cast<size_t>(oddity)];
    if (tally.count++ == 0) tally.first = where();
  }

  /// Counts a statement that is passed over. False if there are too many kinds of them for an OBJ file.
  bool ignore_statement(std::string_view keyword, const SourceLocation& where);

  /// Whether a statement was passed over.
  bool has_ignored() const { return !ignored_.empty(); }

  /// Prints the warnings.
  void report() const;

 private:
  struct Tally {
    size_t count = 0;
    SourceLocation first;
  };

  std::array<Tally, static_cast<size_t>(Oddity::count)> tallies_;
  std::vector<std::pair<std::string, Tally>> ignored_;
};

}  // namespace vitrum
