#include "scene/toml_table.hpp"

#include <algorithm>
#include <cassert>
#include <cctype>
#include <charconv>
#include <cmath>

#include "core/suggest.hpp"

namespace vitrum {
namespace {

/// A number as a person would write it: no more digits than it takes.
std::string to_text(double value) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value);
  return {digits, end.ptr};
}

/// "the text 'x'", "an array of 2 values": what a node is, for messages.
std::string describe(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table: return "a table";
    case toml::node_type::array: {
      const size_t size = node.as_array()->size();
      return size == 1 ? "an array of 1 value" : "an array of " + std::to_string(size) + " values";
    }
    case toml::node_type::string: {
      const std::string& text = node.as_string()->get();
      return "the text '" + (text.size() > 60 ? text.substr(0, 57) + "..." : text) + "'";
    }
    case toml::node_type::integer: return "the number " + std::to_string(node.as_integer()->get());
    case toml::node_type::floating_point: return "the number " + to_text(node.as_floating_point()->get());
    case toml::node_type::boolean: return node.as_boolean()->get() ? "true" : "false";
    default: return "a date or time";
  }
}

/// "between 0 and 1", "above 0", "finite".
std::string describe(Range range) {
  const bool has_low = range.low > std::numeric_limits<double>::lowest();
  const bool has_high = range.high < std::numeric_limits<double>::max();
  const std::string above = range.excludes_low ? "above " : "at least ";
  if (has_low && has_high)
    return range.excludes_low ? "above " + to_text(range.low) + " and at most " + to_text(range.high)
                              : "between " + to_text(range.low) + " and " + to_text(range.high);
  if (has_low) return above + to_text(range.low);
  if (has_high) return "at most " + to_text(range.high);
  return "finite";
}

bool is_bare_key(std::string_view key) {
  return !key.empty() && std::all_of(key.begin(), key.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '_' || c == '-';
  });
}

}  // namespace

TomlTable::TomlTable(const toml::table& table, std::string path, SourceLocation where)
    : table_(&table), path_(std::move(path)), where_(std::move(where)) {}

const toml::node* TomlTable::find(std::string_view key) const {
  if (std::find(beaten_.begin(), beaten_.end(), key) != beaten_.end()) return nullptr;
  return table_->get(key);
}

SourceLocation TomlTable::where(std::string_view key) const {
  const toml::node* node = find(key);
  return node && node->source().path ? location(node->source()) : where_;
}

std::string TomlTable::path_of(std::string_view key) const {
  std::string name(key);
  if (!is_bare_key(key)) name = key.find('"') == key.npos ? '"' + name + '"' : '\'' + name + '\'';
  return path_.empty() ? name : path_ + '.' + name;
}

std::vector<std::string> TomlTable::keys() const {
  std::vector<std::string> names;
  for (const auto& [key, node] : *table_) names.emplace_back(key.str());
  return names;
}

void TomlTable::fail(std::string_view key, const std::string& problem, const std::string& mend) const {
  throw Error(where(key), path_of(key) + ' ' + problem, mend);
}

void TomlTable::wrong_type(std::string_view key, const toml::node& node, const std::string& wanted) const {
  std::string mend = "give it " + wanted;
  if (node.is_string() && is_override(location(node.source())))
    mend += " (as in TOML: 0.6 and not .6, true and not True, [1, 2, 3])";
  throw Error(location(node.source()), path_of(key) + " wants " + wanted + ", not " + describe(node), mend);
}

void TomlTable::check_keys(const std::vector<std::string>& required, const std::vector<std::string>& optional) const {
  std::vector<std::string> known = required;
  known.insert(known.end(), optional.begin(), optional.end());

  const toml::key* unknown = nullptr;
  const auto before = [](const toml::key& a, const toml::key& b) {
    const SourceLocation x = location(a.source()), y = location(b.source());
    return std::pair(x.line, x.column) < std::pair(y.line, y.column);
  };
  for (const auto& [key, node] : *table_)
    if (std::find(known.begin(), known.end(), key.str()) == known.end() && (!unknown || before(key, *unknown)))
      unknown = &key;
  if (unknown)
    throw Error(location(unknown->source()),
                path_of(unknown->str()) + " is not a key of " + (path_.empty() ? "the scene file" : '[' + path_ + ']'),
                suggestion(unknown->str(), known, "keys"));

  for (const std::string& key : required)
    if (!has(key))
      throw Error(where_, path_of(key) + " is missing",
                  path_.empty() ? "give it at the top" : "give it in [" + path_ + ']');
}

