#include "scene/triangulate.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

using namespace vitrum;

namespace {

/// Newell's area vector, twice the area.
glm::dvec3 newell(const std::vector<glm::vec3>& polygon) {
  glm::dvec3 sum(0.0);
  for (size_t i = 0; i < polygon.size(); ++i) {
    sum += glm::cross(glm::dvec3(polygon[i]), glm::dvec3(polygon[(i + 1) % polygon.size()]));
  }
  return sum;
}

struct Cut {
  bool is_simple;
  std::vector<glm::uvec3> triangles;
  double area = 0;        // of all triangles, overlaps counted twice
  bool all_face_alike = true;
};

Cut cut(const std::vector<glm::vec3>& polygon) {
  Cut result;
  result.is_simple = triangulate(polygon, result.triangles);
  const glm::dvec3 normal = newell(polygon);
  for (const glm::uvec3& t : result.triangles) {
    const glm::dvec3 a(polygon[t.x]), b(polygon[t.y]), c(polygon[t.z]);
    const glm::dvec3 twice = glm::cross(b - a, c - a);
    result.area += glm::length(twice) / 2;
    result.all_face_alike = result.all_face_alike && glm::dot(twice, normal) > 0;
  }
  return result;
}

/// A sound cut: no overlap, nothing lost.
void check_exact_cover(const std::vector<glm::vec3>& polygon, double tolerance = 1e-12) {
  const Cut result = cut(polygon);
  const double area = glm::length(newell(polygon)) / 2;
  CHECK(result.is_simple);
  CHECK(result.all_face_alike);
  CHECK(std::abs(result.area / area - 1) < tolerance);
}

/// The same, with every corner a corner of triangles, also those on straight edges: no T-junctions.
void check_exact_cover_of_distinct_corners(const std::vector<glm::vec3>& polygon) {
  check_exact_cover(polygon);
  CHECK(cut(polygon).triangles.size() == polygon.size() - 2);
}

std::vector<glm::vec3> flat(const std::vector<glm::vec2>& points) {
  std::vector<glm::vec3> polygon;
  for (const glm::vec2& p : points) polygon.emplace_back(p.x, p.y, 0.0f);
  return polygon;
}

}  // namespace

TEST_CASE("a triangle is itself, and one without area is nothing") {
  CHECK(cut(flat({{0, 0}, {1, 0}, {0, 1}})).triangles == std::vector<glm::uvec3>{{0, 1, 2}});
  CHECK(cut(flat({{0, 0}, {1, 1}, {2, 2}})).triangles.empty());
  CHECK(cut({{.1f, .2f, .3f}, {.2f, .4f, .6f}, {.4f, .8f, 1.2f}}).triangles.empty());
  CHECK(cut(flat({{0, 0}, {0, 0}, {2, 2}})).triangles.empty());
  CHECK(has_area({1e38f, 0, 0}, {0, 1e38f, 0}, {0, 0, 1e38f}));
  CHECK(has_area({0, 0, 0}, {1e-30f, 0, 0}, {0, 1e-30f, 0}));
}

TEST_CASE("a quadrilateral is cut along the shorter diagonal inside it") {
  CHECK(cut(flat({{0, 0}, {4, 0}, {5, 1}, {1, 1}})).triangles == std::vector<glm::uvec3>{{0, 1, 3}, {1, 2, 3}});
  // Arrowheads, the notch at each corner in turn.
  const std::vector<glm::vec2> arrow{{0, 0}, {4, 2}, {0, 4}, {1, 2}};
  for (int shift = 0; shift < 4; ++shift) {
    std::vector<glm::vec2> turned;
    for (int i = 0; i < 4; ++i) turned.push_back(arrow[static_cast<size_t>((i + shift) % 4)]);
    check_exact_cover(flat(turned));
  }
  // A corner on a straight edge, and one given twice.
  check_exact_cover(flat({{0, 0}, {1, 0}, {2, 0}, {0, 2}}));
  check_exact_cover(flat({{0, 0}, {2, 0}, {2, 0}, {0, 2}}));
}

