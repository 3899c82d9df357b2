#include "scene/textures.hpp"

#include <algorithm>
#include <cmath>

#include "core/log.hpp"
#include "film/images.hpp"

namespace vitrum {
namespace {

/// IEC 61966-2-1: the linear value of an encoded one.
float srgb_to_linear(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

void decode(Texture& texture) {
  Picture picture = read_picture(texture.path, texture.where);
  bool above_one = false;
  for (glm::vec3& texel : picture.pixels) {
    for (int channel = 0; channel < 3; ++channel) {
      if (!(texel[channel] >= 0.0f && std::isfinite(texel[channel])))
        throw Error(texture.where, "the texture '" + texture.path + "' holds values that are negative or no number",
                    "a reflectance lies between 0 and 1");
      if (texture.colour_space == ColourSpace::srgb) texel[channel] = srgb_to_linear(texel[channel]);
      above_one |= texel[channel] > 1.0f;
    }
  }
  if (above_one) warn(texture.where, "the texture '" + texture.path + "' holds reflectances above 1, which make light");
  texture.width = picture.width;
  texture.height = picture.height;
  texture.texels = std::move(picture.pixels);
}

}  // namespace

void load_textures(Scene& scene) {
  std::vector<Texture>& textures = scene.textures;
  for (auto texture = textures.begin(); texture != textures.end(); ++texture) {
    const auto same_texels = std::find_if(textures.begin(), texture, [&](const Texture& t) {
      return t.path == texture->path && t.colour_space == texture->colour_space;
    });
    if (same_texels == texture) {
      decode(*texture);
    } else {
      texture->width = same_texels->width;
      texture->height = same_texels->height;
      texture->texels = same_texels->texels;
    }
  }
}

}  // namespace vitrum
