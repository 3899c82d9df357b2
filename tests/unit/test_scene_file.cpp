// Scene files that are sound: what is said arrives in the Scene, in metres and in world space.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "scene/scene_file.hpp"
#include "scene/textures.hpp"
#include "scratch.hpp"

using namespace vitrum;
using glm::dvec2;
using glm::dvec3;

namespace {

const std::string head = "vitrum = 1\ncamera = { eye = [0, 0, 5], look_at = [0, 0, 0] }\n";
const std::string grey = "[material.m]\nshader = \"lambertian\"\nKd = 0.5\n";
const std::string red_pixel = std::string("P6\n1 1\n255\n\xff\x80\x00", 14);

Scene load(const std::string& text) {
  const ScratchFolder folder;
  return load_scene(folder.write("scene.toml", text));
}

template <typename T>
const T& shape(const Scene& scene, const std::string& name) {
  const auto found =
      std::find_if(scene.shapes.begin(), scene.shapes.end(), [&](const Shape& s) { return s.name == name; });
  REQUIRE(found != scene.shapes.end());
  return std::get<T>(found->geometry);
}

template <typename T>
const T& light(const Scene& scene, const std::string& name) {
  const auto found =
      std::find_if(scene.lights.begin(), scene.lights.end(), [&](const Light& l) { return l.name == name; });
  REQUIRE(found != scene.lights.end());
  return std::get<T>(found->emitter);
}

bool near(const dvec3& a, const dvec3& b, double tolerance = 1e-14) { return glm::length(a - b) <= tolerance; }

dvec3 geometric_normal(const Mesh& mesh, size_t face) {
  const glm::uvec3 i = mesh.triangles[face];
  const dvec3 a(mesh.positions[i.x]), b(mesh.positions[i.y]), c(mesh.positions[i.z]);
  return glm::normalize(glm::cross(b - a, c - a));
}

}  // namespace

TEST_CASE("a scene file that says nothing it need not has the Scene's defaults") {
  const Scene scene = load(head + grey + "[shape.s]\ntype = \"sphere\"\ncentre = [1, 2, 3]\nradius = 4\nmaterial = \"m\"\n");
  const FilmSettings film;
  CHECK(scene.film.width == film.width);
  CHECK(scene.film.display == DisplayTransform::srgb);
  CHECK(scene.background == Spectrum(0.0));
  CHECK(scene.camera.vertical_fov == 45.0);
  CHECK(scene.camera.up == dvec3(0, 1, 0));
  CHECK(scene.render.samples == 16);
  CHECK_FALSE(scene.render.constant_reflectance);
  CHECK(scene.photons.count == 1'000'000);
  CHECK(scene.metres_per_unit == 1.0);
  CHECK(shape<Sphere>(scene, "s").centre == dvec3(1, 2, 3));
  CHECK(shape<Sphere>(scene, "s").radius == 4.0);
  CHECK(scene.shapes[0].material == 0);
  REQUIRE(scene.materials.size() == 1);
  CHECK(scene.materials[0].diffuse == Spectrum(0.5));
}

