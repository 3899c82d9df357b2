#include "scene/media.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

namespace vitrum {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr size_t ray_count = 16;

/// Distances along the rays [m].
using Distances = std::array<double, ray_count>;

/// Directions spread evenly over the sphere: Fibonacci's lattice (Swinbank and Purser 2006), turned by an angle without
/// meaning, so that no ray runs along the axes that scenes are built along.
const std::array<glm::dvec3, ray_count>& directions() {
  static const std::array<glm::dvec3, ray_count> all = [] {
    std::array<glm::dvec3, ray_count> result;
    constexpr double golden_angle = 2.0 * std::numbers::pi * (2.0 - std::numbers::phi);
    for (size_t i = 0; i < ray_count; ++i) {
      const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / ray_count;
      const double r = std::sqrt(1.0 - z * z), phi = golden_angle * static_cast<double>(i) + 0.4321;
      const glm::dvec3 d(r * std::cos(phi), r * std::sin(phi), z);
      // Another tilt of the lattice's axis, away from the z axis.
      result[i] = glm::normalize(glm::dvec3(0.8 * d.x + 0.6 * d.z, d.y, 0.8 * d.z - 0.6 * d.x));
    }
    return result;
  }();
  return all;
}

/// Calls meet(ray, distance, from_front) for every ray from `point` that crosses the triangle.
/// Moeller and Trumbore 1997, with the products that all rays of one origin share taken out.
template <typename Meet>
void cross_triangle(const glm::dvec3& point, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                    const Meet& meet) {
  const glm::dvec3 ab = b - a, ac = c - a, s = point - a;
  const glm::dvec3 normal = glm::cross(ab, ac), for_u = glm::cross(ac, s), for_v = glm::cross(s, ab);
  const double height = glm::dot(s, normal);
  for (size_t ray = 0; ray < ray_count; ++ray) {
    const glm::dvec3& d = directions()[ray];
    const double determinant = -glm::dot(d, normal);
    // The ray meets the plane ahead only if it goes towards it.
    if (!(determinant * height > 0.0)) continue;
    const double u = glm::dot(d, for_u) / determinant, v = glm::dot(d, for_v) / determinant;
    if (u >= 0.0 && v >= 0.0 && u + v <= 1.0) meet(ray, height / determinant, determinant > 0.0);
  }
}

template <typename Meet>
void cross_sphere(const glm::dvec3& point, const Sphere& sphere, const Meet& meet) {
  const glm::dvec3 to_centre = sphere.centre - point;
  for (size_t ray = 0; ray < ray_count; ++ray) {
    const glm::dvec3& d = directions()[ray];
    const double middle = glm::dot(to_centre, d);
    const glm::dvec3 off_axis = to_centre - middle * d;
    const double square = sphere.radius * sphere.radius - glm::dot(off_axis, off_axis);
    if (square < 0.0) continue;
    const double half = std::sqrt(square);
    if (const double nearest = middle - half > 0.0 ? middle - half : middle + half; nearest > 0.0) meet(ray, nearest);
  }
}

bool is_dielectric(const Scene& scene, uint32_t material) {
  return scene.materials[material].surface == Surface::dielectric;
}

/// Calls visit(material, a, b, c) for every face of a mesh.
template <typename Visit>
void for_each_face(const Mesh& mesh, const Visit& visit) {
  for (size_t face = 0; face < mesh.triangles.size(); ++face) {
    const glm::uvec3 corners = mesh.triangles[face];
    visit(mesh.materials[face], glm::dvec3(mesh.positions[corners.x]), glm::dvec3(mesh.positions[corners.y]),
          glm::dvec3(mesh.positions[corners.z]));
  }
}

/// How far each ray sees until something opaque.
Distances opaque_distances(const Scene& scene, const glm::dvec3& point) {
  Distances distances;
  distances.fill(infinity);
  const auto meet = [&](size_t ray, double distance, bool = true) {
    distances[ray] = std::min(distances[ray], distance);
  };
  for (const Shape& shape : scene.shapes) {
    if (const Mesh* mesh = std::get_if<Mesh>(&shape.geometry)) {
      for_each_face(*mesh, [&](uint32_t material, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
        if (!is_dielectric(scene, material)) cross_triangle(point, a, b, c, meet);
      });
      continue;
    }
    if (is_dielectric(scene, shape.material)) continue;
    if (const Sphere* sphere = std::get_if<Sphere>(&shape.geometry)) {
      cross_sphere(point, *sphere, meet);
    } else if (const Triangle* triangle = std::get_if<Triangle>(&shape.geometry)) {
      cross_triangle(point, triangle->a, triangle->b, triangle->c, meet);
    } else if (const Plane* plane = std::get_if<Plane>(&shape.geometry)) {
      const double height = glm::dot(plane->point - point, plane->normal);
      for (size_t ray = 0; ray < ray_count; ++ray)
        if (const double along = glm::dot(directions()[ray], plane->normal); height * along > 0.0)
          meet(ray, height / along);
    }
  }
  return distances;
}

/// Materials of a mesh whose faces vote the point inside.
std::vector<uint32_t> media_of_mesh(const Scene& scene, const Mesh& mesh, const glm::dvec3& point,
                                    const Distances& opaque) {
  struct FirstFace {
    double distance = infinity;
    bool from_front = false;
  };
  std::map<uint32_t, std::array<FirstFace, ray_count>> first_faces;
  for_each_face(mesh, [&](uint32_t material, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    if (!is_dielectric(scene, material)) return;
    auto& first = first_faces[material];
    cross_triangle(point, a, b, c, [&](size_t ray, double distance, bool from_front) {
      if (distance < first[ray].distance) first[ray] = {distance, from_front};
    });
  });

  // Glass that stands on an opaque table is coplanar with it up to the rounding of float coordinates.
  constexpr double coplanar = 1.0 + 1e-5;
  std::vector<uint32_t> inside;
  for (const auto& [material, first] : first_faces) {
    int balance = 0;
    for (size_t ray = 0; ray < ray_count; ++ray)
      if (first[ray].distance < infinity && first[ray].distance <= opaque[ray] * coplanar)
        balance += first[ray].from_front ? -1 : 1;
    if (balance > 0) inside.push_back(material);
  }
  return inside;
}

}  // namespace

