#pragma once
// Which material a name stands for, and the materials and textures that are really used. Textures have no texels here.

#include <map>
#include <set>
#include <string>
#include <vector>

#include "scene/materials.hpp"
#include "scene/scene.hpp"

namespace vitrum {

/// Where materials are looked up while a scene is loaded. A name is interpreted when it is first used, so that what is
/// unused costs nothing and cannot fail.
class MaterialLibrary {
 public:
  struct Options {
    MtlReading reading = MtlReading::common;
    bool textures = true;                   ///< false: materials have none
  };

  /// `files`: what the scene file's `materials` hold, later ones replacing earlier ones of the same name.
  /// `tables`: the scene file's [material.NAME], which lie over whatever an MTL file says under that name.
  MaterialLibrary(Options options, std::vector<MtlMaterial> files, std::map<std::string, MtlMaterial> tables);

  /// Index of material `name` in materials(). It is looked for in `own`, the library of an OBJ file, then in the
  /// scene's files. Throws Error at `asked_by` for a name that is in none of them nor a [material.NAME].
  uint32_t use(const std::string& name, const SourceLocation& asked_by, const std::vector<MtlMaterial>& own = {});

  /// Tells the library of names that exist in an OBJ's MTL files, for suggestions and check_tables.
  void note_names(const std::vector<MtlMaterial>& library);

  /// To be called when all shapes are loaded: finds misspelt names. Throws Error for a [material.NAME] that only an
  /// override speaks of, that no file defines and no shape uses; warns of one in the scene file.
  void check_tables() const;

  std::vector<Material>& materials() { return materials_; }
  std::vector<Texture>& textures() { return textures_; }

 private:
  uint32_t add_texture(Texture texture);

  Options options_;
  std::vector<MtlMaterial> files_;
  std::map<std::string, MtlMaterial> tables_;
  std::set<std::string> names_in_files_;            ///< every name that an MTL file defines, used or not
  std::map<std::pair<std::string, std::string>, uint32_t> used_;  ///< by name and place of the MTL's definition
  std::vector<Material> materials_;
  std::vector<Texture> textures_;
};

}  // namespace vitrum