TEST_CASE("every setting arrives") {
  const Scene scene = load(R"(
vitrum = 1
[camera]
type = "pinhole"
eye = [1, 2, 3]
look_at = [4, 5, 6]
up = [0, 0, 7]
vertical_fov = 60
[film]
size = [64, 32]
filter = "box"
display = "gamma"
gamma = 2.2
exposure = -1.5
[background]
radiance = 0.25
[render]
samples = 4
passes = 2
seed = 9223372036854775807
reflectance = 0.1
caustics = false
lights = false
textures = false
max_depth = 7
min_weight = 0
sampling = "independent"
[photons]
count = 20_000
sampling = "independent"
estimate = "nearest"
radius = 0.5
nearest = 10
max_radius = 2
max_depth = 5
[light.b]
type = "directional"
direction = [0, -2, 0]
irradiance = [1, 2, 3]
[light.a]
type = "point"
position = [1, 1, 1]
intensity = 5
[light.c]
type = "quad"
corner = [0, 0, 0]
edge_u = [1, 0, 0]
edge_v = [0, 0, 2]
radiance = 1
[light.d]
type = "disc"
centre = [0, 0, 0]
normal = [0, 3, 4]
radius = 2
radiance = 2
[light.e]
type = "sphere"
centre = [1, 0, 0]
radius = 3
radiance = 3
)");
  CHECK(scene.camera.eye == dvec3(1, 2, 3));
  CHECK(scene.camera.look_at == dvec3(4, 5, 6));
  CHECK(scene.camera.up == dvec3(0, 0, 1));
  CHECK(scene.camera.vertical_fov == 60.0);
  CHECK(scene.film.width == 64);
  CHECK(scene.film.height == 32);
  CHECK(scene.film.display == DisplayTransform::gamma);
  CHECK(scene.film.gamma == 2.2);
  CHECK(scene.film.exposure == -1.5);
  CHECK(scene.background == Spectrum(0.25));
  CHECK(scene.render.samples == 4);
  CHECK(scene.render.passes == 2);
  CHECK(scene.render.seed == 9223372036854775807u);
  CHECK(scene.render.constant_reflectance == 0.1);
  CHECK_FALSE(scene.render.caustics);
  CHECK_FALSE(scene.render.lights);
  CHECK_FALSE(scene.render.textures);
  CHECK(scene.render.max_depth == 7);
  CHECK(scene.render.min_weight == 0.0);
  CHECK(scene.render.sampling == Sampling::independent);
  CHECK(scene.photons.count == 20'000);
  CHECK(scene.photons.sampling == Sampling::independent);
  CHECK(scene.photons.estimate == PhotonEstimate::nearest);
  CHECK(scene.photons.radius == 0.5);
  CHECK(scene.photons.nearest == 10);
  CHECK(scene.photons.max_radius == 2.0);
  CHECK(scene.photons.max_depth == 5);

  REQUIRE(scene.lights.size() == 5);
  CHECK(scene.lights[0].name == "a");
  CHECK(scene.lights[0].where.line == 40);
  CHECK(light<PointLight>(scene, "a").intensity == Spectrum(5.0));
  CHECK(light<DirectionalLight>(scene, "b").direction == dvec3(0, -1, 0));
  CHECK(light<DirectionalLight>(scene, "b").irradiance == Spectrum(1, 2, 3));
  CHECK(light<QuadLight>(scene, "c").edge_v == dvec3(0, 0, 2));
  CHECK(near(light<DiscLight>(scene, "d").normal, dvec3(0, 0.6, 0.8)));
  CHECK(light<DiscLight>(scene, "d").radius == 2.0);
  CHECK(light<SphereLight>(scene, "e").centre == dvec3(1, 0, 0));
}

TEST_CASE("lengths are brought to metres, absorption to 1/m") {
  const std::string body = R"(
[camera]
eye = [0, 0, 500]
look_at = [0, 100, 0]
[photons]
radius = 2
max_radius = 50
[light.l]
type = "point"
position = [100, 0, 0]
intensity = 1
[light.q]
type = "disc"
centre = [0, 100, 0]
normal = [0, 1, 0]
radius = 30
radiance = 1
[shape.s]
type = "sphere"
centre = [0, 0, 100]
radius = 30
material = "g"
transform = { translate = [100, 0, 0] }
[shape.p]
type = "plane"
point = [0, -100, 0]
normal = [0, 1, 0]
texture_u = [0.01, 0, 0]
material = "h"
[material.g]
shader = "volume"
absorption = [0.01, 0.02, 0.03]
[material.h]
shader = "volume"
absorption_colour = 0.5
absorption_distance = 200
)";
  for (const char* unit : {"\"cm\"", "0.01"}) {
    const Scene scene = load("vitrum = 1\nunit = " + std::string(unit) + "\n" + body);
    CHECK(scene.metres_per_unit == 0.01);
    CHECK(near(scene.camera.eye, dvec3(0, 0, 5)));
    CHECK(near(scene.camera.look_at, dvec3(0, 1, 0)));
    CHECK(scene.photons.radius == doctest::Approx(0.02).epsilon(1e-14));
    CHECK(scene.photons.max_radius == doctest::Approx(0.5).epsilon(1e-14));
    CHECK(near(light<PointLight>(scene, "l").position, dvec3(1, 0, 0)));
    CHECK(light<DiscLight>(scene, "q").radius == doctest::Approx(0.3).epsilon(1e-14));
    CHECK(near(shape<Sphere>(scene, "s").centre, dvec3(1, 0, 1)));
    CHECK(shape<Sphere>(scene, "s").radius == doctest::Approx(0.3).epsilon(1e-14));
    CHECK(near(shape<Plane>(scene, "p").point, dvec3(0, -1, 0)));
    CHECK(near(shape<Plane>(scene, "p").texture_u, dvec3(1, 0, 0)));
    REQUIRE(scene.materials.size() == 2);
    CHECK(scene.materials[0].name == "h");  // the plane p comes first
    CHECK(near(scene.materials[0].absorption, dvec3(std::log(2.0) / 2.0)));
    CHECK(near(scene.materials[1].absorption, dvec3(1, 2, 3)));
  }
}

