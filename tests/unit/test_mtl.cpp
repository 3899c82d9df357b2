#include <doctest/doctest.h>

#include "scene/mtl_reader.hpp"
#include "scratch.hpp"

using namespace vitrum;

namespace {

std::vector<MtlMaterial> read(const std::string& text) {
  const ScratchFolder folder;
  return read_mtl(folder.write("a.mtl", text));
}

/// The only material of `text`, its lines being those after newmtl.
MtlMaterial read_one(const std::string& lines) {
  std::vector<MtlMaterial> materials = read("newmtl m\n" + lines);
  REQUIRE(materials.size() == 1);
  return materials[0];
}

std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

}  // namespace

TEST_CASE("the default scene's materials") {
  const std::vector<MtlMaterial> materials = read_mtl(VITRUM_SOURCE_DIR "/models/default_scene/default_scene.mtl");
  REQUIRE(materials.size() == 3);
  const MtlMaterial &green = materials[0], &glass = materials[1], &gray = materials[2];
  CHECK(green.name == "green");
  CHECK(green.Ka->value == Spectrum(.01, .07, 0));
  CHECK(green.Kd->value == Spectrum(.09, .63, 0));
  CHECK(green.illum->value == 1);
  CHECK(file_name(green.map_Kd->value.path) == "grass.png");
  CHECK_FALSE(green.Ni);
  CHECK(glass.name == "glass");
  CHECK(glass.Ks->value == Spectrum(.3));
  CHECK(glass.Kd->value == Spectrum(0));
  CHECK(glass.Ns->value == 42);
  CHECK(glass.Ni->value == 1.5);
  CHECK(glass.illum->value == 2);
  CHECK(gray.name == "gray");
  CHECK(gray.Ka->value == Spectrum(.12, .09, .06));
  CHECK(gray.Kd->value == Spectrum(.28, .21, .14));
  CHECK(gray.illum->value == 1);
}

TEST_CASE("every value knows its place") {
  const MtlMaterial m = read_one("# c\n  Kd .5\n\tNi 1.5\n");
  CHECK(m.where.line == 1);
  CHECK(m.Kd->where.line == 3);
  CHECK(m.Kd->where.column == 3);
  CHECK(m.Ni->where.line == 4);
  CHECK(file_name(m.Ni->where.file) == "a.mtl");
}

TEST_CASE("one number of a colour counts for all channels") {
  CHECK(read_one("Kd .09").Kd->value == Spectrum(.09));
  CHECK(read_one("Kd .1 .2 .3 # c").Kd->value == Spectrum(.1, .2, .3));
}

TEST_CASE("all keywords") {
  const MtlMaterial m = read_one("Ka 1\nKd 2\nKs 3\nKe 4\nTf 5\nNs 6\nNi 7\nd 8\nillum 9\nPr .1\nPm .2\n");
  CHECK(m.Ka->value == Spectrum(1));
  CHECK(m.Kd->value == Spectrum(2));
  CHECK(m.Ks->value == Spectrum(3));
  CHECK(m.Ke->value == Spectrum(4));
  CHECK(m.Tf->value == Spectrum(5));
  CHECK(m.Ns->value == 6);
  CHECK(m.Ni->value == 7);
  CHECK(m.d->value == 8);
  CHECK(m.illum->value == 9);
  CHECK(m.Pr->value == .1);
  CHECK(m.Pm->value == .2);
  CHECK(m.unused.empty());
}

TEST_CASE("keywords without use are listed with their place") {
  const MtlMaterial m = read_one("Tr 0.5 # x\nmap_Bump  -bm 2 a b.png\nd -halo .5\nKsomething\n");
  REQUIRE(m.unused.size() == 4);
  CHECK(m.unused[0].value == "Tr 0.5");
  CHECK(m.unused[0].where.line == 2);
  CHECK(m.unused[1].value == "map_Bump  -bm 2 a b.png");
  CHECK(m.unused[2].value == "d -halo");
  CHECK(m.d->value == .5);
  CHECK(m.unused[3].value == "Ksomething");
}

