#include "scene/triangulate.hpp"

#include <algorithm>
#include <cstdint>
#include <queue>
#include <utility>

namespace vitrum {
namespace {

glm::dvec3 area_vector(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  return glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
}

/// Twice the signed area of a triangle, positive if it runs counter-clockwise.
double orientation(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Newell's method: twice the area of the polygon's shadow on each coordinate plane.
glm::dvec3 polygon_area_vector(std::span<const glm::vec3> polygon) {
  const glm::dvec3 origin(polygon[0]);
  glm::dvec3 sum(0.0), previous(glm::dvec3(polygon.back()) - origin);
  for (const glm::vec3& vertex : polygon) {
    const glm::dvec3 current = glm::dvec3(vertex) - origin;
    sum += glm::cross(previous, current);
    previous = current;
  }
  return sum;
}

/// Ear clipping (Meisters 1975): cuts off corners that contain nothing else of the polygon, one after the other.
/// The time is about linear in the number of corners, quadratic at worst (1 s for some 30,000 corners of a comb).
class EarClipper {
 public:
  EarClipper(std::span<const glm::vec3> polygon, const glm::dvec3& normal, std::vector<glm::uvec3>& triangles)
      : polygon_(polygon), triangles_(triangles), points_(polygon.size()), ring_(polygon.size()) {
    // Leaving out a coordinate keeps the others exact, so the signs of orientations are exact too.
    const glm::dvec3 size = glm::abs(normal);
    const int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const auto count = static_cast<uint32_t>(polygon.size());
    for (uint32_t i = 0; i < count; ++i) {
      points_[i] = normal[axis] > 0 ? glm::dvec2(polygon[i][u], polygon[i][v])
                                    : glm::dvec2(polygon[i][v], polygon[i][u]);
      ring_[i] = {(i + count - 1) % count, (i + 1) % count, 0, true};
    }
    remaining_ = count;
  }

  /// False if the polygon crosses itself.
  bool run() {
    collect_blockers();
    bool is_simple = true, has_progress = true;
    uint32_t last = 0;  // a corner that is left
    while (remaining_ > 3) {
      if (waiting_.empty()) {
        // Only neighbours of a clipped corner can become ears (Eberly, Triangulation by Ear Clipping), but nothing is
        // forced before all corners were tried, unless the polygon is known to cross itself.
        if (has_progress && is_simple) {
          for (uint32_t i = 0, corner = last; i < remaining_; ++i, corner = ring_[corner].next) wait(corner);
          has_progress = false;
        } else {
          last = clip_without_ear(last, is_simple);
          has_progress = true;
        }
        continue;
      }
      const auto [corner, stamp] = waiting_.front();
      waiting_.pop();
      if (stamp != ring_[corner].stamp || !is_ear(corner)) continue;
      last = clip(corner);
      has_progress = true;
    }
    emit(ring_[last].previous, last, ring_[last].next);
    return is_simple && turn(last) >= 0;
  }

 private:
  struct Corner {
    uint32_t previous, next;
    uint32_t stamp;  // of the place in the queue that counts
    bool is_left;
  };

  /// Puts a corner at the queue's end, out of the place it may have. Neighbours of a clipped corner are moved behind
  /// all others that way, which avoids fans of slivers.
  void wait(uint32_t corner) { waiting_.emplace(corner, ++ring_[corner].stamp); }

  double turn(uint32_t i) const {
    return orientation(points_[ring_[i].previous], points_[i], points_[ring_[i].next]);
  }

  /// If any vertex lies in a corner, then also one where the border doesn't turn left. Clipping makes no new ones of
  /// these in a polygon that doesn't cross itself. They are kept in the order of x.
  void collect_blockers() {
    for (uint32_t i = 0; i < points_.size(); ++i) {
      if (turn(i) <= 0) blockers_.push_back(i);
    }
    std::sort(blockers_.begin(), blockers_.end(), [&](uint32_t a, uint32_t b) { return points_[a].x < points_[b].x; });
  }

  bool is_ear(uint32_t b) const {
    const uint32_t a = ring_[b].previous, c = ring_[b].next;
    const glm::dvec2 &pa = points_[a], &pb = points_[b], &pc = points_[c];
    if (orientation(pa, pb, pc) <= 0) return false;
    const glm::dvec2 low = glm::min(pa, glm::min(pb, pc)), high = glm::max(pa, glm::max(pb, pc));
    auto blocker = std::lower_bound(blockers_.begin(), blockers_.end(), low.x,
                                    [&](uint32_t i, double x) { return points_[i].x < x; });
    for (; blocker != blockers_.end() && points_[*blocker].x <= high.x; ++blocker) {
      const uint32_t i = *blocker;
      const glm::dvec2& p = points_[i];
      if (p.y < low.y || p.y > high.y || !ring_[i].is_left || i == a || i == b || i == c) continue;
      // Where the border comes by a corner of the ear again (the end of a bridge to a hole), the two wedges that the
      // polygon has there don't overlap, so it stays outside.
      if (p == pa || p == pb || p == pc) continue;
      if (orientation(pa, pb, p) >= 0 && orientation(pb, pc, p) >= 0 && orientation(pc, pa, p) >= 0) return false;
    }
    return true;
  }

  /// Where no corner is an ear: clips first spikes and straight corners, which cover nothing; then, in a polygon that
  /// crosses itself, any corner that doesn't turn right; then any. Returns a corner that is left.
  uint32_t clip_without_ear(uint32_t start, bool& is_simple) {
    uint32_t best = start;
    int best_rank = 3;
    const int good_rank = is_simple ? 0 : 1;
    for (uint32_t i = 0, corner = start; i < remaining_ && best_rank > good_rank; ++i, corner = ring_[corner].next) {
      const double area = turn(corner);
      const int rank = area == 0 ? 0 : area > 0 ? 1 : 2;
      if (rank < best_rank) {
        best = corner;
        best_rank = rank;
      }
    }
    is_simple = is_simple && best_rank == 0;
    return clip(best);
  }

  /// Cuts corner b off and returns the one after it.
  uint32_t clip(uint32_t b) {
    const uint32_t previous = ring_[b].previous, next = ring_[b].next;
    emit(previous, b, next);
    ring_[previous].next = next;
    ring_[next].previous = previous;
    ring_[b].is_left = false;
    ++ring_[b].stamp;
    --remaining_;
    wait(previous);
    wait(next);
    return next;
  }

  void emit(uint32_t a, uint32_t b, uint32_t c) {
    if (has_area(polygon_[a], polygon_[b], polygon_[c])) triangles_.emplace_back(a, b, c);
  }

  std::span<const glm::vec3> polygon_;
  std::vector<glm::uvec3>& triangles_;
  std::vector<glm::dvec2> points_;
  std::vector<Corner> ring_;
  std::vector<uint32_t> blockers_;
  std::queue<std::pair<uint32_t, uint32_t>> waiting_;  // corner and stamp
  uint32_t remaining_;
};

/// The better diagonal of a quadrilateral: the one whose two triangles face the same way, or the shorter of two such.
/// False where neither does.
bool cut_quadrilateral(std::span<const glm::vec3> p, std::vector<glm::uvec3>& triangles) {
  const bool even_is_sound = glm::dot(area_vector(p[0], p[1], p[2]), area_vector(p[0], p[2], p[3])) > 0;
  const bool odd_is_sound = glm::dot(area_vector(p[0], p[1], p[3]), area_vector(p[1], p[2], p[3])) > 0;
  if (!even_is_sound && !odd_is_sound) return false;
  const glm::dvec3 even = glm::dvec3(p[2]) - glm::dvec3(p[0]), odd = glm::dvec3(p[3]) - glm::dvec3(p[1]);
  if (even_is_sound && (!odd_is_sound || glm::dot(even, even) <= glm::dot(odd, odd))) {
    triangles.insert(triangles.end(), {{0, 1, 2}, {0, 2, 3}});
  } else {
    triangles.insert(triangles.end(), {{0, 1, 3}, {1, 2, 3}});
  }
  return true;
}

}  // namespace

bool has_area(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  return area_vector(a, b, c) != glm::dvec3(0.0);
}

bool triangulate(std::span<const glm::vec3> polygon, std::vector<glm::uvec3>& triangles) {
  if (polygon.size() < 3) return true;
  if (polygon.size() == 3) {
    if (has_area(polygon[0], polygon[1], polygon[2])) triangles.emplace_back(0, 1, 2);
    return true;
  }
  if (polygon.size() == 4 && cut_quadrilateral(polygon, triangles)) return true;
  const glm::dvec3 normal = polygon_area_vector(polygon);
  if (normal == glm::dvec3(0.0)) {
    // All on a line, or a figure of eight whose halves cancel: there is no inside.
    const size_t before = triangles.size();
    for (uint32_t i = 1; i + 1 < polygon.size(); ++i) {
      if (has_area(polygon[0], polygon[i], polygon[i + 1])) triangles.emplace_back(0, i, i + 1);
    }
    return triangles.size() == before;
  }
  return EarClipper(polygon, normal, triangles).run();
}

}  // namespace vitrum
