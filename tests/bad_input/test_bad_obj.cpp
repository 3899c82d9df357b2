#include <doctest/doctest.h>
#include <sys/stat.h>

#include <algorithm>

#include "refusal.hpp"
#include "scene/obj_reader.hpp"
#include "scratch.hpp"

using namespace vitrum;

namespace {

const std::string three_vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

/// `text` as a.obj must be refused; faces of it are warned of before, at times.
void check_text(const std::string& text, const std::string& place, const std::string& problem) {
  const ScratchFolder folder;
  const std::string path = folder.write("a.obj", text);
  const CapturedWarnings warnings;
  check_refused([&] { read_obj(path); }, place, problem);
}

/// `line` after three vertices, so it is line 4.
void check_line(const std::string& line, const std::string& place, const std::string& problem) {
  check_text(three_vertices + line + "\nf 1 2 3\n", place, problem);
}

}  // namespace

TEST_CASE("OBJ: numbers that are none") {
  check_line("v 0 0 abc", "a.obj:4:7", "'abc' is no number");
  check_line("v 0,5 0 0", "a.obj:4:3", "'0,5' is no number");
  check_line("v 0 nan 0", "a.obj:4:5", "'nan' is not finite");
  check_line("v -nan(ind) 0 0", "a.obj:4:3", "'-nan(ind)' is not finite");
  check_line("v 0 0 inf", "a.obj:4:7", "'inf' is not finite");
  check_line("v 1.#INF 0 0", "a.obj:4:1", "a vertex has 1 numbers");
  check_line("v 0 1e39 0", "a.obj:4:5", "beyond what a 32 bit number holds");
  check_line("v 0 1e999 0", "a.obj:4:5", "beyond");
  check_line("v 1.0D+00 0 0", "a.obj:4:3", "is no number");
  check_line("v 0x10 0 0", "a.obj:4:3", "is no number");
  check_line("v 1 2 -", "a.obj:4:7", "is no number");
  check_line("v 1 2 ++3", "a.obj:4:7", "is no number");
  check_line("vn 0 0 NaN", "a.obj:4:8", "'NaN' is not finite");
  check_line("vt x", "a.obj:4:4", "'x' is no number");
}

TEST_CASE("OBJ: a decimal comma is named as such") {
  const ScratchFolder folder;
  const std::string path = folder.write("a.obj", "v 0,5 0 0\n");
  try {
    read_obj(path);
    FAIL("not refused");
  } catch (const Error& error) {
    CHECK(error.mend().find("decimal sign") != std::string::npos);
  }
}

TEST_CASE("OBJ: too few or too many numbers") {
  check_line("v 0 0", "a.obj:4:1", "a vertex has 2 numbers");
  check_line("v", "a.obj:4:1", "a vertex has 0 numbers");
  check_line("v 1 2 3 4 5", "a.obj:4:1", "a vertex has 5 numbers");
  check_line("v 1 2 3 4 5 6 7 8", "a.obj:4:17", "'8' is too much");
  check_line("vn 0 1", "a.obj:4:1", "a normal has 2 numbers");
  check_line("vn 0 1 0 0", "a.obj:4:10", "'0' is too much");
  check_line("vt", "a.obj:4:1", "a texture coordinate has 0 numbers");
  check_line("vt 0 0 0 0", "a.obj:4:10", "'0' is too much");
}

TEST_CASE("OBJ: indices to nothing") {
  check_line("f 1 2 0", "a.obj:4:7", "'0' refers to vertex 0");
  check_line("f 1 2 4", "a.obj:4:1", "refers to vertex 4, but the file has 3");
  check_line("f 1 2 -4", "a.obj:4:7", "'-4' refers to a vertex that is not there");
  check_line("f 1/1 2/1 3/1", "a.obj:4:1", "refers to texture coordinate 1, but the file has 0");
  check_line("f 1//2 2//2 3//2", "a.obj:4:1", "refers to normal 2, but the file has 0");
  check_line("f 1/-1 2/-1 3/-1", "a.obj:4:3", "'1/-1' refers to a texture coordinate that is not there");
  check_line("f 1//-1 2 3", "a.obj:4:3", "'1//-1' refers to a normal");
  check_line("f 1 2 4294967296", "a.obj:4:7", "refers to a vertex that is not there");
  check_line("f 1 2 18446744073709551617", "a.obj:4:7", "refers to a vertex that is not there");
  check_line("f 1 2 -99999999999999999999999999", "a.obj:4:7", "refers to a vertex that is not there");
}

