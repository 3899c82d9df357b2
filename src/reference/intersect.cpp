#include "reference/intersect.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

namespace vitrum::reference {
namespace {

struct Candidate {
  double t;
  Piece piece;
  double u = 0, v = 0;                      // barycentric weights of corners b and c
};

struct Corners {
  glm::dvec3 a, b, c;
};

Corners corners_of(const Triangle& triangle) { return {triangle.a, triangle.b, triangle.c}; }

Corners corners_of(const Mesh& mesh, uint32_t primitive) {
  const glm::uvec3 index = mesh.triangles[primitive];
  return {mesh.positions[index.x], mesh.positions[index.y], mesh.positions[index.z]};
}

// Weights by signed volumes (Pluecker): an edge's volume is exactly negated in the neighbour, which runs along it the
// other way, and 0 counts for both, so no ray slips between them.
std::optional<Candidate> met(const Ray& ray, const Corners& corners, Piece piece) {
  const glm::dvec3 a = corners.a - ray.origin, b = corners.b - ray.origin, c = corners.c - ray.origin;
  const double wa = glm::dot(ray.direction, glm::cross(c, b));
  const double wb = glm::dot(ray.direction, glm::cross(a, c));
  const double wc = glm::dot(ray.direction, glm::cross(b, a));
  if ((wa < 0 || wb < 0 || wc < 0) && (wa > 0 || wb > 0 || wc > 0)) return std::nullopt;
  const double sum = wa + wb + wc;
  const glm::dvec3 normal = glm::cross(corners.b - corners.a, corners.c - corners.a);
  const double slope = glm::dot(ray.direction, normal);
  if (sum == 0 || slope == 0) return std::nullopt;
  return Candidate{glm::dot(a, normal) / slope, piece, wb / sum, wc / sum};
}

// Calls visit(candidate) for everything on the whole line, but for what the ray leaves.
template <typename Visit>
void for_each_on_line(const Scene& scene, const Ray& ray, const Visit& visit) {
  const auto is_left = [&](Piece piece) {
    return std::find(ray.left.begin(), ray.left.end(), piece) != ray.left.end();
  };
  const auto visit_triangle = [&](const Corners& corners, Piece piece) {
    if (is_left(piece)) return;
    if (const auto candidate = met(ray, corners, piece)) visit(*candidate);
  };
  for (uint32_t shape = 0; shape < scene.shapes.size(); ++shape) {
    const auto& geometry = scene.shapes[shape].geometry;
    const Piece piece{shape, 0};
    if (const auto* sphere = std::get_if<Sphere>(&geometry)) {
      const glm::dvec3 from_centre = ray.origin - sphere->centre;
      const double b = glm::dot(from_centre, ray.direction);
      if (is_left(piece)) {
        visit({-2 * b, piece});             // the origin is one root of the two
        continue;
      }
      // The distance of the centre from the line as a vector does not cancel (Haines et al. 2019).
      const glm::dvec3 across = from_centre - b * ray.direction;
      const double squared = sphere->radius * sphere->radius - glm::dot(across, across);
      if (squared < 0) continue;
      visit({-b - std::sqrt(squared), piece});
      visit({-b + std::sqrt(squared), piece});
    } else if (const auto* plane = std::get_if<Plane>(&geometry)) {
      const double slope = glm::dot(ray.direction, plane->normal);
      if (slope != 0 && !is_left(piece)) visit({glm::dot(plane->point - ray.origin, plane->normal) / slope, piece});
    } else if (const auto* triangle = std::get_if<Triangle>(&geometry)) {
      visit_triangle(corners_of(*triangle), piece);
    } else if (const auto* mesh = std::get_if<Mesh>(&geometry)) {
      for (uint32_t primitive = 0; primitive < mesh->triangles.size(); ++primitive)
        visit_triangle(corners_of(*mesh, primitive), {shape, primitive});
    }
  }
}

glm::dvec3 front_normal(const Scene& scene, Piece piece, const glm::dvec3& position) {
  const auto& geometry = scene.shapes[piece.shape].geometry;
  if (const auto* sphere = std::get_if<Sphere>(&geometry)) return glm::normalize(position - sphere->centre);
  if (const auto* plane = std::get_if<Plane>(&geometry)) return plane->normal;
  const auto* mesh = std::get_if<Mesh>(&geometry);
  const Corners corners = mesh ? corners_of(*mesh, piece.primitive) : corners_of(std::get<Triangle>(geometry));
  return glm::normalize(glm::cross(corners.b - corners.a, corners.c - corners.a));
}

uint32_t material_of(const Scene& scene, Piece piece) {
  const Shape& shape = scene.shapes[piece.shape];
  const auto* mesh = std::get_if<Mesh>(&shape.geometry);
  return mesh ? mesh->materials[piece.primitive] : shape.material;
}

bool is_glass(const Scene& scene, Piece piece) {
  return scene.materials[material_of(scene, piece)].surface == Surface::dielectric;
}

// Interpolated from three values of a mesh; none where the mesh or the triangle has no such values.
template <typename Value>
std::optional<Value> interpolated(const auto& values, const std::vector<glm::uvec3>& indices, const Candidate& at) {
  if (indices.empty() || indices[at.piece.primitive].x == none) return std::nullopt;
  const glm::uvec3 index = indices[at.piece.primitive];
  return (1 - at.u - at.v) * Value(values[index.x]) + at.u * Value(values[index.y]) + at.v * Value(values[index.z]);
}

Hit described(const Scene& scene, const Ray& ray, const Candidate& at) {
  const Shape& shape = scene.shapes[at.piece.shape];
  Hit hit;
  hit.t = std::max(at.t, 0.0);
  hit.piece = at.piece;
  hit.material = material_of(scene, at.piece);
  hit.position = ray.origin + hit.t * ray.direction;
  if (const auto* sphere = std::get_if<Sphere>(&shape.geometry))
    hit.position = sphere->centre + sphere->radius * glm::normalize(hit.position - sphere->centre);
  hit.geometric_normal = hit.shading_normal = front_normal(scene, at.piece, hit.position);
  hit.from_front = glm::dot(ray.direction, hit.geometric_normal) < 0;

  if (std::holds_alternative<Sphere>(shape.geometry)) {
    const glm::dvec3& n = hit.geometric_normal;
    hit.texcoord = glm::dvec2(0.5 + std::atan2(-n.z, n.x) / (2 * std::numbers::pi),
                              0.5 + std::asin(std::clamp(n.y, -1.0, 1.0)) / std::numbers::pi);
  } else if (const auto* plane = std::get_if<Plane>(&shape.geometry)) {
    const glm::dvec3 from_point = hit.position - plane->point;
    hit.texcoord = glm::dvec2(glm::dot(from_point, plane->texture_u), glm::dot(from_point, plane->texture_v));
  } else if (const auto* triangle = std::get_if<Triangle>(&shape.geometry)) {
    hit.texcoord = (1 - at.u - at.v) * triangle->uv_a + at.u * triangle->uv_b + at.v * triangle->uv_c;
  } else if (const auto* mesh = std::get_if<Mesh>(&shape.geometry)) {
    hit.texcoord = interpolated<glm::dvec2>(mesh->texcoords, mesh->texcoord_indices, at);
    if (const auto normal = interpolated<glm::dvec3>(mesh->normals, mesh->normal_indices, at)) {
      hit.shading_normal = glm::normalize(*normal);
      if (glm::dot(hit.shading_normal, hit.geometric_normal) < 0) hit.shading_normal = -hit.shading_normal;
    }
  }
  return hit;
}

double largest(const glm::dvec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

// Distance under which two places along a ray are the same, for coordinates of the given size [m].
double coincidence(double size) { return 1e-10 * std::max(1.0, size); }

}  // namespace

std::optional<Hit> closest_hit(const Scene& scene, const Ray& ray) {
  // At the origin of a ray that leaves a surface lie that piece's neighbours, by a rounding ahead or behind.
  const double here = coincidence(largest(ray.origin));
  std::vector<Candidate> ahead;
  for_each_on_line(scene, ray, [&](const Candidate& candidate) {
    const bool is_contact = ray.from_contact && !is_glass(scene, candidate.piece);
    if (candidate.t > (is_contact ? -here : ray.left.empty() ? 0 : here)) ahead.push_back(candidate);
  });
  if (ahead.empty()) return std::nullopt;

  double nearest = ahead.front().t;
  for (const Candidate& candidate : ahead) nearest = std::min(nearest, candidate.t);
  const double same = nearest + coincidence(std::max(nearest, largest(ray.origin)));
  std::erase_if(ahead, [&](const Candidate& candidate) { return candidate.t > same; });
  const Candidate first = *std::min_element(
      ahead.begin(), ahead.end(), [](const Candidate& p, const Candidate& q) { return p.piece < q.piece; });

  Hit hit = described(scene, ray, first);
  std::set<std::tuple<uint32_t, uint32_t, bool>> bodies;
  for (const Candidate& candidate : ahead) {
    hit.coincident.push_back(candidate.piece);
    if (!is_glass(scene, candidate.piece)) continue;
    hit.glass.push_back(candidate.piece);
    const bool entering = glm::dot(ray.direction, front_normal(scene, candidate.piece, hit.position)) < 0;
    // A set, so that both sides of a shared edge count once.
    bodies.insert({candidate.piece.shape, material_of(scene, candidate.piece), entering});
  }
  for (const auto& [shape, material, entering] : bodies) hit.passages.push_back({material, entering});
  return hit;
}

bool is_occluded(const Scene& scene, const Ray& ray, double distance) {
  const double least = coincidence(largest(ray.origin));
  bool occluded = false;
  for_each_on_line(scene, ray, [&](const Candidate& candidate) {
    occluded = occluded || (candidate.t > least && candidate.t < distance - least);
  });
  return occluded;
}

Media media_at(const Scene& scene, const glm::dvec3& point) {
  Media media;
  for (const Shape& shape : scene.shapes) {
    std::map<uint32_t, double> winding;     // of each material
    if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
      winding[shape.material] = glm::distance(point, sphere->centre) < sphere->radius ? 1 : 0;
    } else if (const auto* plane = std::get_if<Plane>(&shape.geometry)) {
      winding[shape.material] = glm::dot(point - plane->point, plane->normal) < 0 ? 1 : 0;
    } else if (const auto* mesh = std::get_if<Mesh>(&shape.geometry)) {
      for (uint32_t primitive = 0; primitive < mesh->triangles.size(); ++primitive) {
        // Solid angle of a triangle (Van Oosterom and Strackee 1983).
        const Corners corners = corners_of(*mesh, primitive);
        const glm::dvec3 a = corners.a - point, b = corners.b - point, c = corners.c - point;
        const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
        const double solid_angle = 2 * std::atan2(glm::dot(a, glm::cross(b, c)),
                                                  la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la +
                                                      glm::dot(c, a) * lb);
        winding[mesh->materials[primitive]] += solid_angle / (4 * std::numbers::pi);
      }
    }
    for (const auto& [material, turns] : winding)
      if (turns > 0.5 && scene.materials[material].surface == Surface::dielectric) media.push_back(material);
  }
  std::reverse(media.begin(), media.end());
  return media;
}

}  // namespace vitrum::reference