TEST_CASE("transforms of exact shapes") {
  const Scene scene = load(head + grey + R"(
[shape.s]
type = "sphere"
centre = [1, 0, 0]
radius = 2
material = "m"
transform = { translate = [0, 0, 10], rotate = [90, 0, 90], scale = -3 }
[shape.p]
type = "plane"
point = [0, 1, 0]
normal = [0, 1, 1]
texture_u = [1, 0, 0]
texture_v = [0, 1, -1]
material = "m"
transform = { scale = [4, 2, 1], rotate = [0, 0, 90] }
[shape.matrix]
type = "sphere"
centre = [1, 2, 3]
radius = 1
material = "m"
transform = [0, -2, 0, 10,  2, 0, 0, 20,  0, 0, 2, 30,  0, 0, 0, 1]
[shape.t]
type = "triangle"
a = [0, 0, 0]
b = [1, 0, 0]
c = [0, 1, 0]
uv_b = [0.5, 0]
material = "m"
transform = { scale = [1, 1, -1] }
)");
  // (-3,0,0) about x stays, about z by 90 degrees becomes (0,-3,0); right angles are exact.
  CHECK(shape<Sphere>(scene, "s").centre == dvec3(0, -3, 10));
  CHECK(shape<Sphere>(scene, "s").radius == doctest::Approx(6.0).epsilon(1e-14));
  CHECK(shape<Sphere>(scene, "matrix").centre == dvec3(-4 + 10, 2 + 20, 6 + 30));
  CHECK(shape<Sphere>(scene, "matrix").radius == doctest::Approx(2.0).epsilon(1e-14));

  // The plane y + z = 1 scaled by (4, 2, 1) is y/2 + z = 1; turned by 90 degrees about z, y becomes -x.
  const Plane& plane = shape<Plane>(scene, "p");
  CHECK(near(plane.point, dvec3(-2, 0, 0)));
  CHECK(near(plane.normal, glm::normalize(dvec3(-0.5, 0, 1))));
  // A point keeps its texture coordinates: (3, 0, 1) before is (0, 12, 1) after.
  const dvec3 before = dvec3(3, 0, 1) - dvec3(0, 1, 0), after = dvec3(0, 12, 1) - plane.point;
  CHECK(glm::dot(after, plane.texture_u) == doctest::Approx(glm::dot(before, dvec3(1, 0, 0))).epsilon(1e-14));
  CHECK(glm::dot(after, plane.texture_v) == doctest::Approx(glm::dot(before, dvec3(0, 1, -1))).epsilon(1e-14));

  // Mirrored at z = 0, the triangle still shows its front to what was its front.
  const Triangle& triangle = shape<Triangle>(scene, "t");
  CHECK(glm::cross(triangle.b - triangle.a, triangle.c - triangle.a).z == -1.0);
  CHECK(triangle.c == dvec3(1, 0, 0));
  CHECK(triangle.uv_c == dvec2(0.5, 0));
}