void TomlTable::require_type() const {
  if (has("type")) return;
  for (const auto& [key, node] : *table_)
    if (edit_distance(key.str(), "type") <= 2)
      throw Error(location(key.source()), path_of(key.str()) + " is not a key of [" + path_ + ']',
                  "did you mean 'type'?");
  throw Error(where_, path_of("type") + " is missing", "give it in [" + path_ + ']');
}

void TomlTable::exclude_each_other(const std::vector<std::string>& keys) {
  std::string first;
  for (const std::string& key : keys) {
    if (!has(key)) continue;
    if (first.empty()) {
      first = key;
      continue;
    }
    const bool first_overrides = is_override(where(first)), this_overrides = is_override(where(key));
    if (first_overrides == this_overrides)
      fail(key, "and " + path_of(first) + " exclude each other", "keep one of the two");
    beaten_.push_back(first_overrides ? key : first);
    if (this_overrides) first = key;
  }
}

void TomlTable::flag(std::string_view key, bool& value) const {
  const toml::node* node = find(key);
  if (!node) return;
  if (!node->is_boolean()) wrong_type(key, *node, "true or false");
  value = node->as_boolean()->get();
}

double TomlTable::checked_number(std::string_view key, const toml::node& node, Range range,
                                 const std::string& wanted) const {
  if (!node.is_number()) wrong_type(key, node, wanted);
  // Not value<double>(): that has none for integers beyond 2^53.
  const double number =
      node.is_integer() ? static_cast<double>(node.as_integer()->get()) : node.as_floating_point()->get();
  if (!std::isfinite(number))
    throw Error(location(node.source()), path_of(key) + " is not finite", "write a number");
  if (number < range.low || number > range.high || (range.excludes_low && number == range.low))
    throw Error(location(node.source()), path_of(key) + " is out of range: " + to_text(number),
                "it must be " + describe(range));
  return number;
}

void TomlTable::number(std::string_view key, double& value, Range range) const {
  if (const toml::node* node = find(key)) value = checked_number(key, *node, range, "a number");
}

void TomlTable::length(std::string_view key, double& value, Range range, double metres_per_unit) const {
  if (!has(key)) return;
  number(key, value, range);
  value *= metres_per_unit;
}

int64_t TomlTable::checked_integer(std::string_view key, const toml::node& node, int64_t low, int64_t high,
                                   const std::string& wanted) const {
  if (!node.is_integer()) wrong_type(key, node, wanted);
  const int64_t number = node.as_integer()->get();
  if (number < low || number > high)
    throw Error(location(node.source()), path_of(key) + " is out of range: " + std::to_string(number),
                "it must be between " + std::to_string(low) + " and " + std::to_string(high));
  return number;
}

void TomlTable::integer(std::string_view key, uint64_t& value, int64_t low, int64_t high) const {
  assert(low >= 0);
  if (const toml::node* node = find(key))
    value = static_cast<uint64_t>(checked_integer(key, *node, low, high, "a whole number"));
}

void TomlTable::integer(std::string_view key, int& value, int low, int high) const {
  if (const toml::node* node = find(key))
    value = static_cast<int>(checked_integer(key, *node, low, high, "a whole number"));
}

void TomlTable::integers(std::string_view key, std::initializer_list<int*> values, int low, int high) const {
  const toml::node* node = find(key);
  if (!node) return;
  const std::string wanted = "an array of " + std::to_string(values.size()) + " whole numbers";
  const toml::array& array = checked_array(key, *node, values.size(), wanted);
  size_t i = 0;
  for (int* value : values) *value = static_cast<int>(checked_integer(key, array[i++], low, high, wanted));
}

void TomlTable::text(std::string_view key, std::string& value) const {
  const toml::node* node = find(key);
  if (!node) return;
  if (!node->is_string()) wrong_type(key, *node, "text between quotes");
  value = node->as_string()->get();
}

