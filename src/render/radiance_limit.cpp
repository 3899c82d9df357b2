#include "render/radiance_limit.hpp"

#include <algorithm>

namespace vitrum {
namespace {

/// The greatest rho_d that a surface of this material has anywhere.
Spectrum greatest_diffuse(const Scene& scene, const Material& material) {
  if (material.diffuse_texture == none || !scene.render.textures) return material.diffuse;
  Spectrum greatest(0.0);
  for (const glm::vec3& texel : scene.textures[material.diffuse_texture].texels)
    greatest = glm::max(greatest, Spectrum(texel));
  return material.texture_replaces_diffuse ? greatest : greatest * material.diffuse;
}

/// Radiance of a light's surface; none for a point and for parallel light.
std::optional<Spectrum> radiance_of(const Scene& scene, const Light& light) {
  return std::visit(
      [&scene](const auto& emitter) -> std::optional<Spectrum> {
        using T = std::decay_t<decltype(emitter)>;
        if constexpr (std::is_same_v<T, PointLight> || std::is_same_v<T, DirectionalLight>) {
          return std::nullopt;
        } else if constexpr (std::is_same_v<T, MeshLight>) {
          Spectrum greatest(0.0);
          for (const Material& material : scene.materials)
            if (material.emission_is_light) greatest = glm::max(greatest, material.emission);
          return greatest;
        } else {
          return emitter.radiance;
        }
      },
      light.emitter);
}

}  // namespace

RadianceLimit radiance_limit(const Scene& scene, double eye_index, const Film& film) {
  RadianceLimit limit;
  Spectrum lights(0.0);
  if (scene.render.lights || scene.render.caustics)
    for (const Light& light : scene.lights) {
      const std::optional<Spectrum> radiance = radiance_of(scene, light);
      limit.is_bound &= radiance.has_value();
      lights = glm::max(lights, radiance.value_or(Spectrum(0.0)));
    }
  limit.radiance = glm::max(scene.background, lights);
  double least_index = eye_index;
  for (const Material& m : scene.materials) {
    const Spectrum diffuse = greatest_diffuse(scene, m);
    Spectrum shown = m.emission;
    if (m.surface == Surface::unlit) shown += diffuse;
    if (m.surface == Surface::opaque)
      shown += (diffuse + m.specular * (m.shininess + 2.0) / (m.shininess + 1.0)) * lights;
    if (m.surface == Surface::dielectric) {
      least_index = std::min({least_index, 1.0, m.index.value});
      limit.is_bound &= m.emission == Spectrum(0.0) && diffuse == Spectrum(0.0) && m.specular == Spectrum(0.0);
    }
    limit.radiance = glm::max(limit.radiance, shown);
  }
  limit.radiance *= eye_index * eye_index / (least_index * least_index);
  if (limit.is_bound) return limit;
  const std::vector<double> radiance = film.mean("radiance");
  for (size_t i = 0; i < radiance.size(); ++i) {
    double& greatest = limit.radiance[static_cast<int>(i % 3)];
    if (radiance[i] > greatest) greatest = radiance[i];
  }
  return limit;
}

std::vector<double> cut_radiance(const Film& film, const RadianceLimit& limit) {
  std::vector<double> radiance;
  for (const double weight : film.mean("cut"))
    for (int c = 0; c < 3; ++c) radiance.push_back(weight * limit.radiance[c]);
  return radiance;
}

}  // namespace vitrum
