// A reader of our own, because tinyobjloader 2.0rc10 answers "ok" to broken files (words and NaN become 0, indices past
// the end come back unchecked), knows no lines, and loses area of concave polygons. On 4 million triangles (300 MB) it
// takes 2.3 times the CPU time and 3.2 times the memory: tests/unit/test_obj_against_tinyobjloader.cpp, where it is the
// oracle for sound files, measures both.

#include "scene/obj_reader.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <span>
#include <unordered_map>

#include "core/log.hpp"
#include "scene/find_file.hpp"
#include "scene/line_scanner.hpp"
#include "scene/obj_oddities.hpp"
#include "scene/triangulate.hpp"

namespace vitrum {
namespace {

constexpr uint64_t max_obj_bytes = uint64_t{64} << 30;

/// Legal, and without a meaning for surfaces of glass: passed over in silence.
constexpr std::array silent_keywords{"g",          "o",         "s",         "mg",      "bevel", "c_interp", "d_interp",
                                     "lod",        "shadow_obj", "trace_obj", "ctech",   "stech", "maplib",   "usemap",
                                     "bmat",       "step",      "cstype",    "deg",     "parm",  "trim",     "hole",
                                     "scrv",       "sp",        "end",       "con",     "vp"};

/// One corner of a face: indices from 0, or `none`.
struct Corner {
  uint32_t position, texcoord, normal;
};

/// A face that names vertices further down in the file: legal, rare, done at the end.
struct WaitingFace {
  int line, column;
  uint32_t material;
  std::vector<Corner> corners;
};

class ObjReader {
 public:
  explicit ObjReader(const std::string& path) : scan_(path, "OBJ", max_obj_bytes) {}

  ObjFile read() {
    while (scan_.next_line()) read_line();
    finish_waiting_faces();
    finish_mesh();
    oddities_.report();
    return std::move(file_);
  }

 private:
  void read_line();
  void read_vertex();
  void read_texcoord();
  void read_normal();
  void read_face();
  void read_other();
  Corner read_corner(const char* c, const char* end);
  uint32_t resolve(int64_t index, size_t count, const char* what);
  bool names_all_known(std::span<const Corner> corners) const;
  void add_face(std::span<const Corner> corners, const SourceLocation* where);
  void add_triangle(const Corner& a, const Corner& b, const Corner& c, bool has_normals, bool has_texcoords);
  bool has_usable_normals(std::span<const Corner> corners, const SourceLocation* where);
  void use_material();
  void read_libraries();
  void read_library(std::string_view name);
  void finish_waiting_faces();
  void finish_mesh();

  template <size_t N>
  size_t read_numbers(std::array<float, N>& values, size_t least, const char* what);

  void note(Oddity oddity, const SourceLocation* where = nullptr) {
    oddities_.note(oddity, [&] { return where != nullptr ? *where : scan_.where(); });
  }