TEST_CASE("transforms of meshes: positions, normals, winding, materials") {
  const ScratchFolder folder;
  folder.write("sub/x.mtl", "newmtl red\nKd 1 0 0\nillum 1\nnewmtl unused\nKd 1 1 1\nillum 1\nmap_Kd absent.png\n");
  folder.write("sub/x.obj",
               "mtllib x.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 1\nvn 0 -1 1\nvt 0 0\nvt 1 0\nvt 0 1\n"
               "f 1 2 3\nusemtl red\nf 1/1/1 2/2/1 3/3/1\n");
  const std::string text = head + grey + "[shape.mesh]\ntype = \"mesh\"\nfile = \"sub/x.obj\"\nmaterial = \"m\"\n";

  const Scene plain = load_scene(folder.write("scene.toml", text));
  const Mesh& mesh = shape<Mesh>(plain, "mesh");
  REQUIRE(mesh.triangles.size() == 2);
  REQUIRE(mesh.materials.size() == 2);
  REQUIRE(plain.materials.size() == 2);
  CHECK(plain.materials[mesh.materials[0]].name == "m");
  CHECK(plain.materials[mesh.materials[1]].name == "red");
  CHECK(plain.shapes[0].material == none);
  CHECK(plain.lights.empty());
  const double cosine = glm::dot(geometric_normal(mesh, 1), dvec3(mesh.normals[mesh.normal_indices[1].x]));
  CHECK(cosine == doctest::Approx(1.0).epsilon(1e-6));

  for (const char* transform : {"{ scale = [1, 3, 1] }", "{ scale = [1, 1, -1] }", "{ scale = -2, rotate = [10, 20, 30] }",
                                "[1,2,0,5, 0,1,0,6, 0,0,-3,7, 0,0,0,1]"}) {
    CAPTURE(transform);
    const Scene scene = load_scene(folder.write("scene.toml", text + "transform = " + transform + "\n"));
    const Mesh& moved = shape<Mesh>(scene, "mesh");
    // The normal that the file gives is the geometric one, and stays so on whichever side it was.
    const dvec3 normal(moved.normals[moved.normal_indices[1].y]);
    CHECK(glm::length(normal) == doctest::Approx(1.0).epsilon(1e-6));
    CHECK(glm::dot(geometric_normal(moved, 1), normal) == doctest::Approx(1.0).epsilon(1e-6));
    // Corners keep their texture coordinates: the one at u = 1 is vertex 2.
    for (int corner = 0; corner < 3; ++corner) {
      const bool is_second = moved.texcoords[moved.texcoord_indices[1][corner]] == glm::vec2(1, 0);
      CHECK((moved.triangles[1][corner] == mesh.triangles[1].y) == is_second);
    }
  }
  const Scene moved = load_scene(folder.path("scene.toml"));
  CHECK(shape<Mesh>(moved, "mesh").positions[mesh.triangles[1].z] == glm::vec3(2 + 5, 1 + 6, -3 + 7));

  const Scene one = load_scene(folder.write("scene.toml", text + "override = true\n"));
  REQUIRE(one.materials.size() == 1);
  CHECK(shape<Mesh>(one, "mesh").materials == std::vector<uint32_t>{0, 0});
}

TEST_CASE("materials: MTL files, tables over them, only what is used") {
  const ScratchFolder folder;
  folder.write("a.mtl", "newmtl glass\nillum 4\nNi 1.5\nnewmtl other\nillum 1\nKd 0.1 0.2 0.3\n");
  folder.write("b.mtl", "newmtl glass\nillum 4\nNi 1.7\nnewmtl bad\nillum 4\nNi 0\nnewmtl bare\nillum 1\nmap_Kd absent.png\n");
  const auto with = [&](const std::string& text) {
    return load_scene(folder.write("scene.toml", "vitrum = 1\nmaterials = [\"a.mtl\", \"b.mtl\"]\n" + head.substr(11) + text +
                                                     "[shape.s]\ntype = \"sphere\"\ncentre = [0,0,0]\nradius = 1\nmaterial = \"glass\"\n"));
  };
  const Scene later = with("");
  REQUIRE(later.materials.size() == 1);
  CHECK(later.materials[0].index.value == 1.7);
  CHECK(later.materials[0].surface == Surface::dielectric);

  const Scene over = with("[material.glass]\nillum = 12\nKd = [0.5, 1, 0.25]\n"
                          "[shape.t]\ntype = \"sphere\"\ncentre = [3,0,0]\nradius = 1\nmaterial = \"glass\"\n");
  REQUIRE(over.materials.size() == 1);
  CHECK(over.materials[0].shader == "glossy volume");
  CHECK(over.materials[0].index.value == 1.7);
  CHECK(over.materials[0].absorption == Spectrum(1, 0, 3));
}

