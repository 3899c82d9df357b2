#pragma once
// The texels of a scene's textures. They come apart from the scene, since decoding a picture takes as long as waking a
// device, and nothing before the camera pass needs them.

#include "scene/scene.hpp"

namespace vitrum {

/// Decodes the pictures of all textures of `scene`: fills in their width, height and texels, as linear reflectances.
/// Touches nothing else, so the rest of the scene may be read meanwhile. Warns of reflectances above 1.
/// Throws Error at Texture::where for a picture that cannot be read (read_picture), or that holds values which are
/// negative or no number.
void load_textures(Scene& scene);

}  // namespace vitrum