  LineScanner scan_;
  ObjFile file_;
  Mesh& mesh_ = file_.mesh;
  uint32_t material_ = none;
  std::unordered_map<std::string, uint32_t> material_indices_;
  std::unordered_map<std::string, size_t> library_indices_;
  std::vector<std::string> libraries_read_;
  std::vector<WaitingFace> waiting_;
  std::vector<Corner> corners_;             // of the face at hand
  std::vector<glm::vec3> polygon_;
  std::vector<glm::uvec3> cut_;
  size_t faces_ = 0;
  ObjOddities oddities_;
};

void ObjReader::read_line() {
  const std::string_view keyword = scan_.keyword();
  if (keyword == "v") return read_vertex();
  if (keyword == "f" || keyword == "fo") return read_face();  // fo: the name of f before version 2
  if (keyword == "vn") return read_normal();
  if (keyword == "vt") return read_texcoord();
  if (keyword == "usemtl") return use_material();
  if (keyword == "mtllib") return read_libraries();
  read_other();
}

/// Reads all numbers of the line: at least `least` and at most N; the others stay as they are.
template <size_t N>
size_t ObjReader::read_numbers(std::array<float, N>& values, size_t least, const char* what) {
  size_t count = 0;
  while (count < N) {
    const std::optional<float> value = scan_.next_number<float>();
    if (!value) break;
    values[count++] = *value;
  }
  if (count < least) {
    scan_.fail({}, std::string(what) + " has " + std::to_string(count) + " numbers",
               "write at least " + std::to_string(least));
  }
  const std::string_view extra = scan_.next_word();
  if (!extra.empty()) {
    scan_.fail(extra, quoted(extra) + " is too much for " + what,
               "write at most " + std::to_string(N) + " numbers and each statement on a line of its own");
  }
  return count;
}

void ObjReader::read_vertex() {
  // x y z, then w, or a colour, or both: of no use here.
  std::array<float, 7> values;
  const size_t count = read_numbers(values, 3, "a vertex");
  if (count == 5) scan_.fail({}, "a vertex has 5 numbers", "write x y z, x y z w or x y z r g b");
  mesh_.positions.emplace_back(values[0], values[1], values[2]);
}

void ObjReader::read_texcoord() {
  std::array<float, 3> values{};
  read_numbers(values, 1, "a texture coordinate");
  mesh_.texcoords.emplace_back(values[0], values[1]);
}

void ObjReader::read_normal() {
  std::array<float, 3> values;
  read_numbers(values, 3, "a normal");
  const glm::dvec3 normal(values[0], values[1], values[2]);
  const double length = glm::length(normal);
  mesh_.normals.emplace_back(length > 0 ? normal / length : glm::dvec3(0.0));
}

/// The index from 0 that `index` means: counted from 1, or backwards from -1, the last one given so far.
uint32_t ObjReader::resolve(int64_t index, size_t count, const char* what) {
  if (index > 0 && index < none) return static_cast<uint32_t>(index - 1);
  if (index > 0 || -index > static_cast<int64_t>(count)) {
    const std::string_view word = scan_.peek_word();
    scan_.fail(word, quoted(word) + " refers to a " + what + " that is not there: " + std::to_string(count) +
               (count == 1 ? " is given" : " are given") + " so far", "check the program that wrote the file");
  }
  return static_cast<uint32_t>(static_cast<int64_t>(count) + index);
}

/// Reads a whole number as std::from_chars does, in half its time, for this is where the time of reading goes.
/// Returns where it ends: `c` itself if there is none; beyond 18 digits it is `none`, which no list reaches.
const char* read_index(const char* c, const char* end, int64_t& index) {
  const bool is_negative = c != end && *c == '-';
  const char* const first = c + (is_negative ? 1 : 0);
  const char* digit = first;
  uint64_t value = 0;
  for (; digit != end && *digit >= '0' && *digit <= '9'; ++digit) {
    value = 10 * value + static_cast<uint64_t>(*digit - '0');
  }
  if (digit == first) return c;
  if (digit - first > 18) value = none;
  index = is_negative ? -static_cast<int64_t>(value) : static_cast<int64_t>(value);
  return digit;
}

/// Reads v, v/vt, v//vn or v/vt/vn, where the scanner stands at the first character of it.
Corner ObjReader::read_corner(const char* c, const char* end) {
  std::array<int64_t, 3> indices{};
  std::array<bool, 3> is_given{};
  const auto refuse = [&](const std::string& problem, const char* mend) {
    const std::string_view word = scan_.peek_word();
    scan_.fail(word, quoted(word) + problem, mend);
  };
  for (size_t i = 0;; ++i) {
    const char* const stop = read_index(c, end, indices[i]);
    is_given[i] = stop != c;
    c = stop;
    if (scan_.is_word_end(c)) break;
    if (*c != '/') refuse(" is no corner of a face", "write whole numbers as v, v/vt, v//vn or v/vt/vn");
    if (i == 2) refuse(" has more than three indices", "write v, v/vt, v//vn or v/vt/vn");
    ++c;
  }
  if (indices[0] == 0) refuse(is_given[0] ? " refers to vertex 0" : " names no vertex", "vertices count from 1");
  if ((is_given[1] && indices[1] == 0) || (is_given[2] && indices[2] == 0)) note(Oddity::zero_index);
  const Corner corner{resolve(indices[0], mesh_.positions.size(), "vertex"),
                      indices[1] == 0 ? none : resolve(indices[1], mesh_.texcoords.size(), "texture coordinate"),
                      indices[2] == 0 ? none : resolve(indices[2], mesh_.normals.size(), "normal")};
  scan_.go_on_from(c);
  return corner;
}

bool ObjReader::names_all_known(std::span<const Corner> corners) const {
  return std::all_of(corners.begin(), corners.end(), [&](const Corner& corner) {
    return corner.position < mesh_.positions.size() &&
           (corner.texcoord == none || corner.texcoord < mesh_.texcoords.size()) &&
           (corner.normal == none || corner.normal < mesh_.normals.size());
  });
}

void ObjReader::read_face() {
  corners_.clear();
  for (;;) {
    const auto [begin, end] = scan_.ahead();
    if (scan_.is_word_end(begin)) break;
    corners_.push_back(read_corner(begin, end));
  }
  ++faces_;
  if (corners_.size() < 2) {
    scan_.fail({}, std::string("a face of ") + (corners_.empty() ? "no vertex" : "one vertex"), "write at least three");
  }
  if (names_all_known(corners_)) {
    add_face(corners_, nullptr);
  } else {
    const SourceLocation where = scan_.where();
    waiting_.push_back({where.line, where.column, material_, corners_});
  }
}

/// Normals of all corners, each of some length.
bool ObjReader::has_usable_normals(std::span<const Corner> corners, const SourceLocation* where) {
  size_t given = 0;
  bool has_zero = false;
  for (const Corner& corner : corners) {
    if (corner.normal == none) continue;
    ++given;
    has_zero = has_zero || mesh_.normals[corner.normal] == glm::vec3(0.0f);
  }
  if (given != 0 && given != corners.size()) note(Oddity::partly_given, where);
  if (has_zero) note(Oddity::zero_normal, where);
  return given == corners.size() && !has_zero;
}

/// Adds the triangles of a face. `where` is its place if it isn't the line at hand.
void ObjReader::add_face(std::span<const Corner> corners, const SourceLocation* where) {
  if (corners.size() == 2) return note(Oddity::two_vertices, where);
  const auto textured = static_cast<size_t>(
      std::count_if(corners.begin(), corners.end(), [](const Corner& corner) { return corner.texcoord != none; }));
  if (textured != 0 && textured != corners.size()) note(Oddity::partly_given, where);
  const bool has_texcoords = textured == corners.size();
  const bool has_normals = has_usable_normals(corners, where);

  polygon_.clear();
  for (const Corner& corner : corners) polygon_.push_back(mesh_.positions[corner.position]);
  cut_.clear();
  if (!triangulate(polygon_, cut_)) note(Oddity::crossing, where);
  if (cut_.empty()) return note(Oddity::no_area, where);
  for (const glm::uvec3& t : cut_) add_triangle(corners[t.x], corners[t.y], corners[t.z], has_normals, has_texcoords);
}

/// Appends indices of a triangle to a list that stays empty as long as no triangle has any.
void append_indices(std::vector<glm::uvec3>& list, size_t triangles_before, bool is_given, const glm::uvec3& indices) {
  if (!is_given && list.empty()) return;
  if (list.empty()) list.assign(triangles_before, glm::uvec3(none));
  list.push_back(is_given ? indices : glm::uvec3(none));
}

void ObjReader::add_triangle(const Corner& a, const Corner& b, const Corner& c, bool has_normals, bool has_texcoords) {
  const size_t before = mesh_.triangles.size();
  append_indices(mesh_.normal_indices, before, has_normals, {a.normal, b.normal, c.normal});
  append_indices(mesh_.texcoord_indices, before, has_texcoords, {a.texcoord, b.texcoord, c.texcoord});
  mesh_.triangles.emplace_back(a.position, b.position, c.position);
  mesh_.materials.push_back(material_);
}

void ObjReader::use_material() {
  const std::string name(scan_.rest());
  // Blender writes an empty name, or "(null)", for faces without a material.
  if (name.empty() || name == "(null)") {
    material_ = none;
    return;
  }
  const auto [entry, is_new] = material_indices_.try_emplace(name, static_cast<uint32_t>(file_.material_names.size()));
  if (is_new) {
    file_.material_names.push_back(name);
    file_.material_uses.push_back(scan_.where());
  }
  material_ = entry->second;
}

void ObjReader::read_libraries() {
  const std::string_view names = scan_.rest();
  if (names.empty()) scan_.fail({}, "mtllib names no file", "write the name of an MTL file, or remove the line");
  for (const std::string_view name : split_file_names(scan_.path(), names, ".mtl")) read_library(name);
}

void ObjReader::read_library(std::string_view name) {
  const std::optional<std::string> path = find_file(scan_.path(), name);
  if (!path) {
    scan_.fail(name, "the material library " + quoted(path_beside(scan_.path(), name)) + " does not exist",
               "put it there, or correct the name");
  }
  // Some exporters repeat the line for every object.
  if (std::find(libraries_read_.begin(), libraries_read_.end(), *path) != libraries_read_.end()) return;
  libraries_read_.push_back(*path);
  for (MtlMaterial& material : read_mtl(*path)) {
    const auto [entry, is_new] = library_indices_.try_emplace(material.name, file_.library.size());
    if (is_new) {
      file_.library.push_back(std::move(material));
      continue;
    }
    MtlMaterial& earlier = file_.library[entry->second];
    warn(material.where, "material " + quoted(material.name) + " is defined twice, before at " +
                             to_string(earlier.where) + "; this one counts");
    earlier = std::move(material);
  }
}

bool equals_lower_case(std::string_view word, std::string_view keyword) {
  return std::equal(word.begin(), word.end(), keyword.begin(), keyword.end(),
                    [](unsigned char x, unsigned char y) { return std::tolower(x) == y; });
}

/// What makes no triangle. What only looks like a statement is refused, since skipping a face opens a glass.
void ObjReader::read_other() {
  const std::string_view keyword = scan_.keyword();
  if (std::find(silent_keywords.begin(), silent_keywords.end(), keyword) != silent_keywords.end()) return;
  if (keyword == "call") scan_.fail({}, "other files called in are not supported", "paste that file here");
  const bool is_known = keyword == "l" || keyword == "p" || keyword == "curv" || keyword == "curv2" ||
                        keyword == "surf" || keyword == "csh";
  if (!is_known) {
    for (const char* mine : {"v", "vt", "vn", "f", "usemtl", "mtllib"}) {
      if (equals_lower_case(keyword, mine)) {
        scan_.fail({}, "keyword " + quoted(keyword) + " is not known", std::string("write ") + mine);
      }
    }
    const size_t letters = std::min(keyword.find_first_of("0123456789+-."), keyword.size());
    const std::string_view head = keyword.substr(0, letters);
    if (letters < keyword.size() && (head.empty() || head == "v" || head == "f" || head == "vt" || head == "vn")) {
      scan_.fail({}, quoted(keyword) + " is no keyword",
                 head.empty() ? "end the line before with a backslash if this one continues it"
                              : "write a space after " + std::string(head));
    }
    const bool is_first_statement = mesh_.positions.empty() && faces_ == 0 && !oddities_.has_ignored();
    if (is_first_statement && libraries_read_.empty()) {
      scan_.fail({}, "this is no OBJ file: it starts with " + quoted(scan_.line()), "export the model as OBJ");
    }
  }
  if (!oddities_.ignore_statement(keyword, scan_.where())) {
    scan_.fail({}, "keyword " + quoted(keyword) + " is not known, nor were many before it",
               "check that this is an OBJ file");
  }
}

void ObjReader::finish_waiting_faces() {
  for (const WaitingFace& face : waiting_) {
    const SourceLocation where{scan_.path(), face.line, face.column};
    for (const Corner& corner : face.corners) {
      const auto check = [&](uint32_t index, size_t count, const char* what) {
        if (index == none || index < count) return;
        throw Error(where, std::string("this face refers to ") + what + " " + std::to_string(uint64_t{index} + 1) +
                               ", but the file has " + std::to_string(count),
                    "check the program that wrote the file");
      };
      check(corner.position, mesh_.positions.size(), "vertex");
      check(corner.texcoord, mesh_.texcoords.size(), "texture coordinate");
      check(corner.normal, mesh_.normals.size(), "normal");
    }
    material_ = face.material;
    add_face(face.corners, &where);
  }
}

void ObjReader::finish_mesh() {
  const SourceLocation whole_file{scan_.path(), 0, 0};
  if (mesh_.triangles.empty()) {
    if (faces_ > 0) throw Error(whole_file, "none of its faces has any area", "check the model and its scale");
    throw Error(whole_file, mesh_.positions.empty() ? "this OBJ file is empty" : "this OBJ file has no faces",
                "export the model with its faces (triangles or polygons)");
  }
  if (mesh_.positions.size() >= none || mesh_.triangles.size() >= none || mesh_.normals.size() >= none ||
      mesh_.texcoords.size() >= none) {
    throw Error(whole_file, "more than 4294967294 elements of a kind", "split the model");
  }
  if (mesh_.normal_indices.empty()) {
    mesh_.normals = {};
  } else {
    // No face uses these; all the same every normal is of unit length.
    std::replace(mesh_.normals.begin(), mesh_.normals.end(), glm::vec3(0.0f), glm::vec3(0, 0, 1));
  }
  if (mesh_.texcoord_indices.empty()) mesh_.texcoords = {};
}

}  // namespace

ObjFile read_obj(const std::string& path) { return ObjReader(path).read(); }

}  // namespace vitrum
