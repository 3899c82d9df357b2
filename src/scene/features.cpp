#include "scene/features.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <variant>

#include "core/printed.hpp"
#include "scene/bodies.hpp"

namespace vitrum {
namespace {

bool is_nonzero(const Spectrum& s) { return s.x != 0.0 || s.y != 0.0 || s.z != 0.0; }

struct Box {
  glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};

  void add(const glm::dvec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
};

/// A shape that rays tell from others: an exact one, or the faces of a mesh that have one material.
struct Piece {
  const Shape* shape;
  uint32_t material;
  std::optional<Body> body;     ///< of a mesh
};

/// Box around a piece, with room for rounding. An infinite plane has the part of its box that `near` meets: itself if it
/// cuts `near`, nothing otherwise.
Box box_of(const Piece& piece, const Box* near) {
  const Shape& shape = *piece.shape;
  Box box;
  if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
    box.add(sphere->centre - sphere->radius);
    box.add(sphere->centre + sphere->radius);
  } else if (const auto* triangle = std::get_if<Triangle>(&shape.geometry)) {
    for (const glm::dvec3& p : {triangle->a, triangle->b, triangle->c}) box.add(p);
  } else if (piece.body) {
    box.add(piece.body->low);
    box.add(piece.body->high);
  } else if (near) {
    const Plane& plane = std::get<Plane>(shape.geometry);
    const glm::dvec3 half = 0.5 * (near->high - near->low);
    const double reach = glm::dot(half, glm::abs(plane.normal)) * (1.0 + 1e-5);
    if (std::abs(glm::dot(near->low + half - plane.point, plane.normal)) <= reach) box = *near;
  }
  const glm::dvec3 room = 1e-5 * glm::max(glm::abs(box.low), glm::abs(box.high));
  box.low -= room;
  box.high += room;
  return box;
}

std::vector<Piece> pieces_of(const Scene& scene) {
  std::vector<Piece> pieces;
  for (const Shape& shape : scene.shapes)
    if (const Mesh* mesh = std::get_if<Mesh>(&shape.geometry))
      for (const Body& body : bodies_of(*mesh)) pieces.push_back({&shape, body.material, body});
    else
      pieces.push_back({&shape, shape.material, {}});
  return pieces;
}

/// Does the box of a transparent piece of a mesh meet that of another piece?
bool may_touch(const Scene& scene, const std::vector<Piece>& pieces) {
  for (const Piece& piece : pieces) {
    if (!piece.body || scene.materials[piece.material].surface != Surface::dielectric) continue;
    const Box box = box_of(piece, nullptr);
    for (const Piece& other : pieces) {
      if (&other == &piece) continue;
      const Box b = box_of(other, &box);
      if (glm::all(glm::lessThanEqual(box.low, b.high)) && glm::all(glm::lessThanEqual(b.low, box.high))) return true;
    }
  }
  return false;
}

}  // namespace

