#pragma once
// Looking up textures.

#include <glm/glm.hpp>

#include "scene/scene.hpp"

namespace vitrum::reference {

struct TextureLookup {
  Spectrum reflectance{0.0};
  glm::ivec2 texel{0};                      ///< column and row (from the bottom) of the texel at the lower left
};

/// The texture at (u0, v0), to which its scale and offset are applied. Texel (i, j), rows counted from the bottom, has
/// its centre at ((i + .5) / width, (j + .5) / height).
TextureLookup lookup(const Texture& texture, const glm::dvec2& texcoord);

}  // namespace vitrum::reference
