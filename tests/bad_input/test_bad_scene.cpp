// Scene files that cannot be what their author meant: every error names file, line and mend.

#include <doctest/doctest.h>
#include <sys/stat.h>

#include <optional>
#include <vector>

#include "scene/scene_file.hpp"
#include "scratch.hpp"

using namespace vitrum;

namespace {

std::optional<Error> error_of(const std::string& path, const std::vector<std::string>& overrides = {}) {
  try {
    load_scene(path, overrides);
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

/// A scene file, the line of its error, and pieces of the message.
struct BadScene {
  std::string text;
  int line;
  std::vector<std::string> pieces;
};

void check(const BadScene& bad) {
  CAPTURE(bad.text);
  const ScratchFolder folder;
  const std::string path = folder.write("scene.toml", bad.text);
  const std::optional<Error> error = error_of(path);
  REQUIRE(error);
  const std::string message = error->what();
  CAPTURE(message);
  CHECK(error->where().file == path);
  CHECK(error->where().line == bad.line);
  CHECK_FALSE(error->mend().empty());
  for (const std::string& piece : bad.pieces) {
    CAPTURE(piece);
    CHECK(message.find(piece) != std::string::npos);
  }
}

void check(const std::vector<BadScene>& cases) {
  for (const BadScene& bad : cases) check(bad);
}

// Beginnings of scenes; what follows is the fault.
const std::string head = "vitrum = 1\ncamera = { eye = [0, 0, 5], look_at = [0, 0, 0] }\n";         // goes on in line 3
const std::string material = "[material.m]\nKd = 0.5\n";                                            // two lines
const std::string sphere = head + material + "[shape.s]\ntype = \"sphere\"\nmaterial = \"m\"\n";    // in line 8
const std::string unit_sphere = sphere + "centre = [0, 0, 0]\nradius = 1\n";                        // in line 10
const std::string camera = "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\n";                      // three lines
const std::string lamp = "[light.lamp]\ntype = \"point\"\nposition = [0, 0, 0]\nintensity = 1\n";   // four lines

}  // namespace

TEST_CASE("text that is no TOML") {
  check(std::vector<BadScene>{
      {"vitrum = 1\nx = .5\n", 2, {":2:", "digits on both sides"}},
      {"vitrum = 1\nx = 0,5\n", 2, {"point"}},
      {"vitrum = 1\nx = True\n", 2, {"true or false"}},
      {"vitrum = 1\nx = \"open\n", 2, {"close the string"}},
      {"vitrum = 1\nvitrum = 1\n", 2, {"cannot redefine", "say it once"}},
      {"vitrum = 1\n\n[camera\n", 3, {"table header"}},
      {"vitrum = 1\n[=film]\n", 2, {"names hold letters"}},
      {"vitrum = 1\nx = 99999999999999999999\n", 2, {"smaller number"}},
      {"vitrum = 1\nx = [1, 2\n", 2, {"array"}},
      {"vitrum = 1\nx = '\xff'\n", 2, {"UTF-8"}},
      {"vitrum = 1\nhello\n", 2, {"KEY = VALUE"}},
      {std::string("\xff\xfev\0", 4), 1, {"UTF-16"}},
      {std::string("vitrum\0", 7), 0, {"binary"}},
  });
}

TEST_CASE("nesting that would exhaust the stack") {
  std::string dots, brackets, mixed = "x = ";
  for (int i = 0; i < 100'000; ++i) dots += "a.";
  for (int i = 0; i < 100'000; ++i) brackets += "[";
  for (int i = 0; i < 1'000; ++i) mixed += "{a.a.a.a.a.a.a.a = ";
  check(std::vector<BadScene>{
      {"vitrum = 1\n" + dots + "a = 1\n", 2, {"nested deeper"}},
      {"vitrum = 1\n[" + dots + "a]\n", 2, {"nested deeper"}},
      {"vitrum = 1\nx = " + brackets, 2, {"nested deeper"}},
      {"vitrum = 1\n" + mixed, 2, {"nested deeper"}},
      // Quotes at the end of a long string belong to it and open none.
      {"vitrum = 1\ny = { z = \"\"\"\nshe said \"no\"\"\"\", " + dots + "a = 1 }\n", 3, {"nested deeper"}},
      {"vitrum = 1\ny = { z = '''it's''''', " + dots + "a = 1 }\n", 2, {"nested deeper"}},
      {"vitrum = 1\ny = \"a\\\\\" # \"\n" + dots + "a = 1\n", 3, {"nested deeper"}},
  });
}

TEST_CASE("points and brackets in strings and comments are no nesting") {
  const std::string points(1000, '.'), brackets(1000, '[');
  check({"vitrum = 1\n# " + points + brackets + "\nx = \"" + points + "\\\"" + brackets + "\"\n", 3, {"x is not a key"}});
  check({"vitrum = 1\nx = '''\n" + points + brackets + "'\n'''\n", 2, {"x is not a key"}});
}

TEST_CASE("what is no scene file at all") {
  const ScratchFolder folder;
  const auto check_file = [&](const std::string& path, const std::string& piece) {
    CAPTURE(path);
    const std::optional<Error> error = error_of(path);
    REQUIRE(error);
    CAPTURE(error->what());
    CHECK(error->where().file == path);
    CHECK(std::string(error->what()).find(piece) != std::string::npos);
    CHECK_FALSE(error->mend().empty());
  };
  check_file(folder.path("absent.toml"), "no such scene file");
  check_file(folder.path(""), "folder");
  check_file("/dev/zero", "not a regular file");
  check_file(folder.write("empty.toml", ""), "vitrum = 1");

  const std::string fifo = folder.path("fifo");
  REQUIRE(mkfifo(fifo.c_str(), 0600) == 0);
  check_file(fifo, "not a regular file");

  const std::string huge = folder.write("huge.toml", "vitrum = 1\n");
  std::filesystem::resize_file(huge, (16u << 20) + 1);
  check_file(huge, "16 MiB");
}

TEST_CASE("keys at the top") {
  check(std::vector<BadScene>{
      {camera, 0, {"vitrum = 1"}},
      {"vitrum = 2\n" + camera, 1, {"vitrum is 2"}},
      {"vitrum = \"1\"\n" + camera, 1, {"whole number", "the text '1'"}},
      {"vitrum = 1\n", 0, {"camera is missing"}},
      {"vitrum = 1\nligths = 3\n" + camera, 2, {"ligths is not a key of the scene file", "did you mean 'light'?"}},
      {"vitrum = 1\nb = 3\na = 3\n" + camera, 2, {"b is not a key"}},
      {"vitrum = 1\nunit = \"km\"\n" + camera, 2, {"unit is 'km'", "m, cm, mm"}},
      {"vitrum = 1\nunit = 0\n" + camera, 2, {"out of range"}},
      {"vitrum = 1\nunit = true\n" + camera, 2, {"unit wants text"}},
      {"vitrum = 1\nmtl = \"worksheets\"\n" + camera, 2, {"did you mean 'worksheet'?"}},
      {"vitrum = 1\nmaterials = \"x.mtl\"\n" + camera + lamp, 2, {"array of texts"}},
      {"vitrum = 1\nmaterials = [\n\"x.mtl\"]\n" + camera + lamp, 3, {"materials names", "x.mtl", "does not exist"}},
      {"vitrum = 1\nmaterials = [\".\"]\n" + camera + lamp, 2, {"no regular file"}},
      {"vitrum = 1\n" + camera, 0, {"neither shapes nor lights"}},
      {"vitrum = 1\nfilm = 3\n" + camera, 2, {"film wants a table", "[film]"}},
      {"vitrum = 1\nfilm = 1979-05-27\n" + camera, 2, {"film wants a table", "a date"}},
  });
}

TEST_CASE("camera, film and background") {
  check(std::vector<BadScene>{
      {"vitrum = 1\n[camera]\nlook_at = [0, 0, 0]\n", 2, {"camera.eye is missing", "[camera]"}},
      {"vitrum = 1\n[camera]\neyes = [0, 0, 0]\nlook_at = [0, 0, 0]\n", 3, {"camera.eyes is not a key", "mean 'eye'?"}},
      {"vitrum = 1\n[camera]\neye = [0, 0]\nlook_at = [0, 0, 0]\n", 3, {"camera.eye wants an array of 3", "array of 2"}},
      {"vitrum = 1\n[camera]\neye = [0, 0,\n\"x\"]\nlook_at = [0, 0, 0]\n", 4, {"camera.eye wants", "the text 'x'"}},
      {"vitrum = 1\n[camera]\neye = [0, 0, nan]\nlook_at = [0, 0, 0]\n", 3, {"not finite"}},
      {"vitrum = 1\n[camera]\neye = [0, 0, 1e10]\nlook_at = [0, 0, 0]\n", 3, {"out of range"}},
      {"vitrum = 1\n[camera]\neye = [0, 0, 9223372036854775807]\nlook_at = [0, 0, 0]\n", 3, {"out of range: 9223372036854775808"}},
      {"vitrum = 1\n[camera]\neye = [1, 1, 1]\nlook_at = [1, 1, 1]\n", 4, {"where the eye is"}},
      {"vitrum = 1\n[camera]\neye = [0, 5, 0]\nlook_at = [0, 0, 0]\nup = [0, 2, 0]\n", 5, {"parallel to the view"}},
      {"vitrum = 1\n[camera]\neye = [0, 5, 0]\nlook_at = [0, 0, 0]\n", 2, {"camera.up is parallel to the view"}},
      {"vitrum = 1\n" + camera + "up = [0, 0, 0]\n", 5, {"its length is 0"}},
      {"vitrum = 1\n" + camera + "vertical_fov = 180\n", 5, {"out of range: 180", "between 0.001 and 179"}},
      {"vitrum = 1\n" + camera + "type = \"fisheye\"\n", 5, {"fisheye", "pinhole"}},
      {head + "[film]\nsize = [512, 0]\n", 4, {"film.size is out of range: 0"}},
      {head + "[film]\nsize = [512.5, 512]\n", 4, {"whole numbers"}},
      {head + "[film]\nsize = [65536, 65536]\n", 4, {"2^28"}},
      {head + "[film]\nsize = 512\n", 4, {"array of 2 whole numbers", "the number 512"}},
      {head + "[film]\ngamma = 0\n", 4, {"film.gamma is out of range"}},
      {head + "[film]\nfilter = \"gauss\"\n", 4, {"box"}},
      {head + "[film]\ndisplay = \"rgb\"\n", 4, {"did you mean 'srgb'?"}},
      {head + "[film]\nexposure = 200\n", 4, {"out of range"}},
      {head + "[background]\nradiance = [1, -1, 1]\n", 4, {"background.radiance is out of range: -1"}},
      {head + "[background]\nradiance = \"blue\"\n", 4, {"a colour", "the text 'blue'"}},
      {head + "[background]\ncolour = [1, 1, 1]\n", 4, {"background.colour is not a key"}},
  });
}

TEST_CASE("render and photon settings") {
  check(std::vector<BadScene>{
      {head + "[render]\nsamples = 0\n", 4, {"render.samples is out of range"}},
      {head + "[render]\nsamples = 1.5\n", 4, {"whole number", "1.5"}},
      {head + "[render]\npasses = 0\n", 4, {"out of range"}},
      {head + "[render]\nseed = -1\n", 4, {"out of range"}},
      {head + "[render]\nreflectance = 1.5\n", 4, {"out of range: 1.5", "between 0 and 1"}},
      {head + "[render]\nreflectance = \"fresnell\"\n", 4, {"\"fresnel\" or a number"}},
      {head + "[render]\nreflectance = true\n", 4, {"render.reflectance wants"}},
      {head + "[render]\ncaustics = \"no\"\n", 4, {"true or false"}},
      {head + "[render]\nlights = 1\n", 4, {"true or false"}},
      {head + "[render]\ncaustic = true\n", 4, {"did you mean 'caustics'?"}},
      {head + "[render]\nmax_depth = 0\n", 4, {"out of range"}},
      {head + "[render]\nmin_weight = 2\n", 4, {"out of range"}},
      {head + "[render]\nsampling = \"sobol\"\n", 4, {"low-discrepancy"}},
      {head + "[render]\ntarget_error = 0\n", 4, {"render.target_error is out of range"}},
      {head + "[render]\ntime_limit = -1\n", 4, {"render.time_limit is out of range"}},
      {head + "[render]\ntarget_error = 0.1\n[photons]\nestimate = \"nearest\"\n", 6,
       {"photons.estimate does not go with render.target_error", "footprints"}},
      {head + "[render]\ntime_limit = 9\n[photons]\nestimate = \"radius\"\n", 6,
       {"photons.estimate does not go with render.time_limit", "automatic"}},
      {head + "[render]\ntime_limit = 9\n[photons]\nprogressive = true\n", 6,
       {"photons.progressive does not go with render.time_limit", "leave it out"}},
      {head + "[photons]\ncount = 0\n", 4, {"photons.count is out of range"}},
      {head + "[photons]\nradius = 0\n", 4, {"photons.radius is out of range"}},
      {head + "[photons]\nmax_radius = -1\n", 4, {"photons.max_radius is out of range"}},
      {head + "[photons]\nnearest = 0\n", 4, {"photons.nearest is out of range"}},
      {head + "[photons]\nestimate = \"nearest\"\nnearest = 65\n", 5,
       {"photons.nearest is more than can be searched for (64)", "automatic"}},
      {head + "[photons]\nestimate = \"nearest\"\nprogressive = true\n", 5,
       {"photons.progressive needs a radius that can shrink", "automatic"}},
      {head + "[photons]\nestimate = \"footprints\"\nprogressive = true\n", 5,
       {"photons.progressive needs a radius that can shrink", "photons.count"}},
      {head + "[photons]\nestimate = \"radios\"\n", 4, {"did you mean 'radius'?"}},
      {head + "[photons]\nmax_depth = 1000000\n", 4, {"out of range"}},
  });
}

TEST_CASE("lights") {
  const std::string light = head + "[light.l]\n";
  check(std::vector<BadScene>{
      {head + "[light]\ntype = \"point\"\n", 4, {"light.type wants a table", "[light.NAME]"}},
      {head + "[[light]]\ntype = \"point\"\n", 3, {"light wants tables by name"}},
      {head + "[light.\"\"]\ntype = \"point\"\n", 3, {"empty name"}},
      {light + "position = [0, 0, 0]\n", 3, {"light.l.type is missing"}},
      {light + "tpye = \"point\"\n", 4, {"light.l.tpye is not a key", "did you mean 'type'?"}},
      {light + "type = \"pont\"\n", 4, {"did you mean 'point'?"}},
      {head + "[light.\"a b\"]\ntype = \"point\"\nintensity = 1\n", 3, {"light.\"a b\".position is missing"}},
      {head + lamp + "radius = 1\n", 7, {"light.lamp.radius is not a key"}},
      {light + "type = \"point\"\nposition = [0, 0, 0]\nintensity = [-1, 0, 0]\n", 6, {"out of range"}},
      {light + "type = \"directional\"\nirradiance = 1\ndirection = [0, 0, 0]\n", 6, {"its length is 0"}},
      {light + "type = \"directional\"\nradiance = 1\ndirection = [0, 1, 0]\n", 5, {"did you mean 'irradiance'?"}},
      {light + "type = \"quad\"\ncorner = [0,0,0]\nedge_u = [1,0,0]\nedge_v = [2,0,0]\nradiance = 1\n", 7, {"no area"}},
      {light + "type = \"disc\"\ncentre = [0,0,0]\nnormal = [0,0,0]\nradius = 1\nradiance = 1\n", 6, {"length is 0"}},
      {light + "type = \"sphere\"\ncentre = [0, 0, 0]\nradius = -1\nradiance = 1\n", 6, {"out of range: -1"}},
      {light + "type = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\nradiance = 1\n", 5, {"did you mean 'centre'?"}},
  });
}

TEST_CASE("shapes") {
  const std::string plane = head + material + "[shape.p]\ntype = \"plane\"\nmaterial = \"m\"\npoint = [0, 0, 0]\n";
  const std::string triangle = head + material + "[shape.t]\ntype = \"triangle\"\nmaterial = \"m\"\n";
  const std::string mesh = head + material + "[shape.m]\ntype = \"mesh\"\n";
  check(std::vector<BadScene>{
      {head + "[shape.s]\ntype = \"cube\"\n", 4, {"shape.s.type is 'cube'"}},
      {sphere + "centre = [0, 0, 0]\n", 5, {"shape.s.radius is missing"}},
      {sphere + "centre = [0, 0, 0]\nradius = 0\n", 9, {"shape.s.radius is out of range"}},
      {sphere + "centre = [0, 0, 0]\nradius = inf\n", 9, {"not finite"}},
      {unit_sphere + "transform = { scale = [1, 2, 1] }\n", 10, {"not scale all directions alike", "a mesh"}},
      {unit_sphere + "transform = { scale = 0 }\n", 10, {"is 0"}},
      {unit_sphere + "transform = { sclae = 2 }\n", 10, {"shape.s.transform.sclae", "did you mean 'scale'?"}},
      {unit_sphere + "transform = { rotate = 90 }\n", 10, {"array of 3 numbers"}},
      {unit_sphere + "transform = [1, 2, 3]\n", 10, {"array of 16 numbers"}},
      {unit_sphere + "transform = \"none\"\n", 10, {"wants a table"}},
      {unit_sphere + "transform = [1,0,0,0, 0,1,0,0, 0,0,1,0, 1,2,3,1]\n", 10, {"last row"}},
      {unit_sphere + "transform = [1,0,0,0, 0,1,0,0, 0,1,0,0, 0,0,0,1]\n", 10, {"determinant"}},
      {unit_sphere + "transform = { translate = [1e9, 0, 0], scale = 10 }\ntransform2 = 1\n", 11, {"transform2 is not"}},
      {sphere + "centre = [1e8, 0, 0]\nradius = 1\ntransform = { scale = 100 }\n", 10, {"farther than 1e9 metres"}},
      {sphere + "centre = [0, 0, 0]\nradius = 1e8\ntransform = { scale = 100 }\n", 9, {"after the transform"}},
      {plane + "normal = [0, 0, 0]\n", 9, {"its length is 0"}},
      {plane + "normal = [0, 1]\n", 9, {"array of 3 numbers"}},
      {plane, 5, {"shape.p.normal is missing"}},
      {triangle + "a = [0, 0, 0]\nb = [1, 1, 1]\nc = [3, 3, 3]\n", 10, {"no area"}},
      {triangle + "a = [0, 0, 0]\nb = [0, 0, 0]\nc = [0, 0, 0]\n", 10, {"no area"}},
      {triangle + "a = [0, 0, 0]\nb = [1, 0, 0]\nc = [0, 1, 0]\nuv_a = [0, 0, 0]\n", 11, {"array of 2 numbers"}},
      {mesh, 5, {"shape.m.file is missing"}},
      {mesh + "file = \"absent.obj\"\n", 7, {"shape.m.file names", "absent.obj", "does not exist"}},
      {mesh + "file = \"/dev/zero\"\n", 7, {"no regular file"}},
      {mesh + "file = \"scene.toml\"\noverride = true\n", 8, {"wants a material"}},
      {mesh + "file = 3\n", 7, {"text between quotes"}},
  });
}

TEST_CASE("materials") {
  const std::string shape = "[shape.s]\ntype = \"sphere\"\ncentre = [0, 0, 0]\nradius = 1\nmaterial = \"glass\"\n";
  const std::string glass = head + shape + "[material.glass]\n";  // goes on in line 9
  check(std::vector<BadScene>{
      {head + shape, 7, {"no material 'glass'"}},
      {head + shape + "[material.glas]\nKd = 1\n", 7, {"no material 'glass'", "did you mean 'glas'?"}},
      {glass + "kd = [1, 1, 1]\n", 9, {"material.glass.kd is not a key", "did you mean 'Kd'?"}},
      {glass + "Kd = [1, 1]\n", 9, {"material.glass.Kd wants a colour"}},
      {glass + "Kd = [1, 1, -1]\n", 9, {"out of range: -1"}},
      {glass + "Ni = -1.5\n", 9, {"out of range"}},
      {glass + "d = 2\n", 9, {"out of range"}},
      {glass + "illum = 2.5\n", 9, {"whole number"}},
      {glass + "shader = \"glosy\"\n", 9, {"did you mean 'glossy'?"}},
      {glass + "illum = 2\nshader = \"glossy\"\n", 10, {"material.glass.shader and material.glass.illum exclude"}},
      {glass + "absorption = 1\nabsorption_colour = [1, 1, 1]\n", 10, {"exclude each other"}},
      {glass + "absorption_colour = [1, 1, 2]\nabsorption_distance = 1\n", 9, {"out of range: 2"}},
      {glass + "absorption_distance = 0\n", 9, {"out of range"}},
      {glass + "shader = \"volume\"\nabsorption_colour = [1, 1, 0.5]\n", 10, {"absorption_distance"}},
      {glass + "priority = 5000\n", 9, {"out of range"}},
      {glass + "texture_filter = \"linear\"\n", 9, {"bilinear"}},
      {glass + "map_Kd = 3\n", 9, {"text between quotes"}},
      {glass + "map_Kd = { scale = [1, 1] }\n", 9, {"material.glass.map_Kd.file is missing"}},
      {glass + "map_Kd = { file = \"x.png\", ofset = [1, 1] }\n", 9, {"did you mean 'offset'?"}},
      {glass + "shader = \"lambertian\"\nKd = 1\nmap_Kd = \"absent.png\"\n", 11, {"absent.png"}},
  });
}

TEST_CASE("meshes") {
  const ScratchFolder folder;
  folder.write("x.mtl", "newmtl red\nKd 1 0 0\nillum 1\n");
  folder.write("bare.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.write("x.obj", "mtllib x.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl rde\nf 1 2 3\n");
  struct BadMesh {
    std::string keys, file;
    int line;
    std::string piece;
  };
  const std::vector<BadMesh> cases{
      {"file = \"bare.obj\"\n", "scene.toml", 3, "faces without a material"},
      {"file = \"bare.obj\"\nmaterial = \"x\"\n", "scene.toml", 6, "no material 'x'"},
      {"file = \"x.obj\"\n", "x.obj", 5, "did you mean 'red'?"},
      {"file = \"x.obj\"\noverride = true\nmaterial = \"red\"\ntransform = { translate = [1e9, 0, 0] }\n", "scene.toml", 8,
       "farther than"},
  };
  for (const BadMesh& bad : cases) {
    CAPTURE(bad.keys);
    const std::optional<Error> error =
        error_of(folder.write("scene.toml", head + "[shape.m]\ntype = \"mesh\"\n" + bad.keys));
    REQUIRE(error);
    CAPTURE(error->what());
    CHECK(error->where().file == folder.path(bad.file));
    CHECK(error->where().line == bad.line);
    CHECK(std::string(error->what()).find(bad.piece) != std::string::npos);
    CHECK_FALSE(error->mend().empty());
  }
}

TEST_CASE("overrides name themselves in errors") {
  const ScratchFolder folder;
  const std::string path = folder.write("scene.toml", unit_sphere + lamp);
  REQUIRE_FALSE(error_of(path));
  const std::vector<std::pair<std::string, std::string>> cases{
      {"render.samples", "no '='"},
      {"=3", "is no key"},
      {"a b=3", "is no key"},
      {"render..samples=3", "is no key"},
      {"[render]\nsamples=3", "is no key"},
      {"render.samples=0", "out of range"},
      {"render.samples=many", "wants a whole number, not the text 'many'"},
      {"render.reflectance=.1", "as in 0.1"},
      {"render.min_weight=.1", "0.6 and not .6"},
      {"render.sample=3", "did you mean 'samples'?"},
      {"rendr.samples=3", "did you mean 'render'?"},
      {"camera.eye.x=3", "'camera.eye' is a value"},
      {"shape.s.radius=[1]", "an array of 1 value"},
      {"shape.s.material=x", "no material 'x'"},
      {"shape.t.radius=2", "no shape 't'"},
      {"light.lmp.intensity=2", "did you mean 'lamp'?"},
      {"material.n.Kd=1", "did you mean 'm'?"},
      {"material.m.shader=glosy", "did you mean 'glossy'?"},
      {"film.size=64x64", "the text '64x64'"},
      {"vitrum=2", "vitrum is 2"},
      {"render.samples=1\nvitrum=2", "whole number, not the text '1"},
  };
  for (const auto& [text, piece] : cases) {
    CAPTURE(text);
    const std::optional<Error> error = error_of(path, {text});
    REQUIRE(error);
    const std::string message = error->what();
    CAPTURE(message);
    CHECK(message.starts_with("--set " + text + ": "));
    CHECK(message.find(piece) != std::string::npos);
    CHECK_FALSE(error->mend().empty());
  }
}
