#include <doctest/doctest.h>

#include <cmath>

#include "scene/obj_reader.hpp"
#include "scratch.hpp"

using namespace vitrum;

namespace {

const std::string three_vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

/// Reads `text`; what it warns of is not shown.
ObjFile read(const std::string& text) {
  const ScratchFolder folder;
  const CapturedWarnings warnings;
  return read_obj(folder.write("a.obj", text));
}

/// Reads `text` and returns what it warned of.
std::string warnings_of(const std::string& text) {
  const ScratchFolder folder;
  CapturedWarnings warnings;
  read_obj(folder.write("a.obj", text));
  return warnings.text();
}

}  // namespace

TEST_CASE("positions, texture coordinates and normals keep indices of their own") {
  const Mesh mesh = read("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt .25 .5\nvt 1 0\nvn 0 0 2\nvn 0 3 4\n"
                         "f 1/2/1 2/1/2 3/2/1\nf 1/1 2/1 3/1\nf 1//2 2//2 3//1\nf 3 2 1\n").mesh;
  CHECK(mesh.positions == std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  CHECK(mesh.texcoords == std::vector<glm::vec2>{{.25f, .5f}, {1, 0}});
  CHECK(mesh.normals == std::vector<glm::vec3>{{0, 0, 1}, {0, .6f, .8f}});
  CHECK(mesh.triangles == std::vector<glm::uvec3>{{0, 1, 2}, {0, 1, 2}, {0, 1, 2}, {2, 1, 0}});
  CHECK(mesh.texcoord_indices == std::vector<glm::uvec3>{{1, 0, 1}, {0, 0, 0}, glm::uvec3(none), glm::uvec3(none)});
  CHECK(mesh.normal_indices == std::vector<glm::uvec3>{{0, 1, 0}, glm::uvec3(none), {1, 1, 0}, glm::uvec3(none)});
}

TEST_CASE("attributes that no face uses leave nothing behind") {
  const Mesh mesh = read(three_vertices + "vt 0 0\nvn 0 0 0\nf 1 2 3\n").mesh;
  CHECK(mesh.texcoords.empty());
  CHECK(mesh.normals.empty());
  CHECK(mesh.texcoord_indices.empty());
  CHECK(mesh.normal_indices.empty());
  CHECK(mesh.materials == std::vector<uint32_t>{none});
}

TEST_CASE("negative indices count back from the last, and faces may come before what they name") {
  CHECK(read("v 9 9 9\n" + three_vertices + "f -3 -2 -1\n").mesh.triangles[0] == glm::uvec3(1, 2, 3));
  const ObjFile file = read("usemtl a\nf 1 2 3\nusemtl b\nf 3 2 4\n" + three_vertices + "v 1 1 0\n");
  CHECK(file.mesh.triangles == std::vector<glm::uvec3>{{0, 1, 2}, {2, 1, 3}});
  CHECK(file.mesh.materials == std::vector<uint32_t>{0, 1});
}

TEST_CASE("numbers as they are found") {
  const Mesh mesh = read("v +1 -.5 1e-3\nv 1. 5.E-1 1e-60\nv 1e38 0 -0\nf 1 2 3\n").mesh;
  CHECK(mesh.positions[0] == glm::vec3(1, -.5f, 1e-3f));
  CHECK(mesh.positions[1] == glm::vec3(1, .5f, 0));
  CHECK(mesh.positions[2] == glm::vec3(1e38f, 0, 0));
  // w, colours, and both
  CHECK(read("v 0 0 0 1\nv 1 0 0 .5 .5 .5\nv 0 1 0 1 .5 .5 .5\nf 1 2 3\n").mesh.triangles.size() == 1);
  CHECK(read(three_vertices + "vt .5\nvt .5 .25 0\nf 1/1 2/2 3/2\n").mesh.texcoords ==
        std::vector<glm::vec2>{{.5f, 0}, {.5f, .25f}});
}

TEST_CASE("texts as they are found") {
  const auto triangles = [](const std::string& text) { return read(text).mesh.triangles; };
  const std::vector<glm::uvec3> one{{0, 1, 2}};
  CHECK(triangles("v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n") == one);
  CHECK(triangles("v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r") == one);
  CHECK(triangles("\xEF\xBB\xBF" + three_vertices + "f 1 2 3") == one);
  CHECK(triangles("# x\n\n  \t\n\tv  0\t0 0  \n v 1 0 0 # a corner\nv 0 1 0#b\nf 1 2 3 # 4 5\n#f 1 1 1") == one);
  CHECK(triangles(three_vertices + "f 1 \\\n 2 \\\r\n 3\n") == one);
  CHECK(triangles("# C:\\models\\\n" + three_vertices + "# f \\\nf 1 2 3\n") == one);
  CHECK(triangles(three_vertices + "vn 0 0 1\nf 1// 2// 3//\n") == one);
  CHECK(triangles(three_vertices + "vt 0 0\nf 1/1/ 2/1/ 3/1/\n") == one);
  CHECK(triangles(three_vertices + "fo 1 2 3\n") == one);
  CHECK(triangles(three_vertices + "o a\ng b c\ns off\nf 1 2 3\nmg 1 2\n") == one);
}

TEST_CASE("a line of over 1 MB, and continuations over many lines") {
  // A polygon of many corners, on one line and on a line for each corner.
  std::string vertices, face = "f", continued = "f";
  constexpr int corners = 150'000;
  for (int i = 0; i < corners; ++i) {
    const double angle = 6.283185307179586 * i / corners;
    vertices += "v " + std::to_string(1000 * std::cos(angle)) + ' ' + std::to_string(1000 * std::sin(angle)) + " 0\n";
    face += ' ' + std::to_string(i + 1);
    continued += " \\\n" + std::to_string(i + 1);
  }
  const std::string padded = face + std::string(1 << 20, ' ') + "# " + std::string(1 << 20, 'x') + "\n";
  const Mesh mesh = read(vertices + padded).mesh;
  CHECK(mesh.triangles.size() == corners - 2);
  CHECK(read(vertices + continued + "\n").mesh.triangles == mesh.triangles);
}

TEST_CASE("lines that straddle the reader's window") {
  std::string text;
  constexpr int triangles = 40'000;
  for (int i = 0; i < triangles; ++i) {
    const std::string n = std::to_string(i);
    text += "v " + n + " 0 0\nv " + n + " 1 0\r\nv " + n + " 0 1.5\nf -3 -2 \\\n -1\n";
  }
  const Mesh mesh = read(text).mesh;
  REQUIRE(mesh.triangles.size() == triangles);
  for (uint32_t i = 0; i < triangles; ++i) {
    REQUIRE(mesh.triangles[i] == glm::uvec3(3 * i, 3 * i + 1, 3 * i + 2));
    REQUIRE(mesh.positions[3 * i + 2] == glm::vec3(i, 0, 1.5f));
  }
}

TEST_CASE("materials by name, with spaces, and without one") {
  const ObjFile file = read(three_vertices + "f 1 2 3\nusemtl  blue glass \nf 1 2 3\nusemtl Material #25 # old\n"
                                             "f 1 2 3\nusemtl blue glass\nf 1 2 3\nusemtl\nf 1 2 3\n"
                                             "usemtl (null)\nf 3 2 1\n");
  CHECK(file.material_names == std::vector<std::string>{"blue glass", "Material #25"});
  CHECK(file.mesh.materials == std::vector<uint32_t>{none, 0, 1, 0, none, none});
  REQUIRE(file.material_uses.size() == 2);
  CHECK(file.material_uses[0].line == 5);
  CHECK(file.material_uses[1].line == 7);
  CHECK(file.library.empty());
}

TEST_CASE("libraries: one, several, names with spaces, twice the same, after usemtl") {
  const ScratchFolder folder;
  folder.write("a.mtl", "newmtl a\nKd 1 0 0\n");
  folder.write("b c.mtl", "newmtl b\nnewmtl c\n");
  folder.write("sub/d.MTL", "newmtl d\n");
  folder.write("plain", "newmtl e\n");
  const auto names = [&](const std::string& lines) {
    const std::string path = folder.write("x.obj", three_vertices + "usemtl a\nf 1 2 3\n" + lines);
    std::string found;
    for (const MtlMaterial& m : read_obj(path).library) found += m.name;
    return found;
  };
  CHECK(names("mtllib a.mtl\n") == "a");
  CHECK(names("mtllib ./a.mtl # mine\r\n") == "a");
  CHECK(names("mtllib b c.mtl") == "bc");
  CHECK(names("mtllib a.mtl b c.mtl sub\\d.MTL\n") == "abcd");
  CHECK(names("mtllib \"b c.mtl\"\nmtllib a.mtl\nmtllib a.mtl\n") == "bca");
  CHECK(names("mtllib plain a.mtl\n") == "ea");
}

TEST_CASE("a material defined in two libraries: the last counts, with a warning") {
  const ScratchFolder folder;
  folder.write("a.mtl", "newmtl glass\nNi 1.3\n");
  folder.write("b.mtl", "\nnewmtl glass\nNi 1.5\n");
  const std::string path = folder.write("x.obj", three_vertices + "mtllib a.mtl b.mtl\nusemtl glass\nf 1 2 3\n");
  CapturedWarnings warnings;
  const ObjFile file = read_obj(path);
  const std::string text = warnings.text();
  CHECK(text.find("b.mtl:2:1: material 'glass' is defined twice") != std::string::npos);
  REQUIRE(file.library.size() == 1);
  CHECK(file.library[0].Ni->value == 1.5);
}

TEST_CASE("what is odd is read with one warning for each kind") {
  SUBCASE("faces of two vertices and without area are skipped") {
    const std::string text = three_vertices + "v 2 0 0\nf 1 2 3\nf 1 2\nf 1 1 2\nf 1 2 4\nf 1 2 4 2\nf 2 3\n";
    CHECK(read(text).mesh.triangles.size() == 1);
    const std::string warnings = warnings_of(text);
    CHECK(warnings.find("a.obj:6:1: a face of two vertices is skipped (the first of 2)") != std::string::npos);
    CHECK(warnings.find("a.obj:7:1: a face without area is skipped (the first of 3)") != std::string::npos);
    CHECK(occurrences(warnings, "\n") == 2);
  }
  SUBCASE("index 0 of texture coordinates and normals") {
    const std::string text = three_vertices + "vt 0 0\nvn 0 0 1\nf 1/0/0 2/0/0 3/0/0\nf 1/1/1 2/1/1 3/1/1\n";
    const Mesh mesh = read(text).mesh;
    CHECK(mesh.normal_indices == std::vector<glm::uvec3>{glm::uvec3(none), glm::uvec3(0)});
    CHECK(mesh.texcoord_indices == std::vector<glm::uvec3>{glm::uvec3(none), glm::uvec3(0)});
    CHECK(occurrences(warnings_of(text), "index 0") == 1);
  }
  SUBCASE("normals of length 0") {
    const std::string text = three_vertices + "vn 0 0 0\nvn 1 0 0\nf 1//1 2//2 3//2\nf 1//2 2//2 3//2\n";
    const Mesh mesh = read(text).mesh;
    CHECK(mesh.normal_indices == std::vector<glm::uvec3>{glm::uvec3(none), glm::uvec3(1)});
    for (const glm::vec3& normal : mesh.normals) CHECK(glm::length(normal) == doctest::Approx(1));
    CHECK(warnings_of(text).find("a.obj:6:1: a normal of length 0") != std::string::npos);
  }
  SUBCASE("corners with and without") {
    const std::string text = three_vertices + "vt 0 0\nvn 0 0 1\nf 1/1 2 3\nf 1//1 2//1 3\n";
    const Mesh mesh = read(text).mesh;
    CHECK(mesh.normal_indices.empty());
    CHECK(mesh.texcoord_indices.empty());
    CHECK(occurrences(warnings_of(text), "only some corners") == 1);
  }
  SUBCASE("lines, points and unknown statements") {
    const std::string warnings = warnings_of(three_vertices + "l 1 2\nl 2 3\np 1\nxvw 1 2\nf 1 2 3\n");
    CHECK(warnings.find("a.obj:4:1: statement 'l' is ignored (the first of 2)") != std::string::npos);
    CHECK(warnings.find("statement 'p' is ignored\n") != std::string::npos);
    CHECK(warnings.find("statement 'xvw' is ignored\n") != std::string::npos);
  }
  SUBCASE("polygons that cross themselves") {
    const std::string text = "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 2 0\nf 1 2 3 4\n";
    CHECK(read(text).mesh.triangles.size() == 2);
    CHECK(warnings_of(text).find("a.obj:5:1: a polygon crosses itself") != std::string::npos);
  }
  SUBCASE("and what is sound gives none") {
    CHECK(warnings_of("o a\ns 1\nvn 0 0 9\n" + three_vertices + "f 1//1 2//1 3//1\nf 1 2 3\nf 1 2 3\n").empty());
  }
}

TEST_CASE("very small and very large normals become unit length") {
  const Mesh mesh = read(three_vertices + "vn 0 1e-38 0\nvn 1e38 0 1e38\nf 1//1 2//1 3//2\n").mesh;
  CHECK(mesh.normals[0] == glm::vec3(0, 1, 0));
  CHECK(mesh.normals[1].x == doctest::Approx(std::sqrt(.5)));
}

TEST_CASE("concave faces keep their area and the attributes of each corner") {
  const Mesh mesh = read("v 0 0 0\nv 4 2 0\nv 0 4 0\nv 1 2 0\nvt 0 0\nvt 1 0\nvt 0 1\nvt .5 .5\n"
                         "f 1/1 2/2 3/3 4/4\n").mesh;
  REQUIRE(mesh.triangles.size() == 2);
  CHECK(mesh.texcoord_indices == mesh.triangles);
  double area = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::vec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
    area += glm::cross(b - a, c - a).z / 2;
  }
  CHECK(area == doctest::Approx(6));
}