TEST_CASE("OBJ: corners that are none") {
  check_line("f 1 2 x", "a.obj:4:7", "'x' is no corner of a face");
  check_line("f 1 2 1,002", "a.obj:4:7", "'1,002' is no corner of a face");
  check_line("f 1 2 3.0", "a.obj:4:7", "'3.0' is no corner of a face");
  check_line("f 1 2 /3", "a.obj:4:7", "'/3' names no vertex");
  check_line("f 1 / 3", "a.obj:4:5", "'/' names no vertex");
  check_line("f 1/1/1/1 2 3", "a.obj:4:3", "more than three indices");
  check_line("f 1/a 2 3", "a.obj:4:3", "'1/a' is no corner");
  check_line("f 1 2 -", "a.obj:4:7", "'-' is no corner");
  check_line("f", "a.obj:4:1", "a face of no vertex");
  check_line("f 2", "a.obj:4:1", "a face of one vertex");
}

TEST_CASE("OBJ: places on continued lines") {
  check_text(three_vertices + "f 1 \\\n 2 \\\n  x\n", "a.obj:6:3", "'x' is no corner");
}

TEST_CASE("OBJ: keywords that only look like some") {
  check_line("V 0 0 0", "a.obj:4:1", "keyword 'V' is not known");
  check_line("F 1 2 3", "a.obj:4:1", "keyword 'F' is not known");
  check_line("f1 2 3", "a.obj:4:1", "'f1' is no keyword");
  check_line("v-1 0 0", "a.obj:4:1", "'v-1' is no keyword");
  check_line("1 2 3", "a.obj:4:1", "'1' is no keyword");
  check_line("call other.obj", "a.obj:4:1", "not supported");
}

TEST_CASE("OBJ: a mesh without a triangle of any area") {
  check_text("", "a.obj", "is empty");
  check_text("# only a comment", "a.obj", "is empty");
  check_text(three_vertices, "a.obj", "has no faces");
  check_text(three_vertices + "f 1 2\nf 1 2 2\n", "a.obj", "none of its faces has any area");
}

TEST_CASE("OBJ: other formats of that name") {
  check_text("ply\nformat ascii 1.0\nelement vertex 8\n", "a.obj:1:1", "it starts with 'ply'");
  check_text("solid cube\nfacet normal 0 0 1\n", "a.obj:1:1", "it starts with 'solid cube'");
  check_text("OFF\n8 6 12\n", "a.obj:1:1", "it starts with 'OFF'");
  check_text("<?xml version=\"1.0\"?>\n", "a.obj:1:1", "it starts with '<?xml");
  check_text(std::string("glTF\2\0\0\0", 8), "a.obj", "binary");
  check_text(std::string("\x64\x86\3\0\0\0", 6), "a.obj", "binary");
  check_text("version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 1\n", "a.obj", "Git LFS pointer");
  check_text(std::string("\xFF\xFEv\0 \0", 6), "a.obj", "UTF-16");
  check_text(std::string("\xFE\xFF\0v\0 ", 6), "a.obj", "UTF-16");
  check_text(std::string("v\0 \0000\0", 6), "a.obj", "binary");
}

TEST_CASE("OBJ: binary data further on") {
  std::string text = three_vertices;
  while (text.size() < 1 << 20) text += "v 0 0 0\n";
  check_text(text + std::string(10, '\0'), "a.obj", "turns into binary data");
}

