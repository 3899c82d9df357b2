#include "core/suggest.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>

namespace vitrum {
namespace {
char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }
}  // namespace

int edit_distance(std::string_view a, std::string_view b) {
  // Three rows of the table of distances between beginnings of a and b.
  std::vector<int> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) row[j] = static_cast<int>(j);
  for (size_t i = 1; i <= a.size(); ++i) {
    before_last.swap(last);
    last.swap(row);
    row[0] = static_cast<int>(i);
    for (size_t j = 1; j <= b.size(); ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]))
        row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row[b.size()];
}

std::string suggestion(std::string_view name, const std::vector<std::string>& known, std::string_view what) {
  constexpr size_t longest_name = 100, longest_list = 12;
  if (known.empty()) return "there are no " + std::string(what);

  const std::string* nearest = nullptr;
  if (name.size() <= longest_name) {
    int least = static_cast<int>(std::max<size_t>(1, name.size() / 3)) + 1;
    for (const std::string& candidate : known) {
      if (candidate.size() > longest_name) continue;
      if (const int distance = edit_distance(name, candidate); distance < least) {
        least = distance;
        nearest = &candidate;
      }
    }
  }
  std::string text;
  if (nearest) text = "did you mean '" + *nearest + "'? ";
  text += "known " + std::string(what) + ": ";
  for (size_t i = 0; i < std::min(known.size(), longest_list); ++i) text += (i ? ", " : "") + known[i];
  if (known.size() > longest_list) text += ", ...";
  return text;
}

}  // namespace vitrum
