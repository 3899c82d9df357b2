#include "device/device_scene.hpp"

namespace vitrum {

DeviceScene upload(Device& device, const SceneData& data, const Features& features, const Tree* tree) {
  DeviceScene d;
  d.spheres = device.upload(data.spheres, "shapes");
  d.flats = device.upload(data.flats, "shapes");
  d.materials = device.upload(data.materials, "materials");
  d.media = device.upload(data.media, "materials");
  d.interfaces = device.upload(data.interfaces, "materials");
  d.lights = device.upload(data.lights, "lights");
  d.n_spheres = static_cast<uint32_t>(data.spheres.size());
  d.n_flats = static_cast<uint32_t>(data.flats.size());
  d.n_media = static_cast<uint32_t>(data.media.size());
  d.has_mesh = features.mesh;
  if (features.mesh) {
    d.nodes = device.upload(tree->nodes, "tree");
    d.leaves = device.upload(tree->leaves, "tree");
    d.bodies = device.upload(data.bodies, "meshes");
    d.triangles = device.upload(data.triangles, "meshes");
    d.positions = device.upload(data.positions, "meshes");
    d.normals = device.upload(data.normals, "meshes");
    d.texcoords = device.upload(data.texcoords, "meshes");
    d.normal_corners = device.upload(data.normal_corners, "meshes");
    d.texcoord_corners = device.upload(data.texcoord_corners, "meshes");
    d.faces = device.upload(data.faces, "lights");
  }
  d.has_textures = features.textures;
  if (features.textures) d.upload_texels(device, {});
  d.camera = device.upload(std::vector<kernel::CameraData>{data.camera}, "camera");
  if (features.caustics) d.casters = device.upload(data.casters, "lights");
  return d;
}

void DeviceScene::upload_texels(Device& device, const TexelData& data) {
  textures = device.upload(data.textures, "textures");
  texels = device.upload(data.texels, "textures");
}

unsigned DeviceScene::set_arguments(cl::Kernel& kernel) const {
  vitrum::set_arguments(kernel, 0, spheres, flats, materials, media, interfaces, lights, n_spheres, n_flats, n_media);
  unsigned next = 9;
  if (has_mesh) {
    vitrum::set_arguments(kernel, next, nodes, leaves, bodies, triangles, positions, normals, texcoords,
                          normal_corners, texcoord_corners, faces);
    next += 10;
  }
  if (has_textures) {
    vitrum::set_arguments(kernel, next, textures, texels);
    next += 2;
  }
  return next;
}

}  // namespace vitrum
