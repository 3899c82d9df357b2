#include "reference/texture.hpp"

#include <algorithm>
#include <cmath>

namespace vitrum::reference {
namespace {

int wrapped(int index, int count, bool clamp) {
  if (clamp) return std::clamp(index, 0, count - 1);
  return ((index % count) + count) % count;
}

Spectrum texel(const Texture& texture, int column, int row_from_bottom) {
  const int i = wrapped(column, texture.width, texture.clamp);
  const int j = wrapped(row_from_bottom, texture.height, texture.clamp);
  return Spectrum(texture.texels[static_cast<size_t>(texture.height - 1 - j) * texture.width + i]);
}

}  // namespace

TextureLookup lookup(const Texture& texture, const glm::dvec2& texcoord) {
  glm::dvec2 uv = texcoord * texture.scale + texture.offset;
  uv = texture.clamp ? glm::clamp(uv, 0.0, 1.0) : uv - glm::floor(uv);
  const glm::dvec2 place = uv * glm::dvec2(texture.width, texture.height);

  if (texture.filter == TextureFilter::nearest) {
    const glm::ivec2 at(glm::floor(place));
    return {texel(texture, at.x, at.y), at};
  }
  const glm::dvec2 low = glm::floor(place - 0.5), weight = place - 0.5 - low;
  const glm::ivec2 at(low);
  const Spectrum below = glm::mix(texel(texture, at.x, at.y), texel(texture, at.x + 1, at.y), weight.x);
  const Spectrum above = glm::mix(texel(texture, at.x, at.y + 1), texel(texture, at.x + 1, at.y + 1), weight.x);
  return {glm::mix(below, above, weight.y), at};
}

}  // namespace vitrum::reference
