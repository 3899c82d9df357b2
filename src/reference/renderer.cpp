#include "reference/renderer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "reference/fresnel.hpp"
#include "reference/intersect.hpp"
#include "reference/texture.hpp"

namespace vitrum::reference {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double largest(const Spectrum& s) { return std::max({s.r, s.g, s.b}); }

void record(uint64_t& fingerprint, uint64_t decision) {
  fingerprint = (fingerprint ^ decision) * 0x9e3779b97f4a7c15u;
  fingerprint ^= fingerprint >> 29;
}

enum Event : uint64_t { missed = 1, passed, mirrored, split, totally_reflected, flat_normal, cut };

// A ray with what it carries to the eye.
struct Branch {
  Ray ray;
  Spectrum throughput{1.0};                 // R, T and transmittances on the way to the eye, without n^2
  int surfaces_met = 0;
  Media media;
};

// Light that a point would receive across it, and from where.
struct Incoming {
  glm::dvec3 direction{0.0};                // to the light, unit length
  double distance = infinity;               // [m]
  Spectrum irradiance{0.0};                 // on a surface across the direction, through vacuum [W/m2]
};

Incoming incoming(const Light& light, const glm::dvec3& point) {
  if (const auto* directional = std::get_if<DirectionalLight>(&light.emitter))
    return {-directional->direction, infinity, directional->irradiance};
  const auto& lamp = std::get<PointLight>(light.emitter);
  const double distance = glm::distance(lamp.position, point);
  return {(lamp.position - point) / distance, distance, lamp.intensity / (distance * distance)};
}

// One film position: follows all branches, depth first.
class Tracer {
 public:
  Tracer(const Scene& scene, uint32_t medium_at_eye) : scene_(scene), index_at_eye_(index_of(scene, medium_at_eye)) {}

  void follow(Branch branch);
  Sample sample;

 private:
  void gather(const Branch& branch, const Spectrum& radiance) {
    const double n = index_at_eye_ / index_of(scene_, filling(scene_, branch.media));
    sample.radiance += branch.throughput * (n * n) * radiance;
  }

  Spectrum diffuse_reflectance(const Material& material, const Hit& hit);
  Spectrum direct_light(const Branch& branch, const Hit& hit, const Material& material, const Spectrum& rho_d);
  void follow_mirrored(const Branch& branch, const Hit& hit, const glm::dvec3& normal, double share);
  void follow_refracted(const Branch& branch, const Hit& hit, const glm::dvec3& direction, double share, Media media);
  void split_at_glass(const Branch& branch, const Hit& hit, const Crossing& crossing);
  void follow_or_cut(Branch branch);

