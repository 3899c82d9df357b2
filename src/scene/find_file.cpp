#include "scene/find_file.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <filesystem>
#include <system_error>

namespace vitrum {
namespace {

namespace fs = std::filesystem;

std::string beside(const std::string& named_in, const std::string& name) {
  const fs::path path(name);
  return path.is_absolute() ? name : (fs::path(named_in).parent_path() / path).lexically_normal().string();
}

std::string with_slashes(std::string_view name) {
  std::string text(name);
  std::replace(text.begin(), text.end(), '\\', '/');
  return text;
}

std::string_view without_quotes(std::string_view name) {
  const bool is_quoted = name.size() > 2 && name.front() == '"' && name.back() == '"';
  return is_quoted ? name.substr(1, name.size() - 2) : name;
}

std::string_view without_comment(std::string_view name) {
  const size_t hash = std::min(name.find(" #"), name.find("\t#"));
  if (hash == std::string_view::npos) return name;
  const size_t last = name.find_last_not_of(" \t", hash);
  return name.substr(0, last == std::string_view::npos ? 0 : last + 1);
}

bool ends_in(std::string_view name, std::string_view extension) {
  if (name.size() < extension.size()) return false;
  return std::equal(extension.begin(), extension.end(), name.end() - static_cast<std::ptrdiff_t>(extension.size()),
                    [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); });
}

}  // namespace

std::string path_beside(const std::string& named_in, std::string_view name) {
  return beside(named_in, with_slashes(without_quotes(name)));
}

std::optional<std::string> find_file(const std::string& named_in, std::string_view name) {
  const std::string_view bare = without_quotes(without_comment(name));
  for (const std::string& candidate : {std::string(name), with_slashes(name), with_slashes(without_quotes(name)),
                                       with_slashes(bare)}) {
    if (candidate.empty() || candidate.find('\0') != std::string::npos) continue;
    const std::string path = beside(named_in, candidate);
    std::error_code no_such_file;
    if (fs::exists(path, no_such_file)) return path;
  }
  return std::nullopt;
}

std::vector<std::string_view> split_file_names(const std::string& named_in, std::string_view list,
                                               std::string_view extension) {
  constexpr const char* space = " \t";
  const auto exists = [&](std::string_view name) { return find_file(named_in, name).has_value(); };
  if (exists(list)) return {list};
  std::vector<std::string_view> words, names;
  size_t name_start = std::string_view::npos;
  const auto next_word = [&](size_t from) { return list.find_first_not_of(space, from); };
  for (size_t at = next_word(0); at != std::string_view::npos; at = next_word(at)) {
    const std::string_view word = list.substr(at, list.find_first_of(space, at) - at);
    words.push_back(word);
    if (name_start == std::string_view::npos) name_start = at;
    at += word.size();
    if (!ends_in(word, extension) && next_word(at) != std::string_view::npos) continue;
    names.push_back(list.substr(name_start, at - name_start));
    name_start = std::string_view::npos;
  }
  const bool only_words_exist = !std::all_of(names.begin(), names.end(), exists) &&
                                std::all_of(words.begin(), words.end(), exists);
  return only_words_exist ? words : names;
}

}  // namespace vitrum