std::vector<uint32_t> media_at(const Scene& scene, glm::dvec3 point) {
  const bool has_dielectric_mesh = std::any_of(scene.shapes.begin(), scene.shapes.end(), [&](const Shape& shape) {
    const Mesh* mesh = std::get_if<Mesh>(&shape.geometry);
    return mesh && std::any_of(mesh->materials.begin(), mesh->materials.end(),
                               [&](uint32_t material) { return is_dielectric(scene, material); });
  });
  const Distances opaque = has_dielectric_mesh ? opaque_distances(scene, point) : Distances{};

  std::vector<uint32_t> media;
  for (const Shape& shape : scene.shapes) {
    if (const Mesh* mesh = std::get_if<Mesh>(&shape.geometry)) {
      if (!has_dielectric_mesh) continue;
      const std::vector<uint32_t> inside = media_of_mesh(scene, *mesh, point, opaque);
      media.insert(media.end(), inside.begin(), inside.end());
      continue;
    }
    if (!is_dielectric(scene, shape.material)) continue;
    const Sphere* sphere = std::get_if<Sphere>(&shape.geometry);
    const Plane* plane = std::get_if<Plane>(&shape.geometry);
    if ((sphere && glm::length(point - sphere->centre) < sphere->radius) ||
        (plane && glm::dot(point - plane->point, plane->normal) < 0.0))
      media.push_back(shape.material);
  }
  std::stable_sort(media.begin(), media.end(), [&](uint32_t a, uint32_t b) {
    return scene.materials[a].priority > scene.materials[b].priority;
  });
  return media;
}

}  // namespace vitrum