  const Scene& scene_;
  double index_at_eye_;
};

// The normal on the side that the ray comes from.
glm::dvec3 towards_viewer(const Hit& hit, const glm::dvec3& normal) { return hit.from_front ? normal : -normal; }

void Tracer::follow(Branch branch) {
  const auto hit = closest_hit(scene_, branch.ray);
  const Spectrum sigma_a = absorption_of(scene_, filling(scene_, branch.media));
  branch.throughput *= transmittance(sigma_a, hit ? hit->t : infinity);
  if (!hit) {
    record(sample.decisions.surfaces, missed);
    return gather(branch, scene_.background);
  }
  ++branch.surfaces_met;
  record(sample.decisions.surfaces, (uint64_t{hit->piece.shape} << 32) | hit->piece.primitive);
  record(sample.decisions.surfaces, hit->from_front);

  const Material& material = scene_.materials[hit->material];
  Crossing across;
  if (material.surface == Surface::dielectric) {
    across = crossing(scene_, branch.media, hit->passages);
    if (across.from == across.to) {         // hidden in a medium of higher priority, or between two of the same
      record(sample.decisions.surfaces, passed);
      return follow_refracted(branch, *hit, branch.ray.direction, 1.0, across.after);
    }
  }

  const Spectrum rho_d = diffuse_reflectance(material, *hit);
  if (hit->from_front || !material.emission_is_light) gather(branch, material.emission);
  gather(branch, material.surface == Surface::unlit ? rho_d : direct_light(branch, *hit, material, rho_d));

  if (material.surface == Surface::mirror) {
    record(sample.decisions.surfaces, mirrored);
    // The shading normal serves where it does not send the ray into the mirror.
    const glm::dvec3 geometric = towards_viewer(*hit, hit->geometric_normal);
    glm::dvec3 normal = towards_viewer(*hit, hit->shading_normal);
    if (glm::dot(reflected_direction(branch.ray.direction, normal), geometric) <= 0) normal = geometric;
    if (normal == geometric && hit->shading_normal != hit->geometric_normal) record(sample.decisions.surfaces, flat_normal);
    follow_mirrored(branch, *hit, normal, 1.0);
  } else if (material.surface == Surface::dielectric) {
    split_at_glass(branch, *hit, across);
  }
}

Spectrum Tracer::diffuse_reflectance(const Material& material, const Hit& hit) {
  if (material.diffuse_texture == none || !scene_.render.textures || !hit.texcoord) return material.diffuse;
  const TextureLookup found = lookup(scene_.textures[material.diffuse_texture], *hit.texcoord);
  record(sample.decisions.texels, found.texel.x);
  record(sample.decisions.texels, found.texel.y);
  return material.texture_replaces_diffuse ? found.reflectance : found.reflectance * material.diffuse;
}

Spectrum Tracer::direct_light(const Branch& branch, const Hit& hit, const Material& material, const Spectrum& rho_d) {
  Spectrum radiance(0.0);
  if (!scene_.render.lights || largest(rho_d + material.specular) <= 0) return radiance;
  const glm::dvec3 to_viewer = -branch.ray.direction;
  const glm::dvec3 normal = towards_viewer(hit, hit.shading_normal);
  const Spectrum sigma_a = absorption_of(scene_, filling(scene_, branch.media));
  for (const Light& light : scene_.lights) {
    const Incoming from = incoming(light, hit.position);
    const double cos_theta = glm::dot(normal, from.direction);
    const bool in_front = cos_theta > 0 && glm::dot(towards_viewer(hit, hit.geometric_normal), from.direction) > 0;
    const Ray shadow_ray{hit.position, from.direction, hit.coincident, false};
    const bool lit = in_front && !is_occluded(scene_, shadow_ray, from.distance);
    record(sample.decisions.shadows, lit);
    if (!lit) continue;
    const Spectrum irradiance = from.irradiance * cos_theta * transmittance(sigma_a, from.distance);
    radiance += rho_d * std::numbers::inv_pi * irradiance;
    const double cos_highlight = glm::dot(to_viewer, reflected_direction(-from.direction, normal));
    if (cos_highlight > 0)                  // normalised Phong: Lafortune and Willems 1994
      radiance += material.specular * (material.shininess + 2) / (2 * std::numbers::pi) *
                  std::pow(cos_highlight, material.shininess) * irradiance;
  }
  return radiance;
}

void Tracer::split_at_glass(const Branch& branch, const Hit& hit, const Crossing& across) {
  const double n_i = index_of(scene_, across.from), n_t = index_of(scene_, across.to);
  const glm::dvec3& direction = branch.ray.direction;
  const glm::dvec3 geometric = towards_viewer(hit, hit.geometric_normal);

  // The shading normal serves where both branches leave on their own side of the surface.
  glm::dvec3 normal = towards_viewer(hit, hit.shading_normal);
  auto refracted = refracted_direction(n_i, n_t, direction, normal);
  if (glm::dot(direction, normal) >= 0 || glm::dot(reflected_direction(direction, normal), geometric) <= 0 ||
      (refracted && glm::dot(*refracted, geometric) >= 0)) {
    if (normal != geometric) record(sample.decisions.surfaces, flat_normal);
    normal = geometric;
    refracted = refracted_direction(n_i, n_t, direction, normal);
  }

  record(sample.decisions.surfaces, refracted ? split : totally_reflected);
  if (!refracted) return follow_mirrored(branch, hit, normal, 1.0);
  const Fresnel surface = fresnel(n_i, n_t, std::max(0.0, -glm::dot(direction, normal)));
  const auto constant = scene_.render.constant_reflectance;
  follow_mirrored(branch, hit, normal, constant ? *constant : surface.R);
  follow_refracted(branch, hit, *refracted, constant ? 1 - *constant : surface.T, across.after);
}

void Tracer::follow_mirrored(const Branch& branch, const Hit& hit, const glm::dvec3& normal, double share) {
  Branch next = branch;
  next.ray = {hit.position, reflected_direction(branch.ray.direction, normal), hit.coincident, false};
  next.throughput *= share;
  follow_or_cut(std::move(next));
}

// An opaque surface that coincides with glass is still to be met behind it.
void Tracer::follow_refracted(const Branch& branch, const Hit& hit, const glm::dvec3& direction, double share,
                              Media media) {
  Branch next = branch;
  next.ray = {hit.position, direction, hit.glass, true};
  next.throughput *= share;
  next.media = std::move(media);
  follow_or_cut(std::move(next));
}

void Tracer::follow_or_cut(Branch branch) {
  const double weight = largest(branch.throughput);
  if (weight <= 0) return;
  if (weight < scene_.render.min_weight || branch.surfaces_met >= scene_.render.max_depth) {
    record(sample.decisions.surfaces, cut);
    sample.energy_cut += weight;
    return;
  }
  follow(std::move(branch));
}

}  // namespace

Renderer::Renderer(const Scene& scene) : scene_(scene), media_at_eye_(media_at(scene, scene.camera.eye)) {
  if (!scene.render.lights) return;
  for (const Light& light : scene.lights)
    if (!std::holds_alternative<PointLight>(light.emitter) && !std::holds_alternative<DirectionalLight>(light.emitter))
      throw std::invalid_argument("the reference renderer knows no light with an area: " + light.name);
}

Sample Renderer::at(const glm::dvec2& position) const {
  const Camera& camera = scene_.camera;
  const glm::dvec3 forward = glm::normalize(camera.look_at - camera.eye);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, camera.up));
  const glm::dvec3 up = glm::cross(right, forward);
  const double pixel = 2 * std::tan(glm::radians(camera.vertical_fov) / 2) / scene_.film.height;
  const double x = (position.x - scene_.film.width / 2.0) * pixel;
  const double y = (scene_.film.height / 2.0 - position.y) * pixel;

  Tracer tracer(scene_, filling(scene_, media_at_eye_));
  const Ray ray{camera.eye, glm::normalize(forward + x * right + y * up), {}, false};
  tracer.follow({ray, Spectrum(1.0), 0, media_at_eye_});
  return tracer.sample;
}

Edges Renderer::edges_within(const glm::dvec2& position, double distance) const {
  const Decisions here = at(position).decisions;
  Edges edges;
  for (const glm::dvec2 step : {glm::dvec2(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
    const Decisions there = at(position + distance * step).decisions;
    edges.silhouette = edges.silhouette || there.surfaces != here.surfaces;
    edges.shadow = edges.shadow || there.shadows != here.shadows;
    edges.texel = edges.texel || there.texels != here.texels;
  }
  return edges;
}

std::vector<Sample> render(const Scene& scene, const std::vector<glm::dvec2>& positions) {
  const Renderer renderer(scene);
  std::vector<Sample> samples;
  for (const glm::dvec2& position : positions) samples.push_back(renderer.at(position));
  return samples;
}

}  // namespace vitrum::reference
