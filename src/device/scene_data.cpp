#include "device/scene_data.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <numbers>

#include "core/error.hpp"
#include "device/interface.hpp"
#include "scene/bodies.hpp"
#include "scene/media.hpp"

namespace vitrum {
namespace {

void put(float* to, const glm::dvec3& from) {
  for (int i = 0; i < 3; ++i) to[i] = static_cast<float>(from[i]);
}

/// Sphere around points: the box's centre, which is within sqrt(3) / 1 of the least one and simple.
struct Bounds {
  glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};

  void add(const glm::dvec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  void add(const glm::dvec3& centre, double radius) {
    add(centre - glm::dvec3(radius));
    add(centre + glm::dvec3(radius));
  }
  bool empty() const { return !(low.x <= high.x); }
  glm::dvec3 centre() const { return 0.5 * (low + high); }
};

glm::dvec3 across(const glm::dvec3& n) {
  return glm::normalize(glm::cross(n, std::abs(n.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
}

/// Coordinates (u, v) of a plane's points from edges that need not be perpendicular: the dual basis.
void put_dual(kernel::FlatData& flat, const glm::dvec3& edge_u, const glm::dvec3& edge_v) {
  const glm::dvec3 n = glm::cross(edge_u, edge_v);
  put(flat.u_axis, glm::cross(edge_v, n) / glm::dot(n, n));
  put(flat.v_axis, glm::cross(n, edge_u) / glm::dot(n, n));
  put(flat.normal, glm::normalize(n));
}

class Builder {
 public:
  Builder(const Scene& scene, const Features& features) : scene_(scene), features_(features) {}

  SceneData build() {
    add_materials();
    add_shapes();
    add_lights();
    number_shapes();
    add_camera();
    find_bounds();
    add_casters();
    return std::move(data_);
  }

 private:
  void add_materials() {
    kernel::MaterialData background{};
    put(background.emission, scene_.background);
    background.surface = SURFACE_UNLIT;
    background.texture = NO_INDEX;
    data_.materials.push_back(background);
    data_.media.push_back({{0, 0, 0}, 1.0f, std::numeric_limits<int>::min(), {}});
    std::vector<double> indices = {1.0};
    for (const Material& m : scene_.materials) {
      kernel::MaterialData d{};
      put(d.emission, m.emission);
      put(d.diffuse, m.diffuse);
      put(d.specular, m.specular);
      d.shininess = static_cast<float>(m.shininess);
      d.texture = features_.textures ? m.diffuse_texture : NO_INDEX;
      d.texture_replaces = m.texture_replaces_diffuse;
      d.front_only = m.emission_is_light;
      switch (m.surface) {
        case Surface::unlit: d.surface = SURFACE_UNLIT; break;
        case Surface::opaque: d.surface = SURFACE_OPAQUE; break;
        case Surface::mirror: d.surface = SURFACE_MIRROR; break;
        case Surface::dielectric: d.surface = SURFACE_DIELECTRIC; break;
      }
      medium_of_.push_back(0);
      if (m.surface == Surface::dielectric) {
        if (data_.media.size() > 255)
          throw Error({scene_.file, 0, 0}, "the scene has more than 255 transparent materials",
                      "use one material for several shapes");
        d.medium = medium_of_.back() = static_cast<uint32_t>(data_.media.size());
        kernel::MediumData medium{};
        put(medium.sigma_a, m.absorption);
        medium.index = static_cast<float>(m.index.at(0));
        medium.priority = m.priority;
        data_.media.push_back(medium);
        indices.push_back(m.index.at(0));
      }
      data_.materials.push_back(d);
    }
    for (double from : indices)
      for (double into : indices) data_.interfaces.push_back(make_interface(from, into));
  }

  void add_shapes() {
    for (const Shape& shape : scene_.shapes) {
      const uint32_t material = shape.material + 1;
      if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
        add_sphere(sphere->centre, sphere->radius, material);
      } else if (const auto* plane = std::get_if<Plane>(&shape.geometry)) {
        kernel::FlatData flat{};
        flat.kind = FLAT_PLANE;
        flat.material = material;
        put(flat.point, plane->point);
        put(flat.normal, plane->normal);
        put(flat.u_axis, plane->texture_u);
        put(flat.v_axis, plane->texture_v);
        set_texcoords(flat, {0, 0}, {1, 0}, {0, 1});
        data_.flats.push_back(flat);
      } else if (const auto* triangle = std::get_if<Triangle>(&shape.geometry)) {
        kernel::FlatData flat{};
        flat.kind = FLAT_TRIANGLE;
        flat.material = material;
        put(flat.point, triangle->a);
        put_dual(flat, triangle->b - triangle->a, triangle->c - triangle->a);
        set_texcoords(flat, triangle->uv_a, triangle->uv_b - triangle->uv_a, triangle->uv_c - triangle->uv_a);
        data_.flats.push_back(flat);
      } else {
        add_mesh(shape, std::get<Mesh>(shape.geometry));
      }
    }
  }

  uint32_t add_sphere(const glm::dvec3& centre, double radius, uint32_t material) {
    kernel::SphereData d{};
    put(d.centre, centre);
    d.radius = static_cast<float>(radius);
    d.material = material;
    data_.spheres.push_back(d);
    return static_cast<uint32_t>(data_.spheres.size() - 1);
  }

  static void set_texcoords(kernel::FlatData& flat, const glm::dvec2& origin, const glm::dvec2& u,
                            const glm::dvec2& v) {
    for (int i = 0; i < 2; ++i) {
      flat.texcoord[i] = static_cast<float>(origin[i]);
      flat.texcoord[2 + i] = static_cast<float>(u[i]);
      flat.texcoord[4 + i] = static_cast<float>(v[i]);
    }
  }

  /// Adds what the triangles of a mesh, of which the first is `first_triangle`, have at their corners, from
  /// `first_value` on. Returns BodyData::normals or BodyData::texcoords.
  static uint32_t add_corners(const std::vector<glm::uvec3>& indices, uint32_t first_triangle, uint32_t first_value,
                              std::vector<uint32_t>& corners) {
    if (indices.empty()) return NO_INDEX;
    const auto start = static_cast<uint32_t>(corners.size());
    for (const glm::uvec3& triangle : indices)
      for (int k = 0; k < 3; ++k) corners.push_back(triangle.x == none ? NO_INDEX : first_value + triangle[k]);
    return start - 3 * first_triangle;
  }

  void add_mesh(const Shape& shape, const Mesh& mesh) {
    // Gathers take indices below 2^31.
    for (const size_t floats : {data_.positions.size() + 3 * mesh.positions.size(),
                                data_.normals.size() + 3 * mesh.normals.size(),
                                data_.texcoords.size() + 2 * mesh.texcoords.size()})
      if (floats >= size_t{1} << 31)
        throw Error(shape.where, "with shape '" + shape.name + "' the meshes have more vertices than the kernels can number",
                    "use meshes with fewer than 700 million of them in all");
    const uint32_t first = static_cast<uint32_t>(data_.triangles.size());
    const uint32_t first_position = static_cast<uint32_t>(data_.positions.size() / 3);
    const uint32_t first_normal = static_cast<uint32_t>(data_.normals.size() / 3);
    for (const glm::vec3& p : mesh.positions) data_.positions.insert(data_.positions.end(), {p.x, p.y, p.z});
    for (const glm::vec3& n : mesh.normals) data_.normals.insert(data_.normals.end(), {n.x, n.y, n.z});
    const uint32_t normals = add_corners(mesh.normal_indices, first, first_normal, data_.normal_corners);
    uint32_t texcoords = NO_INDEX;
    if (features_.textures) {
      const uint32_t first_texcoord = static_cast<uint32_t>(data_.texcoords.size() / 2);
      texcoords = add_corners(mesh.texcoord_indices, first, first_texcoord, data_.texcoord_corners);
      for (const glm::vec2& t : mesh.texcoords) data_.texcoords.insert(data_.texcoords.end(), {t.x, t.y});
    }
    std::map<uint32_t, uint32_t> body_of;  // by material
    for (const Body& body : bodies_of(mesh)) {
      const bool closed = body.closed && scene_.materials[body.material].surface == Surface::dielectric;
      body_of[body.material] = static_cast<uint32_t>(data_.bodies.size());
      data_.bodies.push_back({closed, body.material + 1, normals, texcoords});
    }
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
      const glm::uvec3 t = first_position + mesh.triangles[i];
      data_.triangles.push_back({{t.x, t.y, t.z}, body_of.at(mesh.materials[i])});
    }
    first_triangle_[&shape - scene_.shapes.data()] = first;
  }

  void add_lights() {
    for (const Light& light : scene_.lights) {
      kernel::LightData d{};
      d.kind = static_cast<uint32_t>(light.emitter.index());
      d.shape = NO_INDEX;
      d.area = 1.0f;
      put(d.normal, {0, 1, 0});
      glm::dvec3 place(0.0);  // stands for the whole light when its media are looked for
      if (const auto* point = std::get_if<PointLight>(&light.emitter)) {
        put(d.position, point->position);
        put(d.emitted, point->intensity);
        place = point->position;
      } else if (const auto* directional = std::get_if<DirectionalLight>(&light.emitter)) {
        put(d.normal, directional->direction);
        put(d.emitted, directional->irradiance);
      } else if (const auto* quad = std::get_if<QuadLight>(&light.emitter)) {
        const glm::dvec3 normal = glm::cross(quad->edge_u, quad->edge_v);
        put(d.position, quad->corner);
        put(d.u, quad->edge_u);
        put(d.v, quad->edge_v);
        put(d.normal, glm::normalize(normal));
        put(d.emitted, quad->radiance);
        d.area = static_cast<float>(glm::length(normal));
        kernel::FlatData flat{};
        flat.kind = FLAT_PARALLELOGRAM;
        flat.material = add_emitter(quad->radiance);
        put(flat.point, quad->corner);
        put_dual(flat, quad->edge_u, quad->edge_v);
        d.shape = add_light_flat(flat);
        place = quad->corner + 0.5 * (quad->edge_u + quad->edge_v) + 1e-5 * std::sqrt(d.area) * glm::normalize(normal);
      } else if (const auto* disc = std::get_if<DiscLight>(&light.emitter)) {
        const glm::dvec3 u = across(disc->normal), v = glm::cross(disc->normal, u);
        put(d.position, disc->centre);
        put(d.u, disc->radius * u);
        put(d.v, disc->radius * v);
        put(d.normal, disc->normal);
        put(d.emitted, disc->radiance);
        d.radius = static_cast<float>(disc->radius);
        d.area = static_cast<float>(std::numbers::pi * disc->radius * disc->radius);
        kernel::FlatData flat{};
        flat.kind = FLAT_DISC;
        flat.material = add_emitter(disc->radiance);
        put(flat.point, disc->centre);
        put(flat.normal, disc->normal);
        put(flat.u_axis, u / disc->radius);
        put(flat.v_axis, v / disc->radius);
        d.shape = add_light_flat(flat);
        place = disc->centre + 1e-5 * disc->radius * disc->normal;
      } else if (const auto* sphere = std::get_if<SphereLight>(&light.emitter)) {
        put(d.position, sphere->centre);
        put(d.emitted, sphere->radiance);
        d.radius = static_cast<float>(sphere->radius);
        d.area = static_cast<float>(4.0 * std::numbers::pi * sphere->radius * sphere->radius);
        d.shape = add_sphere(sphere->centre, sphere->radius, add_emitter(sphere->radiance));
        place = sphere->centre + 1.00001 * sphere->radius * glm::dvec3(0, 1, 0);
      } else {
        place = add_mesh_light(d, std::get<MeshLight>(light.emitter));
      }
      d.clearance = 1e-5f * static_cast<float>(std::max({std::abs(place.x), std::abs(place.y), std::abs(place.z)}));
      if (d.kind <= LIGHT_DIRECTIONAL) d.clearance = 0.0f;
      if (d.kind != LIGHT_DIRECTIONAL) d.media = stack_at(place);
      data_.lights.push_back(d);
    }
  }

  uint32_t add_emitter(const Spectrum& radiance) {
    kernel::MaterialData d{};
    put(d.emission, radiance);
    d.surface = SURFACE_UNLIT;
    d.texture = NO_INDEX;
    d.front_only = 1;
    data_.materials.push_back(d);
    return static_cast<uint32_t>(data_.materials.size() - 1);
  }

  uint32_t add_light_flat(const kernel::FlatData& flat) {
    data_.flats.push_back(flat);
    return static_cast<uint32_t>(data_.flats.size() - 1);
  }

  /// Walker's alias table over area times luminous radiance (Vose 1991). Returns a place on the light.
  glm::dvec3 add_mesh_light(kernel::LightData& d, const MeshLight& light) {
    const Mesh& mesh = std::get<Mesh>(scene_.shapes[light.shape].geometry);
    const uint32_t first_triangle = first_triangle_.at(light.shape);
    d.first_face = static_cast<uint32_t>(data_.faces.size());
    std::vector<double> weights;
    glm::dvec3 place(0.0);
    double area = 0.0;
    for (uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const Material& material = scene_.materials[mesh.materials[i]];
      if (!material.emission_is_light || material.emission == Spectrum(0.0)) continue;
      const glm::dvec3 a = mesh.positions[mesh.triangles[i].x], b = mesh.positions[mesh.triangles[i].y],
                       c = mesh.positions[mesh.triangles[i].z];
      const double twice_area = glm::length(glm::cross(b - a, c - a));
      if (twice_area == 0.0) continue;
      kernel::LightFace face{};
      face.triangle = first_triangle + i;
      put(face.radiance, material.emission);
      data_.faces.push_back(face);
      weights.push_back(0.5 * twice_area * (material.emission.x + material.emission.y + material.emission.z));
      if (weights.size() == 1)
        place = (a + b + c) / 3.0 + 1e-5 * std::sqrt(twice_area) * glm::normalize(glm::cross(b - a, c - a));
      area += 0.5 * twice_area;
    }
    const size_t n = weights.size();
    assert(n > 0);
    d.face_count = static_cast<uint32_t>(n);
    d.area = static_cast<float>(area);
    double total = 0.0;
    for (double w : weights) total += w;
    std::vector<double> scaled(n);
    std::vector<uint32_t> small, large;
    for (uint32_t i = 0; i < n; ++i) {
      data_.faces[d.first_face + i].selection = static_cast<float>(weights[i] / total);
      scaled[i] = weights[i] / total * static_cast<double>(n);
      (scaled[i] < 1.0 ? small : large).push_back(i);
    }
    while (!small.empty() && !large.empty()) {
      const uint32_t s = small.back(), l = large.back();
      small.pop_back();
      data_.faces[d.first_face + s].probability = static_cast<float>(scaled[s]);
      data_.faces[d.first_face + s].alias = l;
      scaled[l] -= 1.0 - scaled[s];
      if (scaled[l] < 1.0) {
        large.pop_back();
        small.push_back(l);
      }
    }
    for (const std::vector<uint32_t>* rest : {&small, &large})
      for (uint32_t i : *rest) {
        data_.faces[d.first_face + i].probability = 1.0f;
        data_.faces[d.first_face + i].alias = i;
      }
    return place;
  }

  void number_shapes() {
    const uint32_t spheres = static_cast<uint32_t>(data_.spheres.size());
    const uint32_t exact = spheres + static_cast<uint32_t>(data_.flats.size());
    data_.tree_triangles = tree_triangles(scene_);
    assert(data_.tree_triangles.size() == data_.triangles.size());
    for (uint32_t i = 0; i < data_.triangles.size(); ++i) {
      data_.triangles[i].shape += exact;
      data_.tree_triangles[i].shape = data_.triangles[i].shape;
      data_.tree_triangles[i].primitive = i;
    }
    for (kernel::LightData& light : data_.lights)
      if (light.kind == LIGHT_QUAD || light.kind == LIGHT_DISC) light.shape += spheres;
  }

  void add_camera() {
    const Camera& camera = scene_.camera;
    kernel::CameraData& d = data_.camera;
    const glm::dvec3 forward = glm::normalize(camera.look_at - camera.eye);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, camera.up));
    put(d.eye, camera.eye);
    put(d.forward, forward);
    put(d.right, right);
    put(d.up, glm::cross(right, forward));
    const double half_height = std::tan(0.5 * camera.vertical_fov * std::numbers::pi / 180.0);
    const double step = 2.0 * half_height / scene_.film.height;
    d.left = static_cast<float>(-0.5 * step * scene_.film.width);
    d.top = static_cast<float>(half_height);
    d.step_x = d.step_y = static_cast<float>(step);
    d.width = static_cast<uint32_t>(scene_.film.width);
    d.height = static_cast<uint32_t>(scene_.film.height);
    data_.eye_media = stack_at(camera.eye);
    data_.eye_index = data_.media[data_.eye_media & 0xffu].index;
  }

