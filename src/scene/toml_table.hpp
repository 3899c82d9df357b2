#pragma once
// Typed, checked access to the tables of a scene file.

#include <glm/glm.hpp>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scene/mtl_reader.hpp"
#include "scene/toml_document.hpp"

namespace vitrum {

/// What a number may be; finite in any case.
struct Range {
  double low = std::numeric_limits<double>::lowest();
  double high = std::numeric_limits<double>::max();
  bool excludes_low = false;
};

/// Coordinates and lengths that float arithmetic bears, squares and products included [units or metres].
inline constexpr double length_limit = 1e9;
inline constexpr Range coordinate{-length_limit, length_limit};
inline constexpr Range positive_length{1e-9, length_limit};
/// Radiance, irradiance, intensity: their squares must still be floats.
inline constexpr Range radiometric{0, 1e15};

/// One table of a scene file and its dotted name. Reads leave a value as it is when its key is absent, so that the
/// Scene's own defaults hold. Every read throws Error, at the value's place, for a wrong type or a value out of range.
class TomlTable {
 public:
  /// `path` is the dotted name from the file's top, "" for the top itself. `table` must outlive this.
  TomlTable(const toml::table& table, std::string path, SourceLocation where);

  const std::string& path() const { return path_; }
  const SourceLocation& where() const { return where_; }
  /// Place of a key's value; of the table where the key is absent.
  SourceLocation where(std::string_view key) const;
  /// The key's dotted name from the file's top, quoted where TOML needs it.
  std::string path_of(std::string_view key) const;
  bool has(std::string_view key) const { return find(key) != nullptr; }
  std::vector<std::string> keys() const;

  /// Throws for the first key that is in neither list (with the nearest that is), then for a required one that is
  /// absent.
  void check_keys(const std::vector<std::string>& required, const std::vector<std::string>& optional) const;

  /// At most one of `keys` may be said. One from an override beats one from the file, which is then taken as absent.
  void exclude_each_other(const std::vector<std::string>& keys);

  void flag(std::string_view key, bool& value) const;
  void number(std::string_view key, double& value, Range range) const;
  /// A number in the file's unit, checked as it stands, in metres after.
  void length(std::string_view key, double& value, Range range, double metres_per_unit) const;
  void integer(std::string_view key, int& value, int low, int high) const;
  void integer(std::string_view key, uint64_t& value, int64_t low, int64_t high) const;
  void integers(std::string_view key, std::initializer_list<int*> values, int low, int high) const;
  void text(std::string_view key, std::string& value) const;
  void texts(std::string_view key, std::vector<Said<std::string>>& values) const;
  void vector(std::string_view key, glm::dvec2& value, Range range) const;
  void vector(std::string_view key, glm::dvec3& value, Range range) const;
  void numbers(std::string_view key, double* values, size_t count, Range range) const;
  /// Three numbers, or one for grey.
  void colour(std::string_view key, Spectrum& value, Range range) const;
  /// Three numbers, not all 0; scaled to unit length.
  void direction(std::string_view key, glm::dvec3& value) const;

  /// One of a few words.
  template <typename E>
  void choice(std::string_view key, E& value, const std::vector<std::pair<std::string, E>>& words) const {
    std::vector<std::string> known;
    for (const auto& [word, meaning] : words) known.push_back(word);
    if (const std::optional<size_t> chosen = choose(key, known)) value = words[*chosen].second;
  }

  /// The word at `type`, which must be there.
  template <typename E>
  E type(const std::vector<std::pair<std::string, E>>& words) const {
    require_type();
    E value{};
    choice("type", value, words);
    return value;
  }

  /// A value with its place, where the key is there: `table.said("Ns", material.Ns, [&](auto& v) {...})`.
  template <typename T, typename Read>
  void said(std::string_view key, std::optional<Said<T>>& value, const Read& read) const {
    if (!has(key)) return;
    value = Said<T>{T{}, where(key)};
    read(value->value);
  }

  /// The table at `key`; an empty one where it is absent.
  TomlTable table(std::string_view key) const;
  /// The tables by name at `key` ([light.NAME]), sorted by name.
  std::vector<std::pair<std::string, TomlTable>> named_tables(std::string_view key) const;

  bool is_table(std::string_view key) const { return has(key) && find(key)->is_table(); }
  bool is_array(std::string_view key) const { return has(key) && find(key)->is_array(); }
  bool is_number(std::string_view key) const { return has(key) && find(key)->is_number(); }

  /// Throws Error at the key's value: "camera.eye PROBLEM; MEND".
  [[noreturn]] void fail(std::string_view key, const std::string& problem, const std::string& mend) const;

 private:
  const toml::node* find(std::string_view key) const;
  void require_type() const;
  std::optional<size_t> choose(std::string_view key, const std::vector<std::string>& words) const;
  [[noreturn]] void wrong_type(std::string_view key, const toml::node& node, const std::string& wanted) const;
  int64_t checked_integer(std::string_view key, const toml::node& node, int64_t low, int64_t high,
                          const std::string& wanted) const;
  double checked_number(std::string_view key, const toml::node& node, Range range, const std::string& wanted) const;
  const toml::array& checked_array(std::string_view key, const toml::node& node, size_t size,
                                   const std::string& wanted) const;

  const toml::table* table_;
  std::string path_;
  SourceLocation where_;
  std::vector<std::string> beaten_;    ///< keys that an override of another key has put out of force
};

}  // namespace vitrum
