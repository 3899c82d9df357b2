#include "scene/materials.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scratch.hpp"

using namespace vitrum;

namespace {

constexpr auto common = MtlReading::common;
constexpr auto worksheet = MtlReading::worksheet;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// A material said in an MTL file, line 1 being newmtl m.
MtlMaterial said(const std::string& lines) {
  const ScratchFolder folder;
  return read_mtl(folder.write("x.mtl", "newmtl m\n" + lines)).at(0);
}

struct Interpreted {
  Material material;
  std::optional<Texture> texture;
  std::string warnings;
};

Interpreted read(const MtlMaterial& m, MtlReading reading) {
  CapturedWarnings warnings;
  InterpretedMaterial result = interpret(m, reading);
  return {std::move(result.material), std::move(result.texture), warnings.text()};
}
Interpreted read(const std::string& lines, MtlReading reading) { return read(said(lines), reading); }

bool reports(const Interpreted& result, const std::string& line) {
  const auto& lines = result.material.provenance;
  return std::find(lines.begin(), lines.end(), line) != lines.end();
}

template <typename T>
Said<T> in_scene(T value) {
  return {std::move(value), {"scene.toml", 31, 5}};
}

void check_refused(const MtlMaterial& m, MtlReading reading, const std::string& problem) {
  CAPTURE(problem);
  try {
    interpret(m, reading);
    FAIL("not refused");
  } catch (const Error& error) {
    CHECK(error.problem().find(problem) != std::string::npos);
    CHECK(error.where().line > 0);
    CHECK_FALSE(error.mend().empty());
  }
}

}  // namespace

TEST_CASE("illum in both readings") {
  struct Row {
    int illum;
    const char *common, *worksheet;
    Surface surface_common, surface_worksheet;
    bool warns;
  };
  using enum Surface;
  const Row rows[] = {
      {0, "reflectance", "reflectance", unlit, unlit, false},
      {1, "lambertian", "lambertian", opaque, opaque, false},
      {2, "phong", "glossy", opaque, dielectric, false},
      {3, "mirror", "mirror", mirror, mirror, false},
      {4, "transparent", "transparent", dielectric, dielectric, false},
      {5, "mirror", "mirror", mirror, mirror, true},
      {6, "transparent", "transparent", dielectric, dielectric, true},
      {7, "transparent", "transparent", dielectric, dielectric, false},
      {8, "mirror", "mirror", mirror, mirror, false},
      {9, "transparent", "transparent", dielectric, dielectric, false},
      {10, "lambertian", "lambertian", opaque, opaque, true},
      {11, "volume", "volume", dielectric, dielectric, false},
      {12, "glossy volume", "glossy volume", dielectric, dielectric, false},
      {13, "lambertian", "lambertian", opaque, opaque, true},
  };
  for (const Row& row : rows) {
    CAPTURE(row.illum);
    const std::string lines = "illum " + std::to_string(row.illum) + "\n";
    const Interpreted as_common = read(lines, common), as_worksheet = read(lines, worksheet);
    CHECK(as_common.material.shader == row.common);
    CHECK(as_common.material.surface == row.surface_common);
    CHECK(as_worksheet.material.shader == row.worksheet);
    CHECK(as_worksheet.material.surface == row.surface_worksheet);
    CHECK(as_common.warnings.empty() == !row.warns);
    CHECK(as_worksheet.warnings.empty() == !row.warns);
    const std::string reading = row.illum == 2 ? " by mtl = common" : "";
    const std::string place = " (illum " + std::to_string(row.illum) + reading + ", x.mtl:2)";
    CHECK(reports(as_common, "shader " + as_common.material.shader + place));
  }
  CHECK(read("illum 99\nKs .5\n", common).material.shader == "phong");
  CHECK(read("illum 99\nNi 1.5\n", worksheet).material.shader == "glossy");
  check_refused(said("illum -1"), common, "illum is negative");
}

