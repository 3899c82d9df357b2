#include <cmath>
#include <cstdio>

#include "commands/commands.hpp"
#include "commands/scene_arguments.hpp"
#include "core/printed.hpp"
#include "device/scene_data.hpp"
#include "render/photon_pass.hpp"
#include "render/rounds.hpp"
#include "scene/features.hpp"
#include "scene/textures.hpp"

namespace vitrum {
namespace {

std::string text_of(const glm::dvec3& v) { return printed("(%.6g, %.6g, %.6g)", v.x, v.y, v.z); }

struct ShapeText {
  std::string operator()(const Sphere& s) const {
    return "sphere, centre " + text_of(s.centre) + " m, radius " + printed("%.6g m", s.radius);
  }
  std::string operator()(const Plane& p) const { return "plane through " + text_of(p.point) + " m, normal " + text_of(p.normal); }
  std::string operator()(const Triangle& t) const {
    return "triangle, corners " + text_of(t.a) + " " + text_of(t.b) + " " + text_of(t.c) + " m";
  }
  std::string operator()(const Mesh& m) const { return "mesh, " + std::to_string(m.triangles.size()) + " triangles"; }
};

/// Triangles of meshes and single ones.
size_t triangle_count(const Scene& scene) {
  size_t count = 0;
  for (const Shape& shape : scene.shapes) {
    if (const Mesh* mesh = std::get_if<Mesh>(&shape.geometry)) count += mesh->triangles.size();
    count += std::holds_alternative<Triangle>(shape.geometry);
  }
  return count;
}

/// "3 shapes", "1 light".
std::string counted(size_t count, const char* what) {
  return std::to_string(count) + ' ' + what + (count == 1 ? "" : "s");
}

template <typename T>
size_t bytes(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

void run_info(const SceneArguments& arguments) {
  Scene scene = arguments.load();
  load_textures(scene);
  const Features features = scene_features(scene);
  const SceneData data = scene_data(scene, features);

  std::printf("scene      %s\n", scene.file.c_str());
  const Camera& camera = scene.camera;
  std::printf("camera     pinhole at %s m, looks at %s m, %.6g degrees high\n", text_of(camera.eye).c_str(),
              text_of(camera.look_at).c_str(), camera.vertical_fov);
  // As many samples and photons as a target takes are not known before.
  const bool by_rounds = scene.render.by_rounds();
  std::string sampling = by_rounds ? "sampled" : counted(static_cast<size_t>(scene.render.samples), "sample") + " each";
  if (scene.render.target_error > 0.0) sampling += printed(" to a relative error of %g", scene.render.target_error);
  if (scene.render.time_limit > 0.0) sampling += printed(" for %g s at most", scene.render.time_limit);
  std::printf("picture    %d x %d pixels, %s\n", scene.film.width, scene.film.height, sampling.c_str());
  std::printf("background %s W/(m2 sr)\n", text_of(scene.background).c_str());
  std::printf("%s, %s\n", counted(scene.shapes.size(), "shape").c_str(),
              counted(triangle_count(scene), "triangle").c_str());
  for (const Shape& shape : scene.shapes) {
    std::printf("  %-16s %s", shape.name.c_str(), std::visit(ShapeText{}, shape.geometry).c_str());
    if (shape.material != none) std::printf(", material %s", scene.materials[shape.material].name.c_str());
    std::printf("\n");
  }
  std::printf("%s\n", counted(scene.materials.size(), "material").c_str());
  for (const Material& material : scene.materials) {
    std::printf("  %-16s %s\n", material.name.c_str(), material.shader.c_str());
    for (const std::string& line : material.provenance) std::printf("    %s\n", line.c_str());
  }
  std::printf("%s\n", counted(scene.lights.size(), "light").c_str());
  for (const Light& light : scene.lights)
    std::printf("  %-16s %s\n", light.name.c_str(), light_text(light).c_str());
  std::printf("media      %zu of 255\n", data.media.size() - 1);
  if (features.caustics)
    std::printf("photons    %s, aimed at what refracts or mirrors: %s\n",
                by_rounds ? "as many as it takes" : std::to_string(scene.photons.count).c_str(),
                counted(data.casters.size(), "shape").c_str());
  std::printf("features   %s\n", features.names().c_str());
  std::printf("kernels   ");
  for (const std::string& stage : stages_for(features)) std::printf(" %s", stage.c_str());
  const size_t shapes = bytes(data.spheres) + bytes(data.flats) + bytes(data.triangles) + bytes(data.positions) +
                        bytes(data.normals) + bytes(data.texcoords) + bytes(data.normal_corners) +
                        bytes(data.texcoord_corners);
  std::printf("\nmemory     shapes %.3f MiB, textures %.3f MiB", static_cast<double>(shapes) / 0x1p20,
              features.textures ? static_cast<double>(bytes(texel_data(scene).texels)) / 0x1p20 : 0.0);
  if (features.mesh) {
    const Tree tree = build_tree(data.tree_triangles);
    std::printf(", tree %.3f MiB (built in %.2f s)", static_cast<double>(tree.statistics.bytes) / 0x1p20,
                tree.statistics.seconds);
  }
  const double pixels = static_cast<double>(scene.film.width) * scene.film.height;
  std::printf(", film %.3f MiB", pixels * FILM_PLANES * sizeof(float) / 0x1p20);
  if (features.caustics) {
    // Of one pass: as stored and in rows of the sort; or in a tree, with a node to seven leaves or nodes of eight photons; of
    // footprints about nine entries each, several times as many where light is focussed in one place and spread in another.
    const double floats = features.footprints        ? 9.0 * FOOTPRINT_ROW
                          : features.nearest_photons ? PHOTON_ROW + PHOTON_FIELDS + PHOTON_NODE_ROWS / 7.0
                                                     : 2.0 * PHOTON_ROW;
    double photons = by_rounds ? static_cast<double>(photons_in_memory)
                               : std::ceil(static_cast<double>(scene.photons.count) / scene.render.passes);
    const double on_lattice = std::min(photons, static_cast<double>(largest_lattice));
    if (features.footprints) photons = on_lattice;
    std::printf(", photon map %s %.1f MiB", features.footprints ? "about" : "up to",
                photons * (sizeof(float) * floats) / 0x1p20);
    // With room for twice as many that branch off, and what neighbours tell each other.
    if (features.patches)
      std::printf(", photons in flight up to %.1f MiB", on_lattice * sizeof(float) * (3.0 * ARRIVED_ROW + 1.5 * LANDING_ROW) / 0x1p20);
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
