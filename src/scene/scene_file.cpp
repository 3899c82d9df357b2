// Drives the loading of a scene: the file's tree, overrides, sections, then the files that it names.

#include "scene/scene_file.hpp"

#include <algorithm>

#include "core/suggest.hpp"
#include "scene/material_library.hpp"
#include "scene/mesh_loader.hpp"
#include "scene/overrides.hpp"
#include "scene/sections.hpp"
#include "scene/toml_document.hpp"
#include "scene/toml_table.hpp"

namespace vitrum {
namespace {

void check_top(const TomlTable& root) {
  // Said before unknown keys: a file of another version may well have others.
  if (!root.has("vitrum"))
    throw Error(root.where(), "the file does not say `vitrum = 1`, so it is no scene file of vitrum",
                "write `vitrum = 1` at its top");
  int version = 0;
  root.integer("vitrum", version, 1, std::numeric_limits<int>::max());
  if (version != schema_version)
    root.fail("vitrum", "is " + std::to_string(version) + ", but this vitrum reads version " +
                            std::to_string(schema_version) + " of the format",
              "use a newer vitrum, or write vitrum = 1");
  root.check_keys({"vitrum", "camera"}, {"unit", "mtl", "materials", "film", "background", "light", "shape", "material",
                                         "render", "photons"});
}

double read_unit(const TomlTable& root) {
  double metres_per_unit = 1.0;
  if (root.is_number("unit"))
    root.number("unit", metres_per_unit, {1e-6, 1e6});
  else
    root.choice("unit", metres_per_unit, {{"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}});
  return metres_per_unit;
}

MaterialLibrary make_library(const TomlTable& root, const FileContext& context, bool textures) {
  MaterialLibrary::Options options{.textures = textures};
  root.choice("mtl", options.reading, {{"common", MtlReading::common}, {"worksheet", MtlReading::worksheet}});
  std::vector<Said<std::string>> names;
  root.texts("materials", names);
  std::vector<MtlMaterial> files;
  for (const Said<std::string>& name : names) {
    std::vector<MtlMaterial> file = read_mtl(existing_file(context, name.where, "materials", name.value));
    files.insert(files.end(), std::make_move_iterator(file.begin()), std::make_move_iterator(file.end()));
  }
  return {options, std::move(files), read_material_tables(root, context)};
}

/// An exact shape with its material; meshes go through load_mesh.
void look_up_material(Shape& shape, const ShapeDeclaration& declaration, MaterialLibrary& library) {
  shape.material = library.use(declaration.material, declaration.material_where);
  const Material& material = library.materials()[shape.material];
  if (material.diffuse_texture != none && !declaration.has_texture_axes)
    throw Error(declaration.where,
                "the plane '" + declaration.name + "' has the textured material '" + material.name +
                    "' but not both texture_u and texture_v",
                "give them, as the texture's periods per unit of length, or set render.textures = false");
}

/// Meshes with emissive faces become lights of the shape's name; lights stay sorted by name.
void add_mesh_lights(Scene& scene) {
  for (uint32_t i = 0; i < scene.shapes.size(); ++i) {
    const Shape& shape = scene.shapes[i];
    const Mesh* mesh = std::get_if<Mesh>(&shape.geometry);
    if (!mesh || !has_emissive_face(*mesh, scene.materials)) continue;
    const auto at = std::lower_bound(scene.lights.begin(), scene.lights.end(), shape.name,
                                     [](const Light& light, const std::string& name) { return light.name < name; });
    if (at != scene.lights.end() && at->name == shape.name)
      throw Error(shape.where, "the mesh '" + shape.name + "' has emissive faces, but there is a light of that name",
                  "rename one of the two");
    scene.lights.insert(at, {shape.name, shape.where, MeshLight{i}});
  }
}

}  // namespace

Scene load_scene(const std::string& path, const std::vector<std::string>& overrides) {
  toml::table document = read_toml_file(path);
  for (const std::string& text : overrides) apply_override(document, text);
  const TomlTable root(document, "", {path});
  check_top(root);

  Scene scene;
  scene.file = path;
  scene.metres_per_unit = read_unit(root);
  const FileContext context{std::filesystem::path(path).parent_path(), scene.metres_per_unit};
  scene.camera = read_camera(root.table("camera"), context);
  scene.film = read_film(root.table("film"));
  scene.background = read_background(root.table("background"));
  scene.render = read_render_settings(root.table("render"));
  scene.photons = read_photon_settings(root.table("photons"), context, scene.render);
  scene.lights = read_lights(root, context);

  // Everything in the scene file is checked before the first mesh is read.
  const std::vector<ShapeDeclaration> declarations = read_shapes(root, context);
  MaterialLibrary library = make_library(root, context, scene.render.textures);
  if (declarations.empty() && scene.lights.empty())
    throw Error({path}, "the scene has neither shapes nor lights", "add a [shape.NAME]");

  for (const ShapeDeclaration& declaration : declarations) {
    Shape shape;
    shape.name = declaration.name;
    shape.where = declaration.where;
    std::visit(
        [&](const auto& geometry) {
          if constexpr (std::is_same_v<std::decay_t<decltype(geometry)>, MeshFile>) {
            shape.geometry = load_mesh(declaration, library);
          } else {
            shape.geometry = geometry;
            look_up_material(shape, declaration, library);
          }
        },
        declaration.geometry);
    scene.shapes.push_back(std::move(shape));
  }
  library.check_tables();
  scene.materials = std::move(library.materials());
  scene.textures = std::move(library.textures());
  add_mesh_lights(scene);
  return scene;
}

}  // namespace vitrum
