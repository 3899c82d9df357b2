#pragma once
// The inventory of the scene's buffers on the device, in the order of kernels/scene.h.

#include "device/opencl.hpp"
#include "device/scene_data.hpp"

namespace vitrum {

struct DeviceScene {
  Buffer<kernel::SphereData> spheres;
  Buffer<kernel::FlatData> flats;
  Buffer<kernel::MaterialData> materials;
  Buffer<kernel::MediumData> media;
  Buffer<kernel::InterfaceData> interfaces;
  Buffer<kernel::LightData> lights;
  uint32_t n_spheres = 0, n_flats = 0, n_media = 0;
  // With Features::mesh.
  bool has_mesh = false;
  Buffer<kernel::TreeNode> nodes;
  Buffer<kernel::TreeLeaf> leaves;
  Buffer<kernel::BodyData> bodies;
  Buffer<kernel::TriangleData> triangles;
  Buffer<float> positions, normals, texcoords;
  Buffer<uint32_t> normal_corners, texcoord_corners;
  Buffer<kernel::LightFace> faces;
  // With Features::textures; without texels until upload_texels.
  bool has_textures = false;
  Buffer<kernel::TextureData> textures;
  Buffer<float> texels;
  // Not in kernels/scene.h: only some stages take them.
  Buffer<kernel::CameraData> camera;
  Buffer<kernel::CasterData> casters;

  /// Sets the scene's arguments, the first of every kernel that takes them; returns the index of the next argument.
  unsigned set_arguments(cl::Kernel& kernel) const;
  /// Copies the textures to the device; before the first kernel that reads them.
  void upload_texels(Device& device, const TexelData& data);
};

/// Copies the scene to the device, but for its textures. `tree` is that of data.tree_triangles, or nullptr without meshes.
DeviceScene upload(Device& device, const SceneData& data, const Features& features, const Tree* tree);

}  // namespace vitrum