void TomlTable::texts(std::string_view key, std::vector<Said<std::string>>& values) const {
  const toml::node* node = find(key);
  if (!node) return;
  const std::string wanted = "an array of texts, [\"a\", \"b\"]";
  if (!node->is_array()) wrong_type(key, *node, wanted);
  values.clear();
  for (const toml::node& element : *node->as_array()) {
    if (!element.is_string()) wrong_type(key, element, wanted);
    values.push_back({element.as_string()->get(), location(element.source())});
  }
}

const toml::array& TomlTable::checked_array(std::string_view key, const toml::node& node, size_t size,
                                            const std::string& wanted) const {
  const toml::array* array = node.as_array();
  if (!array || array->size() != size) wrong_type(key, node, wanted);
  return *array;
}

void TomlTable::numbers(std::string_view key, double* values, size_t count, Range range) const {
  const toml::node* node = find(key);
  if (!node) return;
  const std::string wanted = "an array of " + std::to_string(count) + " numbers";
  const toml::array& array = checked_array(key, *node, count, wanted);
  for (size_t i = 0; i < count; ++i) values[i] = checked_number(key, array[i], range, wanted);
}

void TomlTable::vector(std::string_view key, glm::dvec2& value, Range range) const {
  numbers(key, &value[0], 2, range);
}

void TomlTable::vector(std::string_view key, glm::dvec3& value, Range range) const {
  numbers(key, &value[0], 3, range);
}

void TomlTable::colour(std::string_view key, Spectrum& value, Range range) const {
  const toml::node* node = find(key);
  if (!node) return;
  const std::string wanted = "a colour: three numbers [r, g, b], or one for grey";
  if (node->is_number()) {
    value = Spectrum(checked_number(key, *node, range, wanted));
    return;
  }
  const toml::array& array = checked_array(key, *node, 3, wanted);
  for (int i = 0; i < 3; ++i) value[i] = checked_number(key, array[static_cast<size_t>(i)], range, wanted);
}

void TomlTable::direction(std::string_view key, glm::dvec3& value) const {
  if (!has(key)) return;
  glm::dvec3 direction;
  vector(key, direction, {-1e100, 1e100});
  // Scaled by the largest component first, so that squares neither overflow nor vanish.
  const double largest = std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
  if (!(largest >= 1e-100)) fail(key, "has no direction: its length is 0", "give a vector that is not 0");
  value = glm::normalize(direction / largest);
}

std::optional<size_t> TomlTable::choose(std::string_view key, const std::vector<std::string>& words) const {
  if (!has(key)) return std::nullopt;
  std::string word;
  text(key, word);
  const auto found = std::find(words.begin(), words.end(), word);
  if (found == words.end()) fail(key, "is '" + word + "', which has no meaning here", suggestion(word, words, "words"));
  return static_cast<size_t>(found - words.begin());
}

TomlTable TomlTable::table(std::string_view key) const {
  static const toml::table empty;
  const toml::node* node = find(key);
  if (!node) return {empty, path_of(key), where_};
  if (!node->is_table())
    fail(key, "wants a table, not " + describe(*node),
         path_.empty() ? "write it as [" + path_of(key) + "] with its keys below" : "write it as { KEY = VALUE }");
  return {*node->as_table(), path_of(key), where(key)};
}

std::vector<std::pair<std::string, TomlTable>> TomlTable::named_tables(std::string_view key) const {
  const toml::node* node = find(key);
  if (!node) return {};
  const std::string mend = "write [" + path_of(key) + ".NAME] with its keys below";
  if (!node->is_table()) fail(key, "wants tables by name, not " + describe(*node), mend);
  std::vector<std::pair<std::string, TomlTable>> tables;
  const TomlTable parent = table(key);
  for (const auto& [name, child] : *node->as_table()) {
    if (name.str().empty()) throw Error(location(name.source()), path_of(key) + " holds an empty name", mend);
    if (!child.is_table())
      throw Error(location(name.source()), parent.path_of(name.str()) + " wants a table, not " + describe(child), mend);
    tables.emplace_back(name.str(), parent.table(name.str()));
  }
  return tables;
}

}  // namespace vitrum