TEST_CASE("OBJ: what is no file to read") {
  const ScratchFolder folder;
  check_refused([&] { read_obj(folder.path("no.obj")); }, "no.obj", "No such file");
  std::filesystem::create_directory(folder.path("folder.obj"));
  check_refused([&] { read_obj(folder.path("folder.obj")); }, "folder.obj", "this is a folder");
  REQUIRE(::mkfifo(folder.path("pipe.obj").c_str(), 0600) == 0);
  check_refused([&] { read_obj(folder.path("pipe.obj")); }, "pipe.obj", "a pipe or a device");
  check_refused([] { read_obj("/dev/zero"); }, "zero", "a pipe or a device");
  std::filesystem::create_symlink("loop.obj", folder.path("loop.obj"));
  check_refused([&] { read_obj(folder.path("loop.obj")); }, "loop.obj", "cannot read");
  check_refused([&] { read_obj(""); }, "", "cannot read");
}

TEST_CASE("OBJ: a file over the limit is refused before it is read") {
  const ScratchFolder folder;
  const std::string path = folder.write("big.obj", three_vertices + "f 1 2 3\n");
  std::filesystem::resize_file(path, uintmax_t{65} << 30);  // sparse
  check_refused([&] { read_obj(path); }, "big.obj", "more than 65536 MiB");
}

TEST_CASE("OBJ: material libraries that are missing or broken") {
  check_line("mtllib", "a.obj:4:1", "mtllib names no file");
  check_line("mtllib no.mtl", "a.obj:4:8", "no.mtl' does not exist");
  const ScratchFolder folder;
  folder.write("a.mtl", "newmtl a\n");
  folder.write("bad.mtl", "newmtl a\nKd x\n");
  const auto read = [&](const std::string& line) {
    read_obj(folder.write("a.obj", line + "\n" + three_vertices + "f 1 2 3\n"));
  };
  check_refused([&] { read("mtllib a.mtl no.mtl"); }, "a.obj:1:14", "no.mtl' does not exist");
  check_refused([&] { read("mtllib bad.mtl"); }, "bad.mtl:2:4", "'x' is no number");
  check_refused([&] { read("mtllib ."); }, "", "this is a folder");
}

TEST_CASE("OBJ: noise is refused or read, never worse") {
  // Bytes changed, cut and doubled in a sound file.
  const ScratchFolder folder;
  const std::string sound = "# c\nmtllib a.mtl\n" + three_vertices +
                            "v 1 1 .5\nvt 0 0\nvt 1 1\nvn 0 0 1\nusemtl a\nf 1/1/1 2/2/1 3/1/1\nf 1 2 4 3\n"
                            "f -1//-1 -2//1 \\\n -3//1\n";
  folder.write("a.mtl", "newmtl a\nKd 1 1 1\n");
  const CapturedWarnings warnings;
  uint32_t state = 1;
  const auto random = [&](size_t below) {
    state = state * 1664525u + 1013904223u;
    return (state >> 8) % static_cast<uint32_t>(below);
  };
  const auto largest = [](const glm::uvec3& t) { return std::max(t.x, std::max(t.y, t.z)); };
  constexpr int rounds = 600;
  int refused = 0, accepted = 0;
  for (int round = 0; round < rounds; ++round) {
    std::string text = sound;
    for (uint32_t i = 0; i <= random(2); ++i) {
      const uint32_t at = random(text.size());
      switch (random(4)) {
        case 0: text[at] = static_cast<char>(random(256)); break;
        case 1: text.erase(at, 1 + random(5)); break;
        case 2: text.insert(at, text.substr(random(text.size()), 1 + random(9))); break;
        default: text[at] = "0123456789-/. \n\\#fv"[random(19)]; break;
      }
    }
    try {
      const Mesh mesh = read_obj(folder.write("a.obj", text)).mesh;
      ++accepted;
      for (const glm::uvec3& t : mesh.triangles) {
        REQUIRE(largest(t) < mesh.positions.size());
      }
      for (const glm::uvec3& t : mesh.normal_indices) {
        REQUIRE((t.x == none || largest(t) < mesh.normals.size()));
      }
      for (const glm::uvec3& t : mesh.texcoord_indices) {
        REQUIRE((t.x == none || largest(t) < mesh.texcoords.size()));
      }
    } catch (const Error& error) {
      ++refused;
      REQUIRE_FALSE(error.mend().empty());
    }
  }
  CHECK(refused > rounds / 20);
  CHECK(accepted > rounds / 20);
}