TEST_CASE("without illum: what the other keywords tell") {
  CHECK(read("Kd .5\n", common).material.shader == "lambertian");
  CHECK(read("Ks 0 0 0\n", common).material.shader == "lambertian");
  CHECK(read("Ks .5\n", common).material.shader == "phong");
  CHECK(read("Kd .5\n", worksheet).material.shader == "lambertian");
  CHECK(read("Ks .5\nNi 1.5\n", worksheet).material.shader == "glossy");
  CHECK(read("Ks .5\n", worksheet).material.shader == "phong");
  CHECK(reports(read("Kd .5\n", common), "shader lambertian (default: no illum)"));
}

TEST_CASE("Tf means glass beside PBR keywords, in the common reading of opaque materials") {
  const Interpreted glass = read("illum 2\nTf 1 1 1\nPr 0\nNi 1.45\n", common);
  CHECK(glass.material.shader == "transparent");
  CHECK(glass.material.index.value == 1.45);
  CHECK(reports(glass, "shader transparent (Tf beside Pr, x.mtl:3)"));
  CHECK(read("illum 2\nTf 1 1 1\n", common).material.shader == "phong");
  CHECK(read("illum 2\nTf 0 0 0\nPm 0\n", common).material.shader == "phong");
  CHECK(read("illum 3\nTf 1 1 1\nPm 0\n", common).material.shader == "mirror");
  CHECK(read("illum 1\nTf 1 1 1\nPm 0\n", worksheet).material.shader == "lambertian");
}

TEST_CASE("a shader's name wins over illum") {
  for (const char* name :
       {"reflectance", "lambertian", "phong", "glossy", "mirror", "transparent", "volume", "glossy volume"}) {
    MtlMaterial m = said("illum 3\n");
    m.shader = in_scene<std::string>(name);
    for (const MtlReading reading : {common, worksheet}) {
      const Interpreted result = read(m, reading);
      CHECK(result.material.shader == name);
      CHECK(reports(result, "shader " + std::string(name) + " (shader, scene.toml:31)"));
      CHECK(reports(result, "unused: illum 3 (x.mtl:2)"));
    }
  }
  MtlMaterial m = said("");
  m.shader = in_scene<std::string>("glass");
  check_refused(m, common, "there is no shader 'glass'");
}

TEST_CASE("each shader takes what it shows") {
  const std::string lines = "Kd .5 .6 .7\nKs .3\nNs 42\nNi 1.5\nillum ";
  const auto as = [&](int illum, MtlReading reading) { return read(lines + std::to_string(illum), reading).material; };
  const Spectrum Kd(.5, .6, .7), Ks(.3), dark(0.0);
  CHECK(as(0, common).diffuse == Kd);
  CHECK(as(1, common).diffuse == Kd);
  CHECK(as(1, common).specular == dark);
  CHECK(as(2, common).diffuse == Kd);
  CHECK(as(2, common).specular == Ks);
  CHECK(as(2, common).shininess == 42);
  const Material glossy = as(2, worksheet);
  CHECK(glossy.diffuse == Kd);
  CHECK(glossy.specular == Ks);
  CHECK(glossy.absorption == dark);
  CHECK(glossy.index.value == 1.5);
  const Material transparent = as(4, common);
  CHECK(transparent.diffuse == dark);
  CHECK(transparent.specular == dark);
  CHECK(transparent.absorption == dark);
  const Material volume = as(11, common);
  CHECK(volume.diffuse == dark);
  CHECK(volume.specular == dark);
  CHECK(volume.absorption.r == doctest::Approx(1));
  const Material glossy_volume = as(12, worksheet);
  CHECK(glossy_volume.diffuse == dark);
  CHECK(glossy_volume.specular == Ks);
  CHECK(glossy_volume.absorption.g == doctest::Approx(2.0 / 3));
  CHECK(as(3, common).specular == dark);
}

