#pragma once
// The sections of a scene file: each function reads one, checks every key of it, and changes nothing else.

#include <filesystem>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "scene/materials.hpp"
#include "scene/scene.hpp"
#include "scene/toml_table.hpp"
#include "scene/transform.hpp"

namespace vitrum {

/// What holds for the whole file.
struct FileContext {
  std::filesystem::path folder;             ///< that paths are relative to
  double metres_per_unit = 1.0;
};

/// `name` as it counts from the scene file's folder; it need not exist.
std::string path_beside_scene(const FileContext& context, const std::string& name);

/// The same, of a regular file that exists; throws Error at `asked_by`, naming `key`, for what is none.
std::string existing_file(const FileContext& context, const SourceLocation& asked_by, const std::string& key,
                          const std::string& name);

/// Throws Error for a table of `tables` that only an override speaks of, which no `type` makes a new one: a misspelt
/// name. `what` is "light", ...
void check_overridden_names(const std::vector<std::pair<std::string, TomlTable>>& tables, const std::string& what);

/// [camera]
Camera read_camera(const TomlTable& table, const FileContext& context);
/// [film]
FilmSettings read_film(const TomlTable& table);
/// [background]
Spectrum read_background(const TomlTable& table);
/// [render]
RenderSettings read_render_settings(const TomlTable& table);
/// [photons]; `render` says how the picture is sampled.
PhotonSettings read_photon_settings(const TomlTable& table, const FileContext& context, const RenderSettings& render);
/// [light.NAME]; lengths in metres, names as in the file.
std::vector<Light> read_lights(const TomlTable& root, const FileContext& context);
/// [material.NAME], as it was said.
std::map<std::string, MtlMaterial> read_material_tables(const TomlTable& root, const FileContext& context);

/// A mesh that is still a file.
struct MeshFile {
  std::string path;
  bool override_materials = false;          ///< the shape's material goes onto every face
};

/// [shape.NAME] before its material and its mesh are looked up.
struct ShapeDeclaration {
  std::string name;
  SourceLocation where;
  std::string material;                     ///< may be empty for a mesh
  SourceLocation material_where;
  bool has_texture_axes = true;             ///< false for a plane without texture_u and texture_v
  std::variant<Sphere, Plane, Triangle, MeshFile> geometry;  ///< in world space but for meshes
  Transform transform;                      ///< for the mesh's vertices
};

std::vector<ShapeDeclaration> read_shapes(const TomlTable& root, const FileContext& context);

}  // namespace vitrum