  /// The stack of media at a point, the one that fills the place in the lowest byte.
  uint32_t stack_at(const glm::dvec3& point) const {
    if (!features_.dielectric) return 0;
    uint32_t stack = 0;
    int shift = 0;
    for (uint32_t material : media_at(scene_, point)) {
      if (shift > 24) break;
      stack |= medium_of_[material] << shift;
      shift += 8;
    }
    return stack;
  }

  void find_bounds() {
    Bounds all;
    all.add(scene_.camera.eye);
    for (const Shape& shape : scene_.shapes) add_bounds(shape, all, false);
    for (const kernel::LightData& light : data_.lights)
      if (light.kind != LIGHT_DIRECTIONAL) all.add({light.position[0], light.position[1], light.position[2]});
    data_.centre = all.centre();
    data_.radius = std::max(1e-3, 0.5 * glm::length(all.high - all.low));
  }

  void add_bounds(const Shape& shape, Bounds& bounds, bool only_casting) const {
    if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
      bounds.add(sphere->centre, sphere->radius);
    } else if (const auto* triangle = std::get_if<Triangle>(&shape.geometry)) {
      for (const glm::dvec3& p : {triangle->a, triangle->b, triangle->c}) bounds.add(p);
    } else if (const auto* mesh = std::get_if<Mesh>(&shape.geometry)) {
      for (size_t i = 0; i < mesh->triangles.size(); ++i) {
        if (only_casting && !casts(mesh->materials[i])) continue;
        for (int k = 0; k < 3; ++k) bounds.add(mesh->positions[mesh->triangles[i][k]]);
      }
    }
  }

