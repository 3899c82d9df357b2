// [shape.NAME]: exact shapes are brought to world space at once, meshes are left as files.

#include <algorithm>

#include "scene/sections.hpp"

namespace vitrum {
namespace {

enum class ShapeType { sphere, plane, triangle, mesh };

Sphere read_sphere(const TomlTable& table, const Transform& transform) {
  table.check_keys({"type", "centre", "radius", "material"}, {"transform"});
  Sphere sphere;
  table.vector("centre", sphere.centre, coordinate);
  table.number("radius", sphere.radius, positive_length);
  sphere.centre = transform.point(sphere.centre);
  sphere.radius *= transform.uniform_scale("a sphere");
  if (!(sphere.radius >= positive_length.low && sphere.radius <= positive_length.high))
    table.fail("radius", "is out of range after the transform", "it must be between 1e-9 and 1e9 metres");
  return sphere;
}

Plane read_plane(const TomlTable& table, const Transform& transform) {
  table.check_keys({"type", "point", "normal", "material"}, {"texture_u", "texture_v", "transform"});
  Plane plane;
  table.vector("point", plane.point, coordinate);
  table.direction("normal", plane.normal);
  table.vector("texture_u", plane.texture_u, {-1e9, 1e9});
  table.vector("texture_v", plane.texture_v, {-1e9, 1e9});
  plane.point = transform.point(plane.point);
  plane.normal = transform.normal(plane.normal);
  plane.texture_u = transform.gradient(plane.texture_u);
  plane.texture_v = transform.gradient(plane.texture_v);
  return plane;
}

Triangle read_triangle(const TomlTable& table, const Transform& transform) {
  table.check_keys({"type", "a", "b", "c", "material"}, {"uv_a", "uv_b", "uv_c", "transform"});
  Triangle triangle;
  table.vector("a", triangle.a, coordinate);
  table.vector("b", triangle.b, coordinate);
  table.vector("c", triangle.c, coordinate);
  const Range texture_coordinate{-1e6, 1e6};
  table.vector("uv_a", triangle.uv_a, texture_coordinate);
  table.vector("uv_b", triangle.uv_b, texture_coordinate);
  table.vector("uv_c", triangle.uv_c, texture_coordinate);

  triangle.a = transform.point(triangle.a);
  triangle.b = transform.point(triangle.b);
  triangle.c = transform.point(triangle.c);
  if (transform.mirrors()) {
    std::swap(triangle.b, triangle.c);
    std::swap(triangle.uv_b, triangle.uv_c);
  }
  const glm::dvec3 ab = triangle.b - triangle.a, ac = triangle.c - triangle.a, bc = triangle.c - triangle.b;
  const double longest_square = std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(bc, bc)});
  if (!(glm::length(glm::cross(ab, ac)) > 1e-9 * longest_square))
    table.fail("c", "lies on a line with a and b: the triangle has no area", "move one of its corners");
  return triangle;
}

MeshFile read_mesh_file(const TomlTable& table, const FileContext& context) {
  table.check_keys({"type", "file"}, {"material", "override", "transform"});
  std::string name;
  table.text("file", name);
  MeshFile mesh;
  mesh.path = existing_file(context, table.where("file"), table.path_of("file"), name);
  table.flag("override", mesh.override_materials);
  if (mesh.override_materials && !table.has("material"))
    table.fail("override", "wants a material to put onto every face", "give " + table.path_of("material") + " too");
  return mesh;
}

}  // namespace

std::vector<ShapeDeclaration> read_shapes(const TomlTable& root, const FileContext& context) {
  std::vector<ShapeDeclaration> shapes;
  const auto tables = root.named_tables("shape");
  check_overridden_names(tables, "shape");
  for (const auto& [name, table] : tables) {
    const auto type = table.type<ShapeType>({{"sphere", ShapeType::sphere},
                                             {"plane", ShapeType::plane},
                                             {"triangle", ShapeType::triangle},
                                             {"mesh", ShapeType::mesh}});
    ShapeDeclaration shape;
    shape.name = name;
    shape.where = table.where();
    shape.material_where = table.where("material");
    shape.transform = Transform(table, context.metres_per_unit);
    switch (type) {
      case ShapeType::sphere: shape.geometry = read_sphere(table, shape.transform); break;
      case ShapeType::plane: shape.geometry = read_plane(table, shape.transform); break;
      case ShapeType::triangle: shape.geometry = read_triangle(table, shape.transform); break;
      case ShapeType::mesh: shape.geometry = read_mesh_file(table, context); break;
    }
    shape.has_texture_axes = type != ShapeType::plane || (table.has("texture_u") && table.has("texture_v"));
    table.text("material", shape.material);
    if (table.has("material") && shape.material.empty())
      table.fail("material", "is empty", "name a material of an MTL file or of [material.NAME]");
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

}  // namespace vitrum
