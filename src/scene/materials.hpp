#pragma once
// From what an MTL file or a scene file says to what it means: the one place where `illum` is interpreted.

#include <optional>
#include <string>

#include "scene/mtl_reader.hpp"
#include "scene/scene.hpp"

namespace vitrum {

/// How MTL keywords are read. The clash is illum 2: a glossy glass in the worksheet's files, an opaque surface with a
/// highlight everywhere else. The worksheet also reads Ka as emission, texels as linear and in place of Kd.
enum class MtlReading { common, worksheet };

/// A material's meaning, and the texture it wants (its pixels not read yet).
struct InterpretedMaterial {
  Material material;                        ///< diffuse_texture is not set here
  std::optional<Texture> texture;           ///< path, place and options
};

/// What `said` means under `reading`. Warns of what has no meaning here (nearest meaning taken, values out of range);
/// throws Error for what cannot be meant (Ni 0 on glass, a negative absorption, absorption_colour without distance).
/// Fills Material::provenance with one line per property: value, the keyword it came from, file:line.
InterpretedMaterial interpret(const MtlMaterial& said, MtlReading reading);

/// `over` laid on `base`: what `over` says replaces what `base` says.
MtlMaterial overlaid(const MtlMaterial& base, const MtlMaterial& over);

}  // namespace vitrum
