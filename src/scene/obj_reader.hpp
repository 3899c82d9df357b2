#pragma once
// OBJ files: polygons cut into triangles, every index checked, every error with its file and line.

#include <string>
#include <vector>

#include "scene/mtl_reader.hpp"
#include "scene/scene.hpp"

namespace vitrum {

/// What an OBJ file holds, in the file's own units and axes.
struct ObjFile {
  Mesh mesh;                                ///< `materials` index into material_names, or `none` before any usemtl
  std::vector<std::string> material_names;  ///< names used by usemtl, in order of first use
  std::vector<SourceLocation> material_uses;  ///< first use of each
  std::vector<MtlMaterial> library;         ///< all materials of the mtllib files, later ones replace earlier
};

/// Reads an OBJ file and its MTL libraries strictly (docs/obj-and-mtl.md). Throws Error with file, line and column.
/// A used material that no library has is for the caller to refuse at material_uses: the scene file may define it.
ObjFile read_obj(const std::string& path);

}  // namespace vitrum