TEST_CASE("texts as they are found") {
  CHECK(read("").empty());
  CHECK(read("# nothing\n\n").empty());
  CHECK(read("\xEF\xBB\xBFnewmtl a\r\nKd 1 1 1\r\n")[0].Kd->where.line == 2);
  CHECK(read("newmtl  blue glass \r\n")[0].name == "blue glass");
  CHECK(read("newmtl Material #25 # old")[0].name == "Material #25");
  CHECK(read_one("illum 2.0").illum->value == 2);
  CHECK(read_one("Kd 1 \\\n 0 \\\r\n 0").Kd->value == Spectrum(1, 0, 0));
}

TEST_CASE("a material or a keyword given twice: the last counts, with a warning") {
  const ScratchFolder folder;
  const std::string path = folder.write("a.mtl", "newmtl a\nKd 1\nNi 2\nnewmtl b\nKd .1\nKd .2\nnewmtl a\nKd .5\n");
  CapturedWarnings warnings;
  const std::vector<MtlMaterial> materials = read_mtl(path);
  const std::string text = warnings.text();
  REQUIRE(materials.size() == 2);
  CHECK(materials[0].name == "a");
  CHECK(materials[0].where.line == 7);
  CHECK(materials[0].Kd->value == Spectrum(.5));
  CHECK_FALSE(materials[0].Ni);
  CHECK(materials[1].Kd->value == Spectrum(.2));
  CHECK(text.find("a.mtl:7:1: material 'a' is defined twice") != std::string::npos);
  CHECK(text.find("a.mtl:6:1: Kd is given twice for material 'b'") != std::string::npos);
}

TEST_CASE("texture names as they are found") {
  const ScratchFolder folder;
  folder.write("a.png", "");
  folder.write("b c.png", "");
  folder.write("sub/d.png", "");
  folder.write("-x.png", "");
  const auto path = [&](const std::string& name) {
    return read_mtl(folder.write("a.mtl", "newmtl m\nmap_Kd " + name + "\n"))[0].map_Kd->value.path;
  };
  CHECK(path("a.png") == folder.path("a.png"));
  CHECK(path("a.png \r") == folder.path("a.png"));
  CHECK(path("a.png # x") == folder.path("a.png"));
  CHECK(path("a.png #x") == folder.path("a.png"));
  CHECK(path("b c.png") == folder.path("b c.png"));
  CHECK(path("\"b c.png\"") == folder.path("b c.png"));
  CHECK(path("sub\\d.png") == folder.path("sub/d.png"));
  CHECK(path(".\\sub\\..\\a.png") == folder.path("a.png"));
  CHECK(path(folder.path("a.png")) == folder.path("a.png"));
  CHECK(path("-x.png") == folder.path("-x.png"));
  // What is missing is for the picture's reader to refuse, where it is wanted.
  CHECK(path("no\\such.png") == folder.path("no/such.png"));
}

TEST_CASE("texture options") {
  const auto texture = [](const std::string& options) { return read_one("map_Kd " + options + " a b.png"); };
  const MtlMaterial all = texture("-s 2 3 1 -o .25 -clamp on -blendu on -cc off -mm 0 1 -t 0 0");
  CHECK(all.map_Kd->value.scale == glm::dvec2(2, 3));
  CHECK(all.map_Kd->value.offset == glm::dvec2(.25, 0));
  CHECK(all.map_Kd->value.clamp);
  CHECK(file_name(all.map_Kd->value.path) == "a b.png");
  CHECK(all.unused.empty());
  CHECK(texture("-s 2").map_Kd->value.scale == glm::dvec2(2, 1));
  CHECK_FALSE(texture("-clamp off").map_Kd->value.clamp);
  const MtlMaterial odd = texture("-mm .5 2 -t 1 -boost 3 -imfchan l -blendv off");
  std::string unused;
  for (const Said<std::string>& each : odd.unused) unused += each.value + ";";
  CHECK(unused == "map_Kd -mm;map_Kd -t;map_Kd -boost;map_Kd -imfchan l;map_Kd -blendv;");
}
