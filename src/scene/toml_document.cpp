#include "scene/toml_document.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

namespace vitrum {
namespace {

constexpr std::uintmax_t file_size_limit = 16u << 20;
// toml++ 3.3 recurses into every part of a dotted key and every bracket; the format itself needs four levels.
constexpr int depth_limit = 16;

/// Reads a regular file whole. Folders, FIFOs and devices are refused before they are opened: they hang or never end.
std::string read_text(const std::string& path) {
  namespace fs = std::filesystem;
  const SourceLocation where{path};
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw Error(where, "there is no such scene file", "check the path");
  if (fs::is_directory(status)) throw Error(where, "this is a folder, not a scene file", "name the .toml file in it");
  if (!fs::is_regular_file(status)) throw Error(where, "this is not a regular file", "name a .toml file");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error || size > file_size_limit)
    throw Error(where, "the file is larger than 16 MiB, which no scene file is", "put geometry into OBJ files");

  std::string text(static_cast<size_t>(size), '\0');
  std::ifstream stream(path, std::ios::binary);
  if (stream) stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream.is_open() || stream.bad())
    throw Error(where, std::string("the file cannot be read (") + std::strerror(errno) + ")", "check its permissions");
  text.resize(static_cast<size_t>(stream.gcount()));
  return text;
}

/// Bounds the nesting of brackets and the parts of keys, in one walk that knows TOML's strings and comments.
/// Text that is no TOML may be misjudged after its first error, never before it.
void check_depth(std::string_view text, const std::string& source) {
  int line = 1, brackets = 0, dots = 0;
  const auto starts_with = [&](size_t at, std::string_view what) { return text.substr(at, what.size()) == what; };
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    switch (c) {
      case '#':
        while (i + 1 < text.size() && text[i + 1] != '\n') ++i;
        break;
      case '"':
      case '\'': {
        const std::string fence(3, c);
        const bool multiline = starts_with(i, fence);
        i += multiline ? 3 : 1;
        for (; i < text.size(); ++i) {
          if (multiline ? starts_with(i, fence) : text[i] == c) break;
          if (text[i] == '\n') {
            ++line;
            if (!multiline) break;
          }
          if (text[i] == '\\' && c == '"' && i + 1 < text.size() && text[i + 1] != '\n') ++i;
        }
        if (multiline) {
          i += 2;
          // Up to two quotes more belong to the text: """she said "no"""".
          for (int more = 0; more < 2 && i + 1 < text.size() && text[i + 1] == c; ++more) ++i;
        }
        break;
      }
      case '\n': ++line; [[fallthrough]];
      case '=':
      case ',': dots = 0; break;
      case '[':
      case '{': ++brackets; dots = 0; break;
      case ']':
      case '}': --brackets; break;
      case '.': ++dots; break;
      default: break;
    }
    if (brackets > depth_limit || dots >= depth_limit)
      throw Error(location({{static_cast<toml::source_index>(line), 0}, {}, std::make_shared<std::string>(source)}),
                  "tables or arrays are nested deeper than " + std::to_string(depth_limit) + " levels",
                  "no key of a scene file lies that deep");
  }
}

/// What to do about a parse error, as far as toml++'s words tell.
std::string mend_for(std::string_view problem) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 11> mends{{
      {"utf-8", "save the file as UTF-8"},
      {"floating-point", "TOML wants digits on both sides of the point: 0.6 and 1.0, not .6 and 1."},
      {"saw ','", "TOML's numbers have a point: 0.5, not 0,5"},
      {"cannot redefine", "say it once, in one table"},
      {"parsing string", "close the string with the quote that opened it, on the same line"},
      {"boolean", "write true or false, in small letters; text goes between quotes"},
      {"64 bits", "write a smaller number"},
      {"could not be interpreted", "write a smaller number; text goes between quotes"},
      {"parsing key:", "names hold letters, digits, _ and -; others go between quotes"},
      {"table header", "a table begins with a line [NAME]"},
      {"array", "write an array as [1, 2, 3]"},
  }};
  for (const auto& [words, mend] : mends)
    if (problem.find(words) != std::string_view::npos) return std::string(mend);
  return "write KEY = VALUE, with text between quotes";
}

}  // namespace

bool is_override(const SourceLocation& where) { return where.file.starts_with(override_prefix); }

SourceLocation location(const toml::source_region& region) {
  if (!region.path) return {};
  SourceLocation where{*region.path, static_cast<int>(region.begin.line), static_cast<int>(region.begin.column)};
  if (is_override(where)) where.line = where.column = 0;
  return where;
}

toml::table parse_toml(std::string_view text, const std::string& source) {
  check_depth(text, source);
  try {
    return toml::parse(text, std::string_view(source));
  } catch (const toml::parse_error& error) {
    std::string problem(error.description());
    if (constexpr std::string_view prefix = "Error while "; problem.starts_with(prefix))
      problem = "no TOML: while " + problem.substr(prefix.size());
    const std::string mend = mend_for(problem);
    throw Error(location(error.source()), std::move(problem), mend);
  }
}

toml::table read_toml_file(const std::string& path) {
  const std::string text = read_text(path);
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    throw Error({path, 1, 1}, "the file is written in UTF-16", "save it as UTF-8");
  if (text.find('\0') != std::string::npos)
    throw Error({path}, "the file holds binary data, not text", "name a .toml file");
  return parse_toml(text, path);
}

}  // namespace vitrum