  bool casts(uint32_t material) const {
    const Surface surface = scene_.materials[material].surface;
    return surface == Surface::dielectric || surface == Surface::mirror;
  }

  void add_casters() {
    if (!features_.caustics) return;
    for (const Shape& shape : scene_.shapes) {
      const Mesh* mesh = std::get_if<Mesh>(&shape.geometry);
      if (!mesh && !casts(shape.material)) continue;
      kernel::CasterData caster{};
      if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
        put(caster.centre, sphere->centre);
        caster.radius = static_cast<float>(sphere->radius);
      } else if (std::holds_alternative<Plane>(shape.geometry)) {
        put(caster.centre, data_.centre);
        caster.radius = std::numeric_limits<float>::infinity();
      } else {
        Bounds bounds;
        add_bounds(shape, bounds, true);
        if (bounds.empty()) continue;
        const glm::dvec3 centre = bounds.centre();
        put(caster.centre, centre);
        caster.radius = static_cast<float>(farthest(shape, centre) * (1.0 + 1e-6));
      }
      data_.casters.push_back(caster);
    }
  }

  double farthest(const Shape& shape, const glm::dvec3& from) const {
    double r2 = 0.0;
    auto reach = [&](const glm::dvec3& p) { r2 = std::max(r2, glm::dot(p - from, p - from)); };
    if (const auto* triangle = std::get_if<Triangle>(&shape.geometry)) {
      for (const glm::dvec3& p : {triangle->a, triangle->b, triangle->c}) reach(p);
    } else {
      const Mesh& mesh = std::get<Mesh>(shape.geometry);
      for (size_t i = 0; i < mesh.triangles.size(); ++i)
        if (casts(mesh.materials[i]))
          for (int k = 0; k < 3; ++k) reach(mesh.positions[mesh.triangles[i][k]]);
    }
    return std::sqrt(r2);
  }

  const Scene& scene_;
  const Features& features_;
  SceneData data_;
  std::vector<uint32_t> medium_of_;                ///< of each material of the scene
  std::map<std::ptrdiff_t, uint32_t> first_triangle_;  ///< of meshes, by shape
};

}  // namespace

SceneData scene_data(const Scene& scene, const Features& features) { return Builder(scene, features).build(); }

TexelData texel_data(const Scene& scene) {
  TexelData data;
  for (const Texture& t : scene.textures) {
    kernel::TextureData d{};
    d.first_texel = static_cast<uint32_t>(data.texels.size() / 3);
    d.width = t.width;
    d.height = t.height;
    d.bilinear = t.filter == TextureFilter::bilinear;
    d.clamp = t.clamp;
    for (int i = 0; i < 2; ++i) {
      d.scale[i] = static_cast<float>(t.scale[i]);
      d.offset[i] = static_cast<float>(t.offset[i]);
    }
    if (data.texels.size() / 3 + t.texels.size() > (1u << 29))
      throw Error(t.where, "the scene's textures hold more than 2^29 texels", "use smaller pictures");
    for (const glm::vec3& texel : t.texels) data.texels.insert(data.texels.end(), {texel.x, texel.y, texel.z});
    data.textures.push_back(d);
  }
  return data;
}

}  // namespace vitrum
