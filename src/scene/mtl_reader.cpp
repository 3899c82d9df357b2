#include "scene/mtl_reader.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <unordered_map>

#include "core/log.hpp"
#include "scene/find_file.hpp"
#include "scene/line_scanner.hpp"

namespace vitrum {
namespace {

constexpr uint64_t max_mtl_bytes = uint64_t{256} << 20;

/// Keywords that are read. Others are listed as unused.
constexpr std::array read_keywords{"newmtl", "Ka", "Kd", "Ks",     "Ke", "Tf", "Ns",
                                   "Ni",     "d",  "Pr", "Pm", "illum", "map_Kd"};

bool equal_but_for_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](unsigned char x, unsigned char y) {
    return std::tolower(x) == std::tolower(y);
  });
}

bool is_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value;
  const auto [stop, problem] = std::from_chars(word.data(), word.data() + word.size(), value);
  return problem == std::errc{} && stop == word.data() + word.size();
}

class MtlReader {
 public:
  explicit MtlReader(const std::string& path) : scan_(path, "MTL", max_mtl_bytes) {}

  std::vector<MtlMaterial> read() {
    while (scan_.next_line()) read_line();
    return std::move(materials_);
  }

 private:
  void read_line();
  void begin_material();
  Spectrum colour();
  double number();
  int illum();
  double coverage();
  TextureReference texture();
  bool texture_option(std::string_view option, TextureReference& reference);
  bool on_or_off(std::string_view option);
  void no_more_words();
  void not_used(const std::string& text) { material().unused.push_back({text, scan_.where()}); }
  MtlMaterial& material() { return materials_[current_]; }

  template <typename T>
  void set(std::optional<Said<T>>& property, T value) {
    const SourceLocation where = scan_.where();
    if (property) {
      warn(where, std::string(scan_.keyword()) + " is given twice for material " + quoted(material().name) +
                      "; this one counts");
    }
    property = Said<T>{std::move(value), where};
  }

  LineScanner scan_;
  std::vector<MtlMaterial> materials_;
  std::unordered_map<std::string, size_t> by_name_;
  size_t current_ = 0;
};

void MtlReader::begin_material() {
  const std::string name(scan_.rest());
  if (name.empty()) scan_.fail({}, "newmtl names no material", "write a name after it");
  const SourceLocation where = scan_.where();
  const auto [entry, is_new] = by_name_.try_emplace(name, materials_.size());
  current_ = entry->second;
  if (is_new) {
    materials_.emplace_back();
  } else {
    warn(where, "material " + quoted(name) + " is defined twice, before at " + to_string(material().where) +
                    "; this one counts");
    material() = {};
  }
  material().name = name;
  material().where = where;
}

void MtlReader::read_line() {
  const std::string_view keyword = scan_.keyword();
  if (keyword == "newmtl") return begin_material();
  const auto known = std::find_if(read_keywords.begin(), read_keywords.end(), [&](std::string_view candidate) {
    return equal_but_for_case(keyword, candidate);
  });
  if (known != read_keywords.end() && keyword != *known) {
    scan_.fail({}, "keyword " + quoted(keyword) + " is not known", std::string("write ") + *known);
  }
  if (materials_.empty()) {
    scan_.fail({}, quoted(keyword) + " stands before any newmtl",
               known != read_keywords.end() ? "begin each material with newmtl NAME"
                                            : "check that this is an MTL file");
  }
  MtlMaterial& m = material();
  if (known == read_keywords.end()) return not_used(std::string(scan_.line()));
  if (keyword == "Ka") return set(m.Ka, colour());
  if (keyword == "Kd") return set(m.Kd, colour());
  if (keyword == "Ks") return set(m.Ks, colour());
  if (keyword == "Ke") return set(m.Ke, colour());
  if (keyword == "Tf") return set(m.Tf, colour());
  if (keyword == "Ns") return set(m.Ns, number());
  if (keyword == "Ni") return set(m.Ni, number());
  if (keyword == "Pr") return set(m.Pr, number());
  if (keyword == "Pm") return set(m.Pm, number());
  if (keyword == "d") return set(m.d, coverage());
  if (keyword == "illum") return set(m.illum, illum());
  set(m.map_Kd, texture());
}

void MtlReader::no_more_words() {
  const std::string_view extra = scan_.next_word();
  if (!extra.empty()) {
    scan_.fail(extra, quoted(extra) + " is too much after " + std::string(scan_.keyword()), "remove it");
  }
}

