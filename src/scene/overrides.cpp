#include "scene/overrides.hpp"

#include <cstdio>
#include <optional>

namespace vitrum {
namespace {

/// Position of the `=` that ends the key: the first one outside quotes.
size_t end_of_key(const std::string& text) {
  char quote = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quote == 0 && c == '=') return i;
    if (quote == '"' && c == '\\') ++i;
    else if (quote == 0 && (c == '"' || c == '\'')) quote = c;
    else if (c == quote) quote = 0;
  }
  return std::string::npos;
}

/// A TOML basic string that holds `text`.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\u%04X", static_cast<unsigned>(c));
      result += escape;
    } else {
      result += c;
    }
  }
  result += '"';
  return result;
}

/// Number of keys on the way down a document that holds one value only; 0 if it holds more or less than one.
int depth_of_single_value(const toml::table& document, int parts_of_key) {
  const toml::table* table = &document;
  for (int depth = 1;; ++depth) {
    if (table->size() != 1) return 0;
    if (depth == parts_of_key) return depth;
    table = table->begin()->second.as_table();
    if (!table) return depth;
  }
}

std::optional<toml::table> try_parse(const std::string& text, const std::string& source) {
  try {
    return parse_toml(text, source);
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

void apply_override(toml::table& root, const std::string& override_text) {
  const std::string source = std::string(override_prefix) + override_text;
  const SourceLocation where{source};
  const size_t equals = end_of_key(override_text);
  if (equals == std::string::npos) throw Error(where, "there is no '='", "write --set KEY=VALUE");
  const std::string key = override_text.substr(0, equals), value = override_text.substr(equals + 1);

  // The key by itself tells a fault of the key from a VALUE that is no TOML, and how many parts it has.
  const std::optional<toml::table> alone = key.find('\n') == key.npos ? try_parse(key + " = 0", source) : std::nullopt;
  const int parts = alone ? depth_of_single_value(*alone, 0) : 0;
  if (parts == 0)
    throw Error(where, "'" + key + "' is no key", "write names with points between, as in render.samples; "
                "a name with other characters than letters, digits, _ and - goes between quotes");

  std::optional<toml::table> document = try_parse(key + " = " + value, source);
  if (!document || depth_of_single_value(*document, parts) != parts)
    document = parse_toml(key + " = " + quoted(value), source);

  toml::table* into = &root;
  toml::table* from = &*document;
  std::string path;
  for (int part = 1;; ++part) {
    const toml::key& name = from->begin()->first;
    toml::node& node = from->begin()->second;
    toml::node* present = into->get(name.str());
    if (part == parts || !present) {
      // Moved, not copied: a copy of a node forgets its place.
      node.visit([&](auto& concrete) { into->insert_or_assign(name, std::move(concrete)); });
      return;
    }
    if (part > 1) path += '.';
    path += name.str();
    if (!present->is_table())
      throw Error(where, "'" + path + "' is a value, which holds no further keys", "set " + path + " as a whole");
    into = present->as_table();
    from = node.as_table();
  }
}

}  // namespace vitrum
