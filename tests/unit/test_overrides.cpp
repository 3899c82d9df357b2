// --set KEY=VALUE.

#include <doctest/doctest.h>

#include "core/suggest.hpp"
#include "scene/overrides.hpp"
#include "scene/scene_file.hpp"
#include "scratch.hpp"

using namespace vitrum;

namespace {

toml::table overridden(const std::string& text, const std::vector<std::string>& overrides) {
  toml::table root = parse_toml(text, "scene.toml");
  for (const std::string& override_text : overrides) apply_override(root, override_text);
  return root;
}

template <typename T>
std::optional<T> value(const toml::table& root, const std::string& path) {
  return root.at_path(path).value_exact<T>();
}

}  // namespace

TEST_CASE("values are TOML, and text where they are none") {
  const toml::table root = overridden("", {"a=1", "b=1.5", "c=true", "d=hello world", "e=\"quoted\"", "f=", "g=1_000", "h=.5",
                                           "i=C:\\x \"y\"", "j=[1, 2", "k=1 # one", "l=2024-01-01", "m=a=b", "n=1\no=2", "p='x'"});
  CHECK(value<int64_t>(root, "a") == 1);
  CHECK(value<double>(root, "b") == 1.5);
  CHECK(value<bool>(root, "c") == true);
  CHECK(value<std::string>(root, "d") == "hello world");
  CHECK(value<std::string>(root, "e") == "quoted");
  CHECK(value<std::string>(root, "f") == "");
  CHECK(value<int64_t>(root, "g") == 1000);
  CHECK(value<std::string>(root, "h") == ".5");
  CHECK(value<std::string>(root, "i") == "C:\\x \"y\"");
  CHECK(value<std::string>(root, "j") == "[1, 2");
  CHECK(value<int64_t>(root, "k") == 1);
  CHECK(root.at_path("l").is_date());
  CHECK(value<std::string>(root, "m") == "a=b");
  CHECK(value<std::string>(root, "n") == "1\no=2");
  CHECK_FALSE(root.contains("o"));
  CHECK(value<std::string>(root, "p") == "x");
}

TEST_CASE("keys lead through tables, which are made where absent") {
  const toml::table root =
      overridden("[a]\nb = 1\nc = { d = 2, e = 3 }\n[f.g]\nh = 4\n",
                 {"a.b=10", "a.c.d=20", "f.g.i=50", "x.y.z=60", "f . j = 70", "\"k l\".'m.n'.\"=\"=80", "f.g.h=90", "f.g.h=91"});
  CHECK(value<int64_t>(root, "a.b") == 10);
  CHECK(value<int64_t>(root, "a.c.d") == 20);
  CHECK(value<int64_t>(root, "a.c.e") == 3);
  CHECK(value<int64_t>(root, "f.g.h") == 91);
  CHECK(value<int64_t>(root, "f.g.i") == 50);
  CHECK(value<int64_t>(root, "x.y.z") == 60);
  CHECK(value<int64_t>(root, "f.j") == 70);
  CHECK(root["k l"]["m.n"]["="].value<int64_t>() == 80);
}

TEST_CASE("a table replaces a table whole") {
  const toml::table root = overridden("[a]\nb = 1\nc = 2\n", {"a={b=3}"});
  CHECK(value<int64_t>(root, "a.b") == 3);
  CHECK_FALSE(root.at_path("a.c"));
}

TEST_CASE("every node of an override knows where it came from") {
  const toml::table root = overridden("[a]\nb = 1\n", {"a.b=[1, 2]", "x.y=3"});
  CHECK(to_string(location(root["a"]["b"].node()->source())) == "--set a.b=[1, 2]");
  CHECK(to_string(location(root["a"]["b"][1].node()->source())) == "--set a.b=[1, 2]");
  CHECK(to_string(location(root["x"].node()->source())) == "--set x.y=3");
  CHECK(to_string(location(root["a"].node()->source())) == "scene.toml:1:1");
}

TEST_CASE("overrides reach every part of a scene") {
  const ScratchFolder folder;
  const std::string path = folder.write("scene.toml", R"(
vitrum = 1
[camera]
eye = [0, 0, 5]
look_at = [0, 0, 0]
[material.glass]
shader = "glossy volume"
absorption_colour = 0.5
absorption_distance = 1
[shape.ball]
type = "sphere"
centre = [0, 0, 0]
radius = 1
material = "glass"
)");
  const Scene scene = load_scene(path, {"render.reflectance=0.1", "render.caustics=false", "film.size=[64, 48]", "mtl=common",
                                        "film.display=gamma", "photons.radius=1", "unit=cm", "shape.ball.radius=200",
                                        "shape.ball.transform.scale=2", "background.radiance=[1, 0.5, 2]",
                                        "light.lamp={type=\"point\", position=[0,1,0], intensity=1}"});
  CHECK(scene.render.constant_reflectance == 0.1);
  CHECK_FALSE(scene.render.caustics);
  CHECK(scene.film.width == 64);
  CHECK(scene.film.height == 48);
  CHECK(scene.film.display == DisplayTransform::gamma);
  CHECK(scene.photons.radius == 0.01);
  CHECK(std::get<Sphere>(scene.shapes[0].geometry).radius == doctest::Approx(4.0).epsilon(1e-14));
  CHECK(scene.background == Spectrum(1, 0.5, 2));
  CHECK(scene.lights.size() == 1);
  CHECK(scene.materials[0].shader == "glossy volume");

  // What excludes what the file says puts it out of force.
  CHECK(load_scene(path, {"material.glass.illum=4"}).materials[0].shader == "transparent");
  CHECK(load_scene(path, {"material.glass.absorption=[1, 2, 3]"}).materials[0].absorption == Spectrum(1, 2, 3));
  CHECK_THROWS_WITH_AS(load_scene(path, {"material.glass.illum=4", "material.glass.shader=mirror"}),
                       doctest::Contains("exclude each other"), Error);
  // A light that overrides define piece by piece is new, not misspelt.
  CHECK(load_scene(path, {"light.a.type=point", "light.a.position=[0,1,0]", "light.a.intensity=1"}).lights.size() == 1);
}

TEST_CASE("suggestions") {
  CHECK(edit_distance("", "abc") == 3);
  CHECK(edit_distance("kitten", "sitting") == 3);
  CHECK(edit_distance("tpye", "type") == 1);
  CHECK(edit_distance("KD", "Kd") == 0);
  const std::vector<std::string> known{"eye", "look_at", "up"};
  CHECK(suggestion("eyes", known, "keys") == "did you mean 'eye'? known keys: eye, look_at, up");
  CHECK(suggestion("zzz", known, "keys") == "known keys: eye, look_at, up");
  CHECK(suggestion("x", {}, "lights") == "there are no lights");
  CHECK(suggestion("x", std::vector<std::string>(20, "long name"), "keys").ends_with(", ..."));
}