TEST_CASE("stars lose no area") {
  for (const int points : {5, 16, 1001}) {
    std::vector<glm::vec3> star;
    for (int i = 0; i < 2 * points; ++i) {
      const double angle = std::numbers::pi * i / points, radius = i % 2 ? .4 : 1;
      star.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
    }
    check_exact_cover(star);
    CHECK(cut(star).triangles.size() == static_cast<size_t>(2 * points - 2));
  }
}

TEST_CASE("random polygons in random planes are covered exactly") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int round = 0; round < 300; ++round) {
    const glm::dvec3 u = glm::normalize(glm::dvec3(unit(random), unit(random), unit(random)) - .5);
    const glm::dvec3 v = glm::normalize(glm::cross(u, glm::dvec3(unit(random), unit(random), unit(random)) - .5));
    const int corners = 4 + static_cast<int>(unit(random) * 60);
    std::vector<glm::vec3> polygon;
    for (int i = 0; i < corners; ++i) {
      const double angle = 2 * std::numbers::pi * i / corners, radius = .05 + unit(random);
      polygon.push_back(glm::vec3(radius * (std::cos(angle) * u + std::sin(angle) * v) + glm::dvec3(3, -2, 1)));
    }
    // Rounding to floats bends the plane a little.
    check_exact_cover(polygon, 1e-6);
  }
}

TEST_CASE("polygons on a grid, full of straight corners, are covered exactly") {
  // Skylines with steps of random height and corners on all straight edges.
  std::mt19937 random(8);
  for (int round = 0; round < 100; ++round) {
    std::vector<glm::vec2> outline;
    constexpr int width = 12;
    for (int x = 0; x <= width; ++x) outline.emplace_back(x, 0);
    int height = 0;
    for (int x = width; x > 0; --x) {
      const int next = 1 + static_cast<int>(random() % 5);
      for (int y = height; y != next; y += next > y ? 1 : -1) {
        if (y != 0 || x != width) outline.emplace_back(x, y);
      }
      outline.emplace_back(x, next);
      height = next;
    }
    for (int y = height; y > 0; --y) outline.emplace_back(0, y);
    check_exact_cover_of_distinct_corners(flat(outline));
    for (glm::vec2& p : outline) p = {p.y, -p.x};
    check_exact_cover_of_distinct_corners(flat(outline));
  }
}

TEST_CASE("corners on straight edges are not cut away, whichever corner is tried first") {
  std::vector<glm::vec2> triangle{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {2, 1}, {1, 2}, {0, 3}, {0, 2}, {0, 1}};
  for (size_t shift = 0; shift < triangle.size(); ++shift) {
    std::rotate(triangle.begin(), triangle.begin() + 1, triangle.end());
    check_exact_cover_of_distinct_corners(flat(triangle));
  }
  // An apex over a straight base, which would leave three corners on a line.
  for (const bool upright : {false, true}) {
    std::vector<glm::vec2> tent{{2, 3}, {0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}};
    for (glm::vec2& p : tent) p = upright ? glm::vec2(-p.y, p.x) : p;
    check_exact_cover_of_distinct_corners(flat(tent));
    for (glm::vec2& p : tent) p = -p;
    check_exact_cover_of_distinct_corners(flat(tent));
  }
}

