#pragma once
// The scene as the kernels take it: flat arrays of structs, ready for upload. No OpenCL here.

#include <vector>

#include "device/kernel_headers.hpp"
#include "scene/features.hpp"
#include "scene/scene.hpp"
#include "scene/tree.hpp"

namespace vitrum {

/// Everything that lies in the scene's buffers (kernels/types.h), and the few numbers that go with it.
/// Shapes are numbered spheres first, then flats, then bodies: the faces of a mesh that have one
/// material. Material 0 is the background's.
struct SceneData {
  std::vector<kernel::SphereData> spheres;
  std::vector<kernel::FlatData> flats;
  std::vector<kernel::BodyData> bodies;
  std::vector<kernel::TriangleData> triangles;
  std::vector<float> positions, normals, texcoords;
  std::vector<uint32_t> normal_corners, texcoord_corners;
  std::vector<TreeTriangle> tree_triangles;       ///< in the order of `triangles`; `primitive` counts over all meshes
  std::vector<kernel::MaterialData> materials;
  std::vector<kernel::MediumData> media;
  std::vector<kernel::InterfaceData> interfaces;  ///< [from * media.size() + into]
  std::vector<kernel::LightData> lights;          ///< in the order of Scene::lights
  std::vector<kernel::LightFace> faces;
  kernel::CameraData camera{};
  std::vector<kernel::CasterData> casters;        ///< what photons are aimed at
  uint32_t eye_media = 0;                         ///< stack of media at the eye
  float eye_index = 1.0f;                         ///< index of refraction at the eye
  glm::dvec3 centre{0.0};                         ///< of a sphere around all bounded shapes and the eye [m]
  double radius = 1.0;                            ///< [m]
};

/// Throws Error where the scene has more than the kernels can number (255 media).
SceneData scene_data(const Scene& scene, const Features& features);

/// The textures with all their texels, r, g and b each.
struct TexelData {
  std::vector<kernel::TextureData> textures;
  std::vector<float> texels;
};

/// Apart from the rest, since the texels come later (scene/textures.hpp). Throws Error for more than 2^29 of them.
TexelData texel_data(const Scene& scene);

}  // namespace vitrum