Features scene_features(const Scene& scene) {
  Features f;
  // Only materials that some surface has count.
  std::vector<bool> used(scene.materials.size(), false);
  const std::vector<Piece> pieces = pieces_of(scene);
  size_t media_bodies = 0;
  for (const Piece& piece : pieces) {
    used[piece.material] = true;
    f.mesh |= piece.body.has_value();
    media_bodies += scene.materials[piece.material].surface == Surface::dielectric;
  }
  bool specular_surface = false;
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    if (!used[i]) continue;
    const Material& m = scene.materials[i];
    f.dielectric |= m.surface == Surface::dielectric;
    f.absorption |= m.surface == Surface::dielectric && is_nonzero(m.absorption);
    f.textures |= scene.render.textures && m.diffuse_texture != none;
    f.highlights |= scene.render.lights && is_nonzero(m.specular);
    specular_surface |= m.surface == Surface::dielectric || m.surface == Surface::mirror;
  }
  // With a single body of one medium a ray is inside it or it is not.
  f.media_stack = media_bodies > 1;
  f.contacts = f.mesh && f.dielectric && may_touch(scene, pieces);
  for (const Light& light : scene.lights) f.light_kinds |= 1u << light.emitter.index();
  f.lights = scene.render.lights && !scene.lights.empty();
  f.caustics = scene.render.caustics && specular_surface && !scene.lights.empty() && scene.photons.count > 0;
  f.footprints = f.caustics && scene.photons.estimate == PhotonEstimate::footprints;
  // Lights with an area have no lattice; and patches are no part of a radius that shrinks from pass to pass, or is chosen
  // round by round.
  const PhotonSettings& photons = scene.photons;
  const bool has_lattices = photons.sampling == Sampling::low_discrepancy &&
                            std::all_of(scene.lights.begin(), scene.lights.end(), [](const Light& light) {
                              return std::holds_alternative<PointLight>(light.emitter) ||
                                     std::holds_alternative<DirectionalLight>(light.emitter);
                            });
  f.patches = f.footprints || (f.caustics && has_lattices && photons.estimate == PhotonEstimate::automatic &&
                               !photons.progressive && !scene.render.by_rounds());
  f.nearest_photons = f.caustics && scene.photons.estimate == PhotonEstimate::nearest;
  if (f.dielectric) f.constant_reflectance = scene.render.constant_reflectance;
  f.max_depth = static_cast<unsigned>(scene.render.max_depth);
  return f;
}

std::string Features::build_options() const {
  auto on = [](const char* name, bool value) { return std::string(" -D") + name + (value ? "=1" : "=0"); };
  std::string options = on("HAS_MESH", mesh) + on("HAS_DIELECTRIC", dielectric) + on("HAS_MEDIA_STACK", media_stack) +
                        on("HAS_CONTACTS", contacts) + on("HAS_ABSORPTION", absorption) + on("HAS_TEXTURES", textures) +
                        on("HAS_HIGHLIGHTS", highlights) + on("HAS_DIRECT_LIGHT", lights) +
                        " -DCAUSTICS=" +
                        (nearest_photons ? "CAUSTICS_NEAREST"
                         : footprints    ? "CAUSTICS_FOOTPRINTS"
                         : caustics      ? "CAUSTICS_WITHIN"
                                         : "CAUSTICS_NONE") +
                        on("HAS_PATCHES", patches) + " -DCAMERA_STACK=" + std::to_string(std::max(32u, std::bit_ceil(max_depth + 1))) +
                        " -DLIGHT_KINDS=" + std::to_string(light_kinds);
  if (constant_reflectance) options += printed(" -DCONSTANT_REFLECTANCE=%.9ef", *constant_reflectance);
  return options;
}

std::string Features::names() const {
  std::string text;
  auto add = [&text](bool on, const char* name) {
    if (on) text += (text.empty() ? "" : ", ") + std::string(name);
  };
  add(mesh, "mesh");
  add(dielectric, "dielectric");
  add(media_stack, "media stack");
  add(contacts, "contacts");
  add(absorption, "absorption");
  add(textures, "textures");
  add(highlights, "highlights");
  add(constant_reflectance.has_value(), "constant reflectance");
  add(lights, "direct light");
  add(caustics, "caustics");
  add(footprints, "footprints");
  add(patches, "patches");
  add(nearest_photons, "nearest photons");
  return text.empty() ? "none" : text;
}

std::vector<std::string> photon_stages_for(const Features& f) {
  std::vector<std::string> stages;
  if (f.caustics) stages.push_back("photons");
  if (f.caustics && !f.nearest_photons) stages.push_back("photon_sort");
  if (f.footprints) stages.push_back("photon_footprints");
  return stages;
}

std::vector<std::string> stages_for(const Features& f) {
  std::vector<std::string> stages = photon_stages_for(f);
  stages.insert(stages.begin(), "camera");
  if (f.patches) stages.insert(stages.end(), {"patches", "patch_drawing"});
  return stages;
}

}  // namespace vitrum