TEST_CASE("the reading of MTL files is that of the scene file") {
  const std::string body = head + "[material.m]\nillum = 2\nKd = 0.5\nNi = 1.5\n"
                           "[shape.s]\ntype = \"sphere\"\ncentre = [0,0,0]\nradius = 1\nmaterial = \"m\"\n";
  CHECK(load(body).materials[0].surface == Surface::opaque);
  CHECK(load("mtl = \"worksheet\"\n" + body).materials[0].surface == Surface::dielectric);
}

TEST_CASE("textures are read once, decoded, and only when they are used") {
  const ScratchFolder folder;
  folder.write("x.ppm", red_pixel);
  folder.write("m.mtl", "newmtl a\nillum 1\nmap_Kd x.ppm\nnewmtl b\nillum 1\nmap_Kd x.ppm\n");
  const std::string plane = "type = \"plane\"\npoint = [0,0,0]\nnormal = [0,1,0]\ntexture_u = [1,0,0]\ntexture_v = [0,0,1]\n";
  const std::string text = "materials = [\"m.mtl\"]\n" + head + "[material.c]\nshader = \"lambertian\"\n"
      "map_Kd = { file = \"x.ppm\", scale = [2, 3], offset = [4, 5], clamp = true }\n"
      "texture_colour_space = \"linear\"\ntexture_filter = \"nearest\"\n"
      "[shape.a]\nmaterial = \"a\"\n" + plane + "[shape.b]\nmaterial = \"b\"\n" + plane + "[shape.c]\nmaterial = \"c\"\n" + plane;
  const std::string path = folder.write("scene.toml", text);
  Scene scene = load_scene(path);
  REQUIRE(scene.materials.size() == 3);
  REQUIRE(scene.textures.size() == 2);
  CHECK(scene.textures[0].texels.empty());
  load_textures(scene);
  CHECK(scene.materials[0].diffuse_texture == 0);
  CHECK(scene.materials[1].diffuse_texture == 0);
  CHECK(scene.materials[2].diffuse_texture == 1);

  const Texture& decoded = scene.textures[0];
  REQUIRE(decoded.texels.size() == 1);
  CHECK(decoded.colour_space == ColourSpace::srgb);
  CHECK(decoded.texels[0].r == 1.0f);
  CHECK(decoded.texels[0].g == doctest::Approx(0.2158605).epsilon(1e-6));  // (128/255 + .055)/1.055 to the power 2.4
  CHECK(decoded.texels[0].b == 0.0f);

  const Texture& raw = scene.textures[1];
  CHECK(raw.texels[0].g == doctest::Approx(128.0 / 255.0).epsilon(1e-6));
  CHECK(raw.filter == TextureFilter::nearest);
  CHECK(raw.clamp);
  CHECK(raw.scale == dvec2(2, 3));
  CHECK(raw.offset == dvec2(4, 5));

  std::filesystem::remove(folder.path("x.ppm"));
  const Scene without = load_scene(path, {"render.textures=false"});
  CHECK(without.textures.empty());
  CHECK(without.materials[0].diffuse_texture == none);
}

