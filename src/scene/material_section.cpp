// [material.NAME]: MTL keywords and vitrum's own, as they were said; materials.hpp gives the meaning.

#include "scene/sections.hpp"

namespace vitrum {
namespace {

constexpr Range fraction{0, 1};
constexpr Range not_negative{0, 1e9};

/// `map_Kd`: a file's name, or a table with MTL's options.
TextureReference read_texture_reference(const TomlTable& table, const FileContext& context) {
  TextureReference reference;
  std::string name;
  if (!table.is_table("map_Kd")) {
    table.text("map_Kd", name);
    reference.path = path_beside_scene(context, name);
    return reference;
  }
  const TomlTable options = table.table("map_Kd");
  options.check_keys({"file"}, {"offset", "scale", "clamp"});
  options.text("file", name);
  reference.path = path_beside_scene(context, name);
  options.vector("offset", reference.offset, {-1e6, 1e6});
  options.vector("scale", reference.scale, {-1e6, 1e6});
  options.flag("clamp", reference.clamp);
  return reference;
}

MtlMaterial read_material(const std::string& name, TomlTable table, const FileContext& context) {
  table.check_keys({}, {"illum", "Ka", "Kd", "Ks", "Ke", "Tf", "Ns", "Ni", "d", "map_Kd", "shader", "absorption",
                        "absorption_colour", "absorption_distance", "priority", "texture_filter",
                        "texture_colour_space"});
  table.exclude_each_other({"illum", "shader"});
  table.exclude_each_other({"absorption", "absorption_colour"});
  table.exclude_each_other({"absorption", "absorption_distance"});

  MtlMaterial material;
  material.name = name;
  material.where = table.where();
  const auto colour = [&](std::string_view key, std::optional<Said<Spectrum>>& value, Range range) {
    table.said(key, value, [&](Spectrum& v) { table.colour(key, v, range); });
  };
  const auto number = [&](std::string_view key, std::optional<Said<double>>& value, Range range) {
    table.said(key, value, [&](double& v) { table.number(key, v, range); });
  };
  const auto integer = [&](std::string_view key, std::optional<Said<int>>& value, int low, int high) {
    table.said(key, value, [&](int& v) { table.integer(key, v, low, high); });
  };
  colour("Ka", material.Ka, radiometric);
  colour("Kd", material.Kd, not_negative);
  colour("Ks", material.Ks, not_negative);
  colour("Ke", material.Ke, radiometric);
  colour("Tf", material.Tf, not_negative);
  number("Ns", material.Ns, not_negative);
  number("Ni", material.Ni, not_negative);
  number("d", material.d, fraction);
  integer("illum", material.illum, 0, 1000);
  table.said("map_Kd", material.map_Kd, [&](TextureReference& v) { v = read_texture_reference(table, context); });

  table.said("shader", material.shader, [&](std::string& v) {
    std::vector<std::pair<std::string, std::string>> words;
    for (const char* word : {"reflectance", "lambertian", "phong", "glossy", "mirror", "transparent", "volume",
                             "glossy volume"})
      words.emplace_back(word, word);
    table.choice("shader", v, words);
  });
  colour("absorption", material.absorption, {0, 1e12});
  if (material.absorption) material.absorption->value /= context.metres_per_unit;
  colour("absorption_colour", material.absorption_colour, fraction);
  number("absorption_distance", material.absorption_distance, positive_length);
  if (material.absorption_distance) material.absorption_distance->value *= context.metres_per_unit;
  integer("priority", material.priority, -1000, 1000);
  table.said("texture_filter", material.texture_filter, [&](TextureFilter& v) {
    table.choice("texture_filter", v, {{"bilinear", TextureFilter::bilinear}, {"nearest", TextureFilter::nearest}});
  });
  table.said("texture_colour_space", material.texture_colour_space, [&](ColourSpace& v) {
    table.choice("texture_colour_space", v, {{"srgb", ColourSpace::srgb}, {"linear", ColourSpace::linear}});
  });
  return material;
}

}  // namespace

std::map<std::string, MtlMaterial> read_material_tables(const TomlTable& root, const FileContext& context) {
  std::map<std::string, MtlMaterial> materials;
  for (const auto& [name, table] : root.named_tables("material"))
    materials.emplace(name, read_material(name, table, context));
  return materials;
}

}  // namespace vitrum
