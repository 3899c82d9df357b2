#include "scene/obj_oddities.hpp"

#include <algorithm>

#include "core/log.hpp"
#include "scene/line_scanner.hpp"

namespace vitrum {
namespace {

constexpr size_t max_ignored_keywords = 20;

constexpr std::array<const char*, static_cast<size_t>(Oddity::count)> texts{
    "a face of two vertices is skipped",
    "a face without area is skipped",
    "a polygon crosses itself; its triangles may overlap",
    "index 0 of a texture coordinate or normal is taken as none",
    "only some corners of a face have texture coordinates or normals; the face goes without",
    "a normal of length 0 is taken as none"};

}  // namespace

bool ObjOddities::ignore_statement(std::string_view keyword, const SourceLocation& where) {
  const auto earlier = std::find_if(ignored_.begin(), ignored_.end(),
                                    [&](const auto& entry) { return entry.first == keyword; });
  if (earlier != ignored_.end()) {
    ++earlier->second.count;
    return true;
  }
  if (ignored_.size() == max_ignored_keywords) return false;
  ignored_.push_back({std::string(keyword), {1, where}});
  return true;
}

void ObjOddities::report() const {
  const auto report_one = [](const Tally& tally, const std::string& text) {
    if (tally.count == 0) return;
    warn(tally.first, text + (tally.count > 1 ? " (the first of " + std::to_string(tally.count) + ")" : ""));
  };
  for (size_t i = 0; i < texts.size(); ++i) report_one(tallies_[i], texts[i]);
  for (const auto& [keyword, tally] : ignored_) report_one(tally, "statement " + quoted(keyword) + " is ignored");
}

}  // namespace vitrum