TEST_CASE("bridged holes stay holes") {
  SUBCASE("one hole, bridged from a corner") {
    const auto frame = flat({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}});
    check_exact_cover(frame);
    CHECK(cut(frame).area == doctest::Approx(12));
  }
  SUBCASE("two holes, bridged from the same corner") {
    const auto plate = flat({{0, 0}, {9, 0}, {9, 9}, {0, 9}, {0, 0}, {1, 4}, {1, 6}, {3, 6}, {3, 4}, {1, 4},
                             {0, 0}, {4, 1}, {4, 3}, {6, 3}, {6, 1}, {4, 1}});
    check_exact_cover(plate);
    CHECK(cut(plate).area == doctest::Approx(81 - 8));
  }
  // Corners where a bridge ends come twice, and here no ear is free of them.
  SUBCASE("two holes, bridged from opposite corners") {
    const auto plate = flat({{0, 0}, {12, 0}, {6, 4}, {2, 2}, {1, 2}, {6, 4}, {12, 0}, {12, 12}, {2, 9}, {3, 9}, {7, 4},
                             {2, 9}, {12, 12}, {0, 12}});
    check_exact_cover(plate);
    CHECK(cut(plate).area == doctest::Approx(144 - 1 - 2.5));
  }
  SUBCASE("two holes, the second bridged from where the bridge to the first ends") {
    const auto plate = flat({{0, 0}, {24, 0}, {11, 10}, {8, 3}, {7, 1}, {11, 10}, {5, 5}, {7, 10}, {6, 6}, {5, 5},
                             {11, 10}, {24, 0}, {0, 24}});
    check_exact_cover(plate);
    CHECK(cut(plate).area == doctest::Approx(288 - 0.5 - 1.5));
  }
  SUBCASE("a chain of holes, each bridged from the one before") {
    std::vector<glm::vec2> plate{{0, 2}, {0, 0}, {40, 0}, {40, 4}, {0, 4}, {0, 2}};
    constexpr int holes = 9;
    // Forth over the upper halves of the diamonds, back over the lower ones.
    for (int i = 0; i < holes; ++i) plate.insert(plate.end(), {{1 + 4 * i, 2}, {2 + 4 * i, 3}, {3 + 4 * i, 2}});
    plate.pop_back();
    for (int i = holes - 1; i >= 0; --i) plate.insert(plate.end(), {{3 + 4 * i, 2}, {2 + 4 * i, 1}, {1 + 4 * i, 2}});
    check_exact_cover(flat(plate));
    CHECK(cut(flat(plate)).area == doctest::Approx(160 - 2 * holes));
  }
  SUBCASE("a plate with a row of round holes, bridged one by one from its border") {
    std::vector<glm::vec2> plate;
    const auto hole = [&](float x) {
      for (int i = 0; i <= 12; ++i) {
        const double angle = -std::numbers::pi / 2 - 2 * std::numbers::pi * i / 12;
        plate.emplace_back(x + static_cast<float>(.4 * std::cos(angle)), 1 + static_cast<float>(.4 * std::sin(angle)));
      }
      plate.back() = plate[plate.size() - 13];
    };
    for (int i = 0; i < 50; ++i) {
      const float x = static_cast<float>(i) + .5f;
      plate.emplace_back(x, 0);
      hole(x);
      plate.emplace_back(x, 0);
    }
    plate.insert(plate.end(), {{50, 0}, {50, 2}, {0, 2}, {0, 0}});
    check_exact_cover(flat(plate));
  }
}

TEST_CASE("a convex polygon is not cut into a fan of slivers") {
  std::vector<glm::vec3> circle;
  for (int i = 0; i < 1024; ++i) {
    circle.emplace_back(std::cos(2 * std::numbers::pi * i / 1024), std::sin(2 * std::numbers::pi * i / 1024), 0);
  }
  check_exact_cover_of_distinct_corners(circle);
  std::vector<int> uses(1024);
  for (const glm::uvec3& t : cut(circle).triangles) {
    for (int i = 0; i < 3; ++i) ++uses[t[i]];
  }
  CHECK(*std::max_element(uses.begin(), uses.end()) < 25);
}

TEST_CASE("a comb, of whose corners only few are ears at a time, is covered exactly") {
  constexpr int corners = 4'000;
  std::vector<glm::vec2> comb;
  for (int i = 0; i < corners; ++i) comb.emplace_back((i + 1) / 2, i % 4 < 2 ? 100 : 0);
  comb.insert(comb.end(), {{corners / 2, -1}, {0, -1}});
  std::reverse(comb.begin(), comb.end());
  check_exact_cover_of_distinct_corners(flat(comb));
}

TEST_CASE("a polygon that crosses itself says so and keeps all edges") {
  const Cut bow_tie = cut(flat({{0, 0}, {2, 2}, {2, 0}, {0, 2}}));
  CHECK_FALSE(bow_tie.is_simple);
  CHECK(bow_tie.triangles.size() == 2);
  CHECK_FALSE(cut(flat({{0, 0}, {2, 2}, {2, 0}, {0, 3}})).is_simple);
  CHECK(cut(flat({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {1, 0}})).triangles.empty());
}

TEST_CASE("a folded quadrilateral keeps both of its faces") {
  const std::vector<glm::vec3> fold{{0, 0, 0}, {1, 0, 0}, {1, 1, .5f}, {0, 1, 0}};
  CHECK(cut(fold).triangles.size() == 2);
}
