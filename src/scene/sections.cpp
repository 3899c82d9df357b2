// What several sections of a scene file share.

#include "scene/sections.hpp"

#include "core/suggest.hpp"

namespace vitrum {

std::string path_beside_scene(const FileContext& context, const std::string& name) {
  return (context.folder / name).lexically_normal().string();
}

std::string existing_file(const FileContext& context, const SourceLocation& asked_by, const std::string& key,
                          const std::string& name) {
  const std::string path = path_beside_scene(context, name);
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (name.empty() || !std::filesystem::exists(status))
    throw Error(asked_by, key + " names '" + path + "', which does not exist",
                "paths are relative to the scene file's folder");
  if (!std::filesystem::is_regular_file(status))
    throw Error(asked_by, key + " names '" + path + "', which is no regular file", "name a file");
  return path;
}

void check_overridden_names(const std::vector<std::pair<std::string, TomlTable>>& tables, const std::string& what) {
  for (const auto& [name, table] : tables) {
    if (!is_override(table.where()) || table.has("type")) continue;
    std::vector<std::string> known;
    for (const auto& [other, other_table] : tables)
      if (!is_override(other_table.where())) known.push_back(other);
    throw Error(table.where(), "the scene has no " + what + " '" + name + "'",
                suggestion(name, known, what + "s") + "; a new one needs a type");
  }
}

}  // namespace vitrum
