#pragma once
// MTL files as they are: every keyword with its value and place, before any meaning (materials.hpp gives that).

#include <optional>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace vitrum {

/// A value and where it was said.
template <typename T>
struct Said {
  T value{};
  SourceLocation where;
};

/// `map_Kd` with its options. Unsupported options are listed in MtlMaterial::unused.
struct TextureReference {
  std::string path;                         ///< as found on disk; where it is missing, as it was written
  glm::dvec2 offset{0.0}, scale{1.0};       ///< -o, -s
  bool clamp = false;                       ///< -clamp on
};

/// One material as it was said, in an MTL file or in a scene file's [material.NAME].
struct MtlMaterial {
  std::string name;
  SourceLocation where;
  std::optional<Said<Spectrum>> Ka, Kd, Ks, Ke, Tf;
  std::optional<Said<double>> Ns, Ni, d;
  std::optional<Said<int>> illum;
  std::optional<Said<TextureReference>> map_Kd;
  std::optional<Said<double>> Pr, Pm;       ///< only to tell that Tf means glass
  // Said in scene files only.
  std::optional<Said<std::string>> shader;
  std::optional<Said<Spectrum>> absorption;         ///< [1/m]
  std::optional<Said<Spectrum>> absorption_colour;  ///< transmittance over absorption_distance
  std::optional<Said<double>> absorption_distance;  ///< [m]
  std::optional<Said<int>> priority;
  std::optional<Said<TextureFilter>> texture_filter;
  std::optional<Said<ColourSpace>> texture_colour_space;
  std::vector<Said<std::string>> unused;    ///< keywords that vitrum does not use, with their place
};

/// Reads an MTL file strictly (docs/obj-and-mtl.md). Throws Error with file, line and column.
std::vector<MtlMaterial> read_mtl(const std::string& path);

}  // namespace vitrum
