#include "scene/mesh_loader.hpp"

#include <algorithm>

#include "core/log.hpp"
#include "scene/obj_reader.hpp"

namespace vitrum {
namespace {

void transform_mesh(Mesh& mesh, const Transform& transform) {
  for (glm::vec3& position : mesh.positions) position = transform.point(position);
  for (glm::vec3& normal : mesh.normals) normal = transform.normal(normal);
  if (!transform.mirrors()) return;
  for (std::vector<glm::uvec3>* corners : {&mesh.triangles, &mesh.normal_indices, &mesh.texcoord_indices}) {
    for (glm::uvec3& corner : *corners)
      // `none` in .x says that all three are absent.
      if (corner.x != none) std::swap(corner.y, corner.z);
  }
}

/// Turns the faces' indices into the OBJ's material names into indices into the scene's materials.
void look_up_materials(Mesh& mesh, const ObjFile& obj, const ShapeDeclaration& shape, MaterialLibrary& library) {
  const MeshFile& file = std::get<MeshFile>(shape.geometry);
  library.note_names(obj.library);
  const auto shape_material = [&] { return library.use(shape.material, shape.material_where, obj.library); };
  if (file.override_materials) {
    mesh.materials.assign(mesh.triangles.size(), shape_material());
    return;
  }
  // Looked up once for each name, and only for names that a face has.
  std::vector<uint32_t> by_name(obj.material_names.size(), none);
  uint32_t for_unnamed = none;
  for (uint32_t& material : mesh.materials) {
    if (material != none) {
      uint32_t& index = by_name[material];
      if (index == none) index = library.use(obj.material_names[material], obj.material_uses[material], obj.library);
      material = index;
      continue;
    }
    if (shape.material.empty())
      throw Error(shape.where, "'" + file.path + "' has faces without a material",
                  "give [shape." + shape.name + "] a material for them");
    if (for_unnamed == none) for_unnamed = shape_material();
    material = for_unnamed;
  }
}

/// Warns of faces that want a texture and have no coordinates for it.
void check_texture_coordinates(const Mesh& mesh, const ShapeDeclaration& shape,
                               const std::vector<Material>& materials) {
  for (size_t face = 0; face < mesh.triangles.size(); ++face) {
    const Material& material = materials[mesh.materials[face]];
    const bool has_coordinates = !mesh.texcoord_indices.empty() && mesh.texcoord_indices[face].x != none;
    if (material.diffuse_texture == none || has_coordinates) continue;
    warn(shape.where, "'" + std::get<MeshFile>(shape.geometry).path + "' has faces of the textured material '" +
                          material.name + "' without texture coordinates (vt); they show its Kd");
    return;
  }
}

}  // namespace

Mesh load_mesh(const ShapeDeclaration& declaration, MaterialLibrary& library) {
  ObjFile obj = read_obj(std::get<MeshFile>(declaration.geometry).path);
  Mesh mesh = std::move(obj.mesh);
  transform_mesh(mesh, declaration.transform);
  look_up_materials(mesh, obj, declaration, library);
  check_texture_coordinates(mesh, declaration, library.materials());
  return mesh;
}

bool has_emissive_face(const Mesh& mesh, const std::vector<Material>& materials) {
  std::vector<bool> emits;
  for (const Material& material : materials)
    emits.push_back(material.emission_is_light && material.emission != Spectrum(0.0));
  return std::any_of(mesh.materials.begin(), mesh.materials.end(), [&](uint32_t index) { return emits[index]; });
}

}  // namespace vitrum
