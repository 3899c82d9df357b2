#pragma once
// From an OBJ file and the shape that names it to a mesh in world space whose faces know their materials.

#include "scene/material_library.hpp"
#include "scene/sections.hpp"

namespace vitrum {

/// Reads the OBJ file of `declaration` (whose geometry is a MeshFile), brings it to world space and looks up the
/// materials of its faces. Throws Error, also for a face without a material.
Mesh load_mesh(const ShapeDeclaration& declaration, MaterialLibrary& library);

/// True if `mesh` has a face that is an area light.
bool has_emissive_face(const Mesh& mesh, const std::vector<Material>& materials);

}  // namespace vitrum
