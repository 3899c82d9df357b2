#include "scene/material_library.hpp"

#include <algorithm>

#include "core/log.hpp"
#include "core/suggest.hpp"
#include "film/images.hpp"
#include "scene/toml_document.hpp"

namespace vitrum {
namespace {

const MtlMaterial* find(const std::vector<MtlMaterial>& materials, const std::string& name) {
  // From the back: of two definitions the later one counts.
  const auto found = std::find_if(materials.rbegin(), materials.rend(), [&](const auto& m) { return m.name == name; });
  return found == materials.rend() ? nullptr : &*found;
}

bool same_lookup(const Texture& a, const Texture& b) {
  return a.path == b.path && a.colour_space == b.colour_space && a.filter == b.filter && a.clamp == b.clamp &&
         a.offset == b.offset && a.scale == b.scale;
}

}  // namespace

MaterialLibrary::MaterialLibrary(Options options, std::vector<MtlMaterial> files,
                                 std::map<std::string, MtlMaterial> tables)
    : options_(options), files_(std::move(files)), tables_(std::move(tables)) {
  note_names(files_);
}

void MaterialLibrary::note_names(const std::vector<MtlMaterial>& library) {
  for (const MtlMaterial& material : library) names_in_files_.insert(material.name);
}

uint32_t MaterialLibrary::use(const std::string& name, const SourceLocation& asked_by,
                              const std::vector<MtlMaterial>& own) {
  const MtlMaterial* base = find(own, name);
  if (!base) base = find(files_, name);
  const auto table = tables_.find(name);
  if (!base && table == tables_.end()) {
    std::set<std::string> known = names_in_files_;
    for (const auto& [other, material] : tables_) known.insert(other);
    throw Error(asked_by, "there is no material '" + name + "'",
                suggestion(name, {known.begin(), known.end()}, "materials") +
                    "; MTL files are named by `materials = [\"...\"]` or an OBJ's mtllib");
  }
  const auto [entry, is_new] = used_.try_emplace({name, base ? to_string(base->where) : ""}, none);
  if (!is_new) return entry->second;

  const MtlMaterial said = table == tables_.end() ? *base : base ? overlaid(*base, table->second) : table->second;
  InterpretedMaterial interpreted = interpret(said, options_.reading);
  if (interpreted.texture && options_.textures)
    interpreted.material.diffuse_texture = add_texture(std::move(*interpreted.texture));
  materials_.push_back(std::move(interpreted.material));
  return entry->second = static_cast<uint32_t>(materials_.size() - 1);
}

uint32_t MaterialLibrary::add_texture(Texture texture) {
  const auto same = std::find_if(textures_.begin(), textures_.end(),
                                 [&](const Texture& t) { return same_lookup(t, texture); });
  if (same != textures_.end()) return static_cast<uint32_t>(same - textures_.begin());
  check_readable(texture.path, texture.where);
  textures_.push_back(std::move(texture));
  return static_cast<uint32_t>(textures_.size() - 1);
}

void MaterialLibrary::check_tables() const {
  for (const auto& [name, table] : tables_) {
    const auto is_this = [&name = name](const auto& use) { return use.first.first == name; };
    if (names_in_files_.contains(name) || std::any_of(used_.begin(), used_.end(), is_this)) continue;
    std::set<std::string> known = names_in_files_;
    for (const auto& [other, other_table] : tables_)
      if (other != name && !is_override(other_table.where)) known.insert(other);
    const std::string mend = suggestion(name, {known.begin(), known.end()}, "materials");
    if (is_override(table.where)) throw Error(table.where, "no shape has a material '" + name + "'", mend);
    warn(table.where, "no shape uses material '" + name + "'; " + mend);
  }
}

}  // namespace vitrum