TEST_CASE("absorption from Kd") {
  const auto sigma = [](const std::string& Kd) { return read("illum 11\nKd " + Kd, common).material.absorption; };
  CHECK(sigma("1 1 1") == Spectrum(0.0));
  CHECK(std::signbit(sigma("1 1 1").r) == false);
  CHECK(sigma(".5 .2 .8").g == doctest::Approx(4));
  CHECK(sigma("0 .5 1") == Spectrum(infinity, 1, 0));
  // No cancellation near 1.
  const double gap = std::ldexp(1.0, -45);
  MtlMaterial clear = said("illum 11\n");
  clear.Kd = in_scene(Spectrum(1 - gap));
  CHECK(read(clear, common).material.absorption.r == gap / (1 - gap));
  CHECK(read("illum 11\n", common).material.absorption == Spectrum(0.0));
  check_refused(said("illum 12\nKd 1.5 1 1\n"), common, "out of range");
  check_refused(said("illum 12\nKd -1 1 1\n"), common, "out of range");
}

TEST_CASE("absorption given directly, or as a colour at a distance") {
  MtlMaterial m = said("illum 4\n");
  m.absorption = in_scene(Spectrum(1, 2, 3));
  CHECK(read(m, common).material.absorption == Spectrum(1, 2, 3));
  m.absorption_colour = in_scene(Spectrum(.5));
  m.absorption_distance = in_scene(.1);
  check_refused(m, common, "given twice");
  m.absorption.reset();
  m.absorption_colour = in_scene(Spectrum(1, .5, 0));
  const Interpreted coloured = read(m, common);
  CHECK(coloured.material.absorption.r == 0);
  CHECK_FALSE(std::signbit(coloured.material.absorption.r));
  CHECK(coloured.material.absorption.g == doctest::Approx(std::log(2.0) / .1));
  CHECK(coloured.material.absorption.b == infinity);
  CHECK(reports(coloured, "absorption 0 6.93 inf 1/m: opaque in the channels of inf "
                          "(absorption_colour by -ln(T) / distance, scene.toml:31)"));
  m.absorption_distance = in_scene(0.0);
  check_refused(m, common, "no distance");
  m.absorption_distance.reset();
  check_refused(m, common, "without absorption_distance");
  m.absorption_colour.reset();
  m.absorption_distance = in_scene(1.0);
  check_refused(m, common, "without absorption_colour");
  m.absorption_distance.reset();
  m.absorption = in_scene(Spectrum(1, -1, 0));
  check_refused(m, common, "negative");
  // It wins over Kd, and has no meaning on what is opaque.
  m = said("illum 12\nKd .5\n");
  m.absorption = in_scene(Spectrum(0.0));
  CHECK(read(m, worksheet).material.absorption == Spectrum(0.0));
  CHECK(reports(read(m, worksheet), "unused: Kd 0.5 0.5 0.5 (x.mtl:3)"));
  m = said("illum 1\n");
  m.absorption = in_scene(Spectrum(1.0));
  CHECK(read(m, common).warnings.find("absorption has no effect") != std::string::npos);
}

TEST_CASE("the index of refraction") {
  CHECK(read("illum 4\nNi 1.33\n", common).material.index.value == 1.33);
  const Interpreted missing = read("illum 4\n", common);
  CHECK(missing.material.index.value == 1.5);
  CHECK(reports(missing, "index 1.5 (default)"));
  for (const char* Ni : {"0", "-1.5", "0.0005", "11"}) {
    check_refused(said(std::string("illum 4\nNi ") + Ni), common, "no index of refraction");
  }
  const Interpreted opaque = read("illum 1\nNi 0\n", common);
  CHECK(opaque.warnings.find("x.mtl:3:1: material 'm': Ni 0 is ignored") != std::string::npos);
  CHECK(read("illum 1\nNi 1.5\n", common).warnings.empty());
  CHECK(reports(read("illum 1\nNi 1.5\n", common), "unused: Ni 1.5 (x.mtl:3)"));
}