TEST_CASE("a plane with a texture wants axes for it") {
  const ScratchFolder folder;
  folder.write("x.ppm", red_pixel);
  const std::string path = folder.write("scene.toml", head + "[material.m]\nshader = \"lambertian\"\nmap_Kd = \"x.ppm\"\n"
      "[shape.p]\ntype = \"plane\"\nmaterial = \"m\"\npoint = [0,0,0]\nnormal = [0,1,0]\ntexture_u = [1,0,0]\n");
  CHECK_THROWS_WITH_AS(load_scene(path), doctest::Contains("texture_u and texture_v"), Error);
  CHECK_NOTHROW(load_scene(path, {"render.textures=false"}));
  CHECK_NOTHROW(load_scene(path, {"shape.p.texture_v=[0,0,1]"}));
}

TEST_CASE("emissive faces make a mesh a light; exact shapes stay shapes") {
  const ScratchFolder folder;
  folder.write("x.mtl", "newmtl glow\nillum 1\nKd 0 0 0\nKe 2 2 2\nnewmtl dark\nillum 1\nKd 1 1 1\n");
  folder.write("x.obj", "mtllib x.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl dark\nf 1 2 3\nusemtl glow\nf 1 2 3\n");
  const std::string text = "materials = [\"x.mtl\"]\n" + head +
      "[light.a]\ntype = \"point\"\nposition = [0,0,0]\nintensity = 1\n"
      "[light.z]\ntype = \"point\"\nposition = [0,0,0]\nintensity = 1\n"
      "[shape.mesh]\ntype = \"mesh\"\nfile = \"x.obj\"\n"
      "[shape.ball]\ntype = \"sphere\"\ncentre = [0,0,0]\nradius = 1\nmaterial = \"glow\"\n";
  const std::string path = folder.write("scene.toml", text);
  const Scene scene = load_scene(path);
  REQUIRE(scene.lights.size() == 3);
  CHECK(scene.lights[1].name == "mesh");
  CHECK(scene.shapes[light<MeshLight>(scene, "mesh").shape].name == "mesh");

  CHECK(load_scene(path, {"material.glow.Ke=0"}).lights.size() == 2);
  CHECK_THROWS_WITH_AS(load_scene(path, {"light.mesh={type='point', position=[0,0,0], intensity=1}"}),
                       doctest::Contains("light of that name"), Error);
}

TEST_CASE("the models that come with vitrum") {
  const std::string models = std::string(VITRUM_SOURCE_DIR) + "/models/";
  const Scene scene = load_scene(models + "default_scene/scene.toml", {"render.textures=false"});
  REQUIRE(scene.shapes.size() == 3);
  CHECK(shape<Sphere>(scene, "ball").radius == 0.3);
  CHECK(shape<Plane>(scene, "lawn").texture_u == dvec3(-0.2, 0, 0));
  CHECK(shape<Plane>(scene, "lawn").texture_v == dvec3(0, 0, 0.2));
  const Triangle& cardboard = shape<Triangle>(scene, "cardboard");
  CHECK(glm::normalize(glm::cross(cardboard.b - cardboard.a, cardboard.c - cardboard.a)) == dvec3(0, 1, 0));
  CHECK(light<PointLight>(scene, "lamp").intensity == Spectrum(glm::pi<double>()));
  const auto glass = std::find_if(scene.materials.begin(), scene.materials.end(), [](auto& m) { return m.name == "glass"; });
  REQUIRE(glass != scene.materials.end());
  CHECK(glass->shader == "glossy volume");
  CHECK(glass->index.value == 1.5);
  CHECK(glass->specular == Spectrum(0.3));

  const Scene plate = load_scene(models + "caustic_plate/scene.toml");
  CHECK(plate.film.width == 128);
  CHECK(plate.photons.count == 10'000'000);
  // The camera's half picture is .2 wide at a distance of .19.
  CHECK(std::tan(glm::radians(plate.camera.vertical_fov) / 2) * 0.19 == doctest::Approx(0.2).epsilon(1e-14));
  REQUIRE(plate.materials.size() == 2);
  CHECK(plate.materials[0].surface == Surface::dielectric);  // ball before lawn
  CHECK(plate.materials[0].absorption == Spectrum(0.0));
  CHECK(plate.materials[0].specular == Spectrum(0.0));
  CHECK(plate.materials[1].diffuse == Spectrum(0.01));
}
