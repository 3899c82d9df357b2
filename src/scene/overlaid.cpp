#include "scene/materials.hpp"

namespace vitrum {

MtlMaterial overlaid(const MtlMaterial& base, const MtlMaterial& over) {
  MtlMaterial result = base;
  if (!over.name.empty()) result.name = over.name;
  if (!over.where.file.empty()) result.where = over.where;
  // Different words for one thing: the later word counts alone.
  if (over.illum) result.shader.reset();
  if (over.absorption) {
    result.absorption_colour.reset();
    result.absorption_distance.reset();
  }
  if (over.absorption_colour) result.absorption.reset();
  const auto lay = [](auto& below, const auto& above) {
    if (above) below = above;
  };
  lay(result.Ka, over.Ka);
  lay(result.Kd, over.Kd);
  lay(result.Ks, over.Ks);
  lay(result.Ke, over.Ke);
  lay(result.Tf, over.Tf);
  lay(result.Ns, over.Ns);
  lay(result.Ni, over.Ni);
  lay(result.d, over.d);
  lay(result.illum, over.illum);
  lay(result.map_Kd, over.map_Kd);
  lay(result.Pr, over.Pr);
  lay(result.Pm, over.Pm);
  lay(result.shader, over.shader);
  lay(result.absorption, over.absorption);
  lay(result.absorption_colour, over.absorption_colour);
  lay(result.absorption_distance, over.absorption_distance);
  lay(result.priority, over.priority);
  lay(result.texture_filter, over.texture_filter);
  lay(result.texture_colour_space, over.texture_colour_space);
  result.unused.insert(result.unused.end(), over.unused.begin(), over.unused.end());
  return result;
}

}  // namespace vitrum