TEST_CASE("emission: Ke in the common reading, Ka in the worksheet's") {
  const std::string lines = "Ka .1 .2 .3\nKe 5\nillum ";
  CHECK(read(lines + "1\n", common).material.emission == Spectrum(5.0));
  CHECK(read(lines + "1\n", common).material.emission_is_light);
  CHECK(reports(read(lines + "1\n", common), "unused: Ka 0.1 0.2 0.3 (x.mtl:2)"));
  CHECK(read(lines + "1\n", worksheet).material.emission == Spectrum(.1, .2, .3));
  CHECK(read(lines + "1\n", worksheet).material.emission_is_light);
  CHECK(read(lines + "1\n", worksheet).warnings.find("Ke has no effect") != std::string::npos);
  CHECK(read(lines + "2\n", worksheet).material.emission == Spectrum(0.0));
  CHECK_FALSE(read("illum 1\nKa 0 0 0\n", worksheet).material.emission_is_light);
  check_refused(said("illum 1\nKe -1\n"), common, "emission");
}

TEST_CASE("textures in both readings, and what a scene says of them") {
  MtlMaterial m = said("illum 1\nKd .5\nmap_Kd -s 2 -o .5 -clamp on t.png\n");
  const Interpreted as_common = read(m, common), as_worksheet = read(m, worksheet);
  REQUIRE(as_common.texture);
  CHECK(as_common.texture->colour_space == ColourSpace::srgb);
  CHECK(as_common.texture->filter == TextureFilter::bilinear);
  CHECK_FALSE(as_common.material.texture_replaces_diffuse);
  CHECK(as_common.material.diffuse == Spectrum(.5));
  CHECK(as_common.texture->scale == glm::dvec2(2, 1));
  CHECK(as_common.texture->offset == glm::dvec2(.5, 0));
  CHECK(as_common.texture->clamp);
  CHECK(as_common.texture->where.line == 4);
  CHECK(as_common.material.diffuse_texture == none);
  CHECK(as_worksheet.texture->colour_space == ColourSpace::linear);
  CHECK(as_worksheet.material.texture_replaces_diffuse);
  m.texture_filter = in_scene(TextureFilter::nearest);
  m.texture_colour_space = in_scene(ColourSpace::linear);
  CHECK(read(m, common).texture->colour_space == ColourSpace::linear);
  CHECK(read(m, common).texture->filter == TextureFilter::nearest);
  const Interpreted on_mirror = read("illum 3\nmap_Kd t.png\n", common);
  CHECK_FALSE(on_mirror.texture);
  CHECK(on_mirror.warnings.find("map_Kd has no effect on the shader mirror") != std::string::npos);
}

TEST_CASE("defaults of what is left out") {
  CHECK(read("illum 1\n", common).material.diffuse == Spectrum(.8));
  CHECK(read("illum 1\nmap_Kd t.png\n", common).material.diffuse == Spectrum(1));
  CHECK(read("illum 2\n", worksheet).material.diffuse == Spectrum(0.0));
  CHECK(read("illum 2\nKs .5\n", common).material.shininess == 10);
  CHECK(reports(read("illum 2\nKs .5\n", common), "shininess 10 (default)"));
}

TEST_CASE("values out of range") {
  const Interpreted bright = read("illum 1\nKd 1.5 .5 .5\n", common);
  CHECK(bright.material.diffuse == Spectrum(1.5, .5, .5));
  CHECK(bright.warnings.find("x.mtl:3:1: material 'm': Kd is above 1") != std::string::npos);
  check_refused(said("illum 1\nKd -.1 0 0\n"), common, "Kd -0.1 0 0 is negative");
  check_refused(said("illum 2\nKs -.1\n"), common, "Ks");
  check_refused(said("illum 2\nNs -1\n"), common, "Ns -1");
  CHECK(read("illum 2\nd .5\n", common).warnings.find("d 0.5 (coverage) has no effect") != std::string::npos);
  CHECK(read("illum 4\nd .5\n", common).warnings.empty());
}