/// Three numbers, or one that counts for all three channels.
Spectrum MtlReader::colour() {
  const std::string_view first = scan_.peek_word();
  if (first == "spectral" || first == "xyz") {
    scan_.fail(first, "colours given as " + std::string(first) + " are not supported", "write red, green and blue");
  }
  std::array<double, 3> values{};
  size_t count = 0;
  while (count < 3) {
    const std::optional<double> value = scan_.next_number<double>();
    if (!value) break;
    values[count++] = *value;
  }
  if (count == 0 || count == 2) {
    scan_.fail({}, std::string(scan_.keyword()) + " has " + (count == 0 ? "no number" : "two numbers"),
               "write three (red, green, blue), or one for all");
  }
  no_more_words();
  return count == 1 ? Spectrum(values[0]) : Spectrum(values[0], values[1], values[2]);
}

double MtlReader::number() {
  const std::optional<double> value = scan_.next_number<double>();
  if (!value) scan_.fail({}, std::string(scan_.keyword()) + " has no number", "write one after it");
  no_more_words();
  return *value;
}

int MtlReader::illum() {
  const std::string_view word = scan_.peek_word();
  const double value = number();
  if (value != std::floor(value) || std::abs(value) > 1e6) {
    scan_.fail(word, quoted(word) + " is no illumination model", "write a whole number from 0 to 12");
  }
  return static_cast<int>(value);
}

double MtlReader::coverage() {
  if (scan_.peek_word() == "-halo") {
    scan_.next_word();
    not_used("d -halo");
  }
  return number();
}

bool MtlReader::on_or_off(std::string_view option) {
  const std::string_view word = scan_.next_word();
  if (word != "on" && word != "off") {
    scan_.fail(word, std::string(option) + " wants on or off", "write " + std::string(option) + " on");
  }
  return word == "on";
}

/// Reads one option of map_Kd and its arguments; false if it is none. What has no effect here is listed as unused,
/// unless it says the default.
bool MtlReader::texture_option(std::string_view option, TextureReference& reference) {
  const std::string name(option);
  const auto argument = [&] {
    const std::optional<double> value = scan_.next_number<double>();
    if (!value) scan_.fail(option, name + " has no number", "write one after it");
    return *value;
  };
  if (option == "-o" || option == "-s" || option == "-t") {
    // u [v [w]]: those left out are the default, and w belongs to solid textures.
    const double otherwise = option == "-s" ? 1.0 : 0.0;
    std::array<double, 3> uvw{argument(), otherwise, otherwise};
    for (size_t i = 1; i < 3 && is_number(scan_.peek_word()); ++i) uvw[i] = argument();
    if (option == "-o") reference.offset = {uvw[0], uvw[1]};
    if (option == "-s") reference.scale = {uvw[0], uvw[1]};
    if (option == "-t" && (uvw[0] != 0 || uvw[1] != 0 || uvw[2] != 0)) not_used("map_Kd -t");
    return true;
  }
  if (option == "-clamp") {
    reference.clamp = on_or_off(option);
    return true;
  }
  if (option == "-blendu" || option == "-blendv" || option == "-cc") {
    const bool is_default = on_or_off(option) == (option != "-cc");
    if (!is_default) not_used("map_Kd " + name);
    return true;
  }
  if (option == "-mm") {
    const double base = argument(), gain = argument();
    if (base != 0 || gain != 1) not_used("map_Kd -mm");
    return true;
  }
  if (option == "-boost" || option == "-texres" || option == "-bm") {
    argument();
    not_used("map_Kd " + name);
    return true;
  }
  if (option == "-imfchan" || option == "-type" || option == "-colorspace") {
    not_used("map_Kd " + name + " " + std::string(scan_.next_word()));
    return true;
  }
  return false;
}

TextureReference MtlReader::texture() {
  TextureReference reference;
  std::string_view word = scan_.peek_word();
  std::string_view unknown;
  while (word.starts_with('-')) {
    scan_.next_word();
    if (!texture_option(word, reference)) {
      unknown = word;
      break;
    }
    word = scan_.peek_word();
  }
  std::string_view name = scan_.rest();
  if (!unknown.empty()) {  // a file may be called "-x.png"
    name = {unknown.data(), static_cast<size_t>(name.data() + name.size() - unknown.data())};
    while (name.ends_with(' ') || name.ends_with('\t')) name.remove_suffix(1);
  }
  if (name.empty()) scan_.fail({}, "map_Kd names no picture", "write a file name after it");
  const std::optional<std::string> found = find_file(scan_.path(), name);
  if (!found && !unknown.empty()) {
    scan_.fail(unknown, "map_Kd has no option " + quoted(unknown),
               "the options are -o -s -t -clamp -blendu -blendv -cc -mm -boost -texres -bm -imfchan -type");
  }
  // A picture that is missing is an error where it is wanted: a scene may replace it, or not use the material.
  reference.path = found.value_or(path_beside(scan_.path(), name));
  return reference;
}

}  // namespace

std::vector<MtlMaterial> read_mtl(const std::string& path) { return MtlReader(path).read(); }

}  // namespace vitrum
