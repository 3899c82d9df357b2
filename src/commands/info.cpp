#include <cmath>
#include <cstdio>

#include "commands/commands.hpp"
#include "commands/scene_arguments.hpp"
#include "device/scene_data.hpp"
#include "scene/features.hpp"

namespace vitrum {
namespace {

const char* kind_of(const Shape& shape) {
  constexpr const char* names[] = {"sphere", "plane", "triangle", "mesh"};
  return names[shape.geometry.index()];
}

const char* kind_of(const Light& light) {
  constexpr const char* names[] = {"point", "directional", "quad", "disc", "sphere", "emissive faces of a mesh"};
  return names[light.emitter.index()];
}

template <typename T>
size_t bytes(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

void run_info(const SceneArguments& arguments) {
  const Scene scene = arguments.load();
  const Features features = scene_features(scene);
  const SceneData data = scene_data(scene, features);

  std::printf("scene      %s\n", scene.file.c_str());
  std::printf("camera     pinhole at (%g, %g, %g) m, %d x %d pixels\n", scene.camera.eye.x, scene.camera.eye.y,
              scene.camera.eye.z, scene.film.width, scene.film.height);
  std::printf("shapes     %zu\n", scene.shapes.size());
  for (const Shape& shape : scene.shapes) {
    std::printf("  %-16s %s", shape.name.c_str(), kind_of(shape));
    if (const Mesh* mesh = std::get_if<Mesh>(&shape.geometry))
      std::printf(", %zu triangles\n", mesh->triangles.size());
    else
      std::printf(", material %s\n", scene.materials[shape.material].name.c_str());
  }
  std::printf("materials  %zu\n", scene.materials.size());
  for (const Material& material : scene.materials) {
    std::printf("  %-16s %s\n", material.name.c_str(), material.shader.c_str());
    for (const std::string& line : material.provenance) std::printf("    %s\n", line.c_str());
  }
  std::printf("lights     %zu\n", scene.lights.size());
  for (const Light& light : scene.lights) std::printf("  %-16s %s\n", light.name.c_str(), kind_of(light));
  std::printf("media      %zu of 255\n", data.media.size() - 1);
  std::printf("casters    %zu (photons are aimed at them)\n", data.casters.size());
  std::printf("features   %s\n", features.names().c_str());
  std::printf("kernels   ");
  for (const std::string& stage : stages_for(features)) std::printf(" %s", stage.c_str());
  const size_t shapes = bytes(data.spheres) + bytes(data.flats) + bytes(data.triangles) + bytes(data.positions) +
                        bytes(data.normals) + bytes(data.texcoords);
  std::printf("\nmemory     shapes %.3f MiB, textures %.3f MiB", static_cast<double>(shapes) / 0x1p20,
              static_cast<double>(bytes(data.texels)) / 0x1p20);
  if (features.mesh) {
    const Tree tree = build_tree(data.tree_triangles);
    std::printf(", tree %.3f MiB (built in %.2f s)", static_cast<double>(tree.statistics.bytes) / 0x1p20,
                tree.statistics.seconds);
  }
  if (features.caustics) {
    // As stored, sorted, and a node to seven leaves or nodes, of eight photons at least.
    const double floats = 8 + PHOTON_FIELDS + (features.nearest_photons ? PHOTON_NODE_ROWS / 7.0 : 0.0);
    std::printf(", photon map up to %.1f MiB",
                static_cast<double>(scene.photons.count) * (sizeof(float) * floats) / 0x1p20);
  }
  std::printf("\n");
}

}  // namespace

void add_info_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("info", "Show what was understood of a scene, and what rendering it will need");
  const auto arguments = std::make_shared<SceneArguments>();
  arguments->add_to(*command);
  command->callback([arguments] { run_info(*arguments); });
}

}  // namespace vitrum
