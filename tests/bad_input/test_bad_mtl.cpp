#include <doctest/doctest.h>
#include <sys/stat.h>

#include "refusal.hpp"
#include "scene/mtl_reader.hpp"
#include "scratch.hpp"

using namespace vitrum;

namespace {

void check_text(const std::string& text, const std::string& place, const std::string& problem) {
  const ScratchFolder folder;
  const std::string path = folder.write("a.mtl", text);
  const CapturedWarnings warnings;
  check_refused([&] { read_mtl(path); }, place, problem);
}

/// `line` in a material, so it is line 2.
void check_line(const std::string& line, const std::string& place, const std::string& problem) {
  check_text("newmtl m\n" + line + "\nNs 1\n", place, problem);
}

}  // namespace

TEST_CASE("MTL: numbers that are none") {
  check_line("Kd .5 x .5", "a.mtl:2:7", "'x' is no number");
  check_line("Kd 0,5 0,5 0,5", "a.mtl:2:4", "'0,5' is no number");
  check_line("Ni abc", "a.mtl:2:4", "'abc' is no number");
  check_line("Ns nan", "a.mtl:2:4", "'nan' is not finite");
  check_line("Ke 1 inf 1", "a.mtl:2:6", "'inf' is not finite");
  check_line("d 1e999", "a.mtl:2:3", "beyond what a 64 bit number holds");
  check_line("illum glass", "a.mtl:2:7", "'glass' is no number");
  check_line("illum 2.5", "a.mtl:2:7", "'2.5' is no illumination model");
  check_line("illum 1e9", "a.mtl:2:7", "'1e9' is no illumination model");
}

TEST_CASE("MTL: too few or too many values") {
  check_line("Kd", "a.mtl:2:1", "Kd has no number");
  check_line("Kd .1 .2", "a.mtl:2:1", "Kd has two numbers");
  check_line("Kd .1 .2 .3 .4", "a.mtl:2:13", "'.4' is too much");
  check_line("Ni", "a.mtl:2:1", "Ni has no number");
  check_line("Ni 1.5 1.6", "a.mtl:2:8", "'1.6' is too much");
  check_line("illum", "a.mtl:2:1", "illum has no number");
  check_line("d -halo", "a.mtl:2:1", "d has no number");
}

TEST_CASE("MTL: colours that are not red, green and blue") {
  check_line("Kd spectral a.rfl 1", "a.mtl:2:4", "spectral are not supported");
  check_line("Kd xyz 1 1 1", "a.mtl:2:4", "xyz are not supported");
}

TEST_CASE("MTL: keywords of another case, and lines before any material") {
  check_line("kd 1 1 1", "a.mtl:2:1", "keyword 'kd' is not known");
  check_line("map_kd a.png", "a.mtl:2:1", "keyword 'map_kd' is not known");
  check_text("Kd 1 1 1\nnewmtl a\n", "a.mtl:1:1", "'Kd' stands before any newmtl");
  check_text("v 0 0 0\n", "a.mtl:1:1", "'v' stands before any newmtl");
  check_text("newmtl\n", "a.mtl:1:1", "newmtl names no material");
}

TEST_CASE("MTL: textures") {
  check_line("map_Kd", "a.mtl:2:1", "map_Kd names no picture");
  check_line("map_Kd -s 1 1 1", "a.mtl:2:1", "map_Kd names no picture");
  check_line("map_Kd -s a.png", "a.mtl:2:11", "'a.png' is no number");
  check_line("map_Kd -o", "a.mtl:2:8", "-o has no number");
  check_line("map_Kd -clamp a.png", "a.mtl:2:15", "-clamp wants on or off");
  check_line("map_Kd -scale 2 a.png", "a.mtl:2:8", "no option '-scale'");
}

TEST_CASE("MTL: what is no text of materials") {
  const ScratchFolder folder;
  check_refused([&] { read_mtl(folder.path("no.mtl")); }, "no.mtl", "No such file");
  std::filesystem::create_directory(folder.path("folder.mtl"));
  check_refused([&] { read_mtl(folder.path("folder.mtl")); }, "folder.mtl", "this is a folder");
  REQUIRE(::mkfifo(folder.path("pipe.mtl").c_str(), 0600) == 0);
  check_refused([&] { read_mtl(folder.path("pipe.mtl")); }, "pipe.mtl", "a pipe or a device");
  check_refused([] { read_mtl("/dev/zero"); }, "zero", "a pipe or a device");
  check_text("version https://git-lfs.github.com/spec/v1\n", "a.mtl", "Git LFS pointer");
  check_text(std::string("\xFF\xFEn\0", 4), "a.mtl", "UTF-16");
  check_text(std::string("newmtl a\0\n", 10), "a.mtl", "binary");
  const std::string big = folder.write("big.mtl", "newmtl a\n");
  std::filesystem::resize_file(big, uintmax_t{1} << 30);
  check_refused([&] { read_mtl(big); }, "big.mtl", "more than 256 MiB");
}