TEST_CASE("the report tells of the default scene's glass with illum 12") {
  MtlMaterial glass = read_mtl(VITRUM_SOURCE_DIR "/models/default_scene/default_scene.mtl").at(1);
  CHECK(reports(read(glass, worksheet), "shader glossy (illum 2 by mtl = worksheet, default_scene.mtl:17)"));
  MtlMaterial over;
  over.name = "glass";
  over.where = {"scene.toml", 30, 1};
  over.illum = in_scene(12);
  over.Kd = in_scene(Spectrum(.6, .9, .7));
  const Interpreted result = read(overlaid(glass, over), worksheet);
  CHECK(result.material.name == "glass");
  CHECK(reports(result, "shader glossy volume (illum 12, scene.toml:31)"));
  CHECK(reports(result, "index 1.5 (Ni, default_scene.mtl:16)"));
  CHECK(reports(result, "absorption 0.667 0.111 0.429 1/m (Kd by 1/rho_d - 1, scene.toml:31)"));
  CHECK(reports(result, "specular 0.3 0.3 0.3 (Ks, default_scene.mtl:14)"));
  CHECK(reports(result, "shininess 42 (Ns, default_scene.mtl:15)"));
  glass.illum->value = 12;
  CHECK(reports(read(glass, worksheet),
                "absorption inf inf inf 1/m: opaque, black glass (Kd by 1/rho_d - 1, default_scene.mtl:13)"));
}

TEST_CASE("every keyword is used or reported as unused") {
  const Interpreted result = read("Ka 1\nKd 1\nKs 1\nKe 1\nTf 1\nNs 1\nd 1\nillum 3\nTr .5\nmap_bump a.png\n", common);
  for (const char* line : {"unused: Ka 1 1 1 (x.mtl:2)", "unused: Kd 1 1 1 (x.mtl:3)", "unused: Ks 1 1 1 (x.mtl:4)",
                           "emission 1 1 1 W/(m2 sr) (Ke, x.mtl:5)", "unused: Tf 1 1 1 (x.mtl:6)",
                           "unused: Ns 1 (x.mtl:7)", "unused: d 1 (x.mtl:8)", "shader mirror (illum 3, x.mtl:9)",
                           "unused: Tr .5 (x.mtl:10)",
                           "unused: map_bump a.png (x.mtl:11)"}) {
    CHECK_MESSAGE(reports(result, line), line);
  }
  CHECK(result.material.provenance.size() == 10);
}

TEST_CASE("a place given by --set is shown whole") {
  MtlMaterial m;
  m.Ni = Said<double>{1.4, {"--set material.a/b.Ni=1.4", 0, 0}};
  m.illum = in_scene(4);
  CHECK(reports(read(m, common), "index 1.4 (Ni, --set material.a/b.Ni=1.4)"));
}

TEST_CASE("priority is for media") {
  MtlMaterial m = said("illum 4\n");
  m.priority = in_scene(3);
  CHECK(read(m, common).material.priority == 3);
  m.illum->value = 1;
  CHECK(read(m, common).material.priority == 0);
  CHECK(reports(read(m, common), "unused: priority 3 (scene.toml:31)"));
}

TEST_CASE("what is laid over replaces what it says, and nothing else") {
  MtlMaterial base = said("Kd .1\nKs .2\nillum 4\nTr 1\n");
  base.absorption = in_scene(Spectrum(1.0));
  base.shader = in_scene<std::string>("volume");
  MtlMaterial over;
  over.where = {"scene.toml", 7, 1};
  over.Kd = in_scene(Spectrum(.9));
  MtlMaterial result = overlaid(base, over);
  CHECK(result.name == "m");
  CHECK(result.where.line == 7);
  CHECK(result.Kd->value == Spectrum(.9));
  CHECK(result.Kd->where.file == "scene.toml");
  CHECK(result.Ks->value == Spectrum(.2));
  CHECK(result.absorption);
  CHECK(result.shader->value == "volume");
  CHECK(result.unused.size() == 1);
  // Other words for the same thing.
  over.illum = in_scene(12);
  over.absorption_colour = in_scene(Spectrum(.5));
  over.absorption_distance = in_scene(1.0);
  result = overlaid(base, over);
  CHECK_FALSE(result.shader);
  CHECK(result.illum->value == 12);
  CHECK_FALSE(result.absorption);
  CHECK(result.absorption_distance->value == 1);
}
