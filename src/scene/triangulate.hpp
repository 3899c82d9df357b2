#pragma once
// Polygons into triangles without loss of area: a lost triangle would open a closed glass.

#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace vitrum {

/// Whether a triangle has area at all. Exact where the coordinates' exponents are within 2^28 of each other: the
/// differences and products of floats then fit a double.
bool has_area(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);

/// Appends triangles (corners of `polygon`) that cover it, running round as it does. Convex, concave, with vertices on
/// straight edges, and with holes that a bridge of two coinciding edges joins to the border. Triangles without area
/// are left out. Polygons that are not planar are judged in the plane of two axes that their normal faces most.
/// False where no sound cut exists because it crosses itself: the triangles use every edge then, but may overlap.
bool triangulate(std::span<const glm::vec3> polygon, std::vector<glm::uvec3>& triangles);

}  // namespace vitrum
