// Footprints of photons by themselves, and gathering them against every entry of the map looked at, in double.
#include <doctest/doctest.h>

#include <functional>
#include <optional>
#include <random>
#include <set>

#include "verify/gatherer.hpp"
#include "verify/photon_run.hpp"
#include "verify/scenes.hpp"

using namespace vitrum;
using glm::dmat2;
using glm::dvec2;
using glm::dvec3;

namespace {

/// Columns and rows of the lattice, a multiple of every width together.
constexpr uint32_t columns = 6, log2_rows = 3, rows = 1u << log2_rows, points = columns * rows;

/// Where a point of the lattice arrived, in the receiver's plane [m] and off it, and the hash of its way.
struct Landing {
  dvec2 place{0};
  double height = 0;
  uint32_t way = 1;
};

/// A footprint's sides in the receiver's plane [m]; none: that of a photon alone, a square in whatever directions.
using Sides = std::optional<dmat2>;

/// The receiver: a plane askew.
const dvec3 normal = glm::normalize(dvec3(0.4, -0.5, -0.7));
const dvec3 axis_x = glm::normalize(glm::cross(normal, dvec3(0, 1, 0))), axis_y = glm::cross(normal, axis_x);

dvec3 in_space(const dvec2& p, double height = 0) { return p.x * axis_x + p.y * axis_y + height * normal; }

kernel::FootprintLimits limits_of(float largest, float sharpness = 0) { return {{0, 0, 3}, sharpness, largest}; }

/// kernels/footprint.h at one width.
class FootprintKernel {
 public:
  explicit FootprintKernel(unsigned width) : device_("", 32, width) {
    Features features;
    features.caustics = features.footprints = true;
    kernel_ = cl::Kernel(device_.build("checks/footprint.cl", kernel_source({}, {"checks/footprint.cl"}),
                                       "-cl-std=CL1.2" + features.build_options()),
                         "footprints");
  }

  /// Fields as checks/footprint.cl writes them, of the photon of each point; not `on_lattice`, of photons there that have
  /// no neighbours.
  std::vector<float> operator()(const std::vector<Landing>& landings, const kernel::FootprintLimits& limits,
                                bool on_lattice, float spacing) {
    std::vector<float> arrived, in(8 * points);
    for (uint32_t i = 0; i < points; ++i) {
      const glm::vec3 place = in_space(landings[i].place, landings[i].height), n = normal;
      arrived.insert(arrived.end(), {place.x, place.y, place.z, std::bit_cast<float>(landings[i].way), 0, 0, 0, 0});
      const auto point = std::bit_cast<float>(on_lattice ? i : NO_POINT);
      const float fields[] = {point, spacing, place.x, place.y, place.z, n.x, n.y, n.z};
      for (size_t field = 0; field < 8; ++field) in[field * points + i] = fields[field];
    }
    const auto out = device_.allocate<float>(16 * points, "test outputs");
    const auto from = device_.upload(in, "test inputs"), landed = device_.upload(arrived, "test inputs");
    set_arguments(kernel_, 0, kernel::LatticeData{columns, log2_rows, 0.5f, 0.5f}, limits, landed, from, out, points);
    device_.launch("test", kernel_, points / device_.width());
    return device_.read(out, 0, out.size());
  }

 private:
  Device device_;
  cl::Kernel kernel_;
};

/// What is asked of all widths.
struct Expected {
  std::function<Sides(uint32_t column, uint32_t row)> sides;
  double alone = 0;             ///< side of the square [m]
};

/// Sides, area, parts and tents at every point and every width.
void check(const std::vector<Landing>& landings, const kernel::FootprintLimits& limits, const Expected& expected,
           bool on_lattice = true, float spacing = 1) {
  static FootprintKernel kernels[] = {FootprintKernel(1), FootprintKernel(4), FootprintKernel(8), FootprintKernel(16)};
  const auto largest = static_cast<double>(limits.largest);
  for (FootprintKernel& kernel : kernels) {
    const std::vector<float> out = kernel(landings, limits, on_lattice, spacing);
    double worst = 0;
    for (uint32_t i = 0; i < points; ++i) {
      const auto field = [&](size_t f) { return static_cast<double>(out[f * points + i]); };
      const auto vector = [&](size_t f) { return dvec3(field(f), field(f + 1), field(f + 2)); };
      const auto in_plane = [](const dvec3& v) { return dvec2(glm::dot(v, axis_x), glm::dot(v, axis_y)); };
      const dvec3 u = vector(0), v = vector(3), across_u = vector(6), across_v = vector(9);
      const dmat2 found(in_plane(u), in_plane(v));
      const Sides sides = expected.sides(i / rows, i % rows);
      // Alone, any square.
      const dmat2 truth = sides.value_or(found);
      const auto apart = [&](double a, double b, double scale) { worst = std::max(worst, std::abs(a - b) / scale); };
      const double longest = std::max(glm::length(truth[0]), glm::length(truth[1]));
      const double area = std::abs(glm::determinant(truth));
      if (!sides) {
        apart(glm::length(u), expected.alone, expected.alone);
        apart(area, expected.alone * expected.alone, area);
      }
      for (int k = 0; k < 2; ++k) apart(glm::length(found[k] - truth[k]), 0, longest);
      apart(glm::dot(u, normal), 0, longest);
      apart(glm::dot(v, normal), 0, longest);
      apart(field(12), area, area);
      // Few parts, or of large ones as few as they are.
      const auto parts = [&](int k, double most) {
        return std::max(std::ceil(glm::length(truth[k]) / most - 0.001), 1.0);
      };
      uint32_t level = 0;
      double most = largest;
      for (; level + 1 < LEVELS && parts(0, most) * parts(1, most) > 4; ++level) most *= 4;
      const double parts_u = parts(0, most), parts_v = parts(1, most);
      apart(field(13), parts_u, 1);
      apart(field(14), parts_v, 1);
      apart(field(15), level, 1);
      // From the middle of a part to that of the next, its tent falls to 0.
      const double aspect = longest * longest / area;
      apart(glm::dot(across_u, u), parts_u, parts_u * aspect);
      apart(glm::dot(across_v, v), parts_v, parts_v * aspect);
      apart(glm::dot(across_u, v), 0, parts_u * aspect);
      apart(glm::dot(across_v, u), 0, parts_v * aspect);
    }
    // Places of about 1 m are floats, sides at least .01 m long.
    CHECK(worst < 3e-5);
  }
}

std::vector<Landing> landed(const std::function<Landing(uint32_t column, uint32_t row)>& at) {
  std::vector<Landing> landings;
  for (uint32_t i = 0; i < points; ++i) landings.push_back(at(i / rows, i % rows));
  return landings;
}

dmat2 turned(double angle) { return {std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle)}; }

/// A matrix by its singular values.
dmat2 with_axes(double turn, double first, double second, double other_turn) {
  return turned(turn) * dmat2(first, 0, 0, second) * turned(other_turn);
}

bool at_edge(uint32_t column, uint32_t row) {
  return column == 0 || column + 1 == columns || row == 0 || row + 1 == rows;
}

}  // namespace

TEST_CASE("footprints: where an affine map carries the lattice, their sides are its matrix") {
  for (const dmat2& m : {dmat2(0.03, 0, 0, 0.02), dmat2(0.02, 0.05, 0.04, -0.01), dmat2(-0.06, 0.03, 0.03, 0.02)})
    for (const float largest : {0.1f, 0.023f, 0.005f, 0.001f}) {  // whole, cut, cut and of higher levels
      const auto at = [&](uint32_t c, uint32_t r) { return Landing{m * dvec2(c, r)}; };
      check(landed(at), limits_of(largest), {[&](uint32_t, uint32_t) { return m; }});
    }
}

TEST_CASE("footprints: neighbours that went another way do not count, however near they are") {
  const dmat2 matrix[] = {{0.05, 0.02, -0.01, 0.04}, {0.004, -0.002, 0.001, 0.005}};
  const auto way = [](uint32_t c, uint32_t r) { return (7 * c * c + 5 * r * r + 3 * c * r) / 4 % 2; };
  const auto at = [&](uint32_t c, uint32_t r) { return Landing{matrix[way(c, r)] * dvec2(c, r), 0, 7 + way(c, r)}; };
  size_t lone = 0, torn = 0;
  const auto sides = [&](uint32_t c, uint32_t r) -> Sides {
    const auto same = [&](uint32_t c2, uint32_t r2) { return c2 < columns && r2 < rows && way(c2, r2) == way(c, r); };
    const int along_u = same(c + 1, r) + same(c - 1, r), along_v = same(c, r + 1) + same(c, r - 1);
    lone += along_u * along_v == 0;
    torn += along_u * along_v == 1;
    return along_u * along_v > 0 ? Sides(matrix[way(c, r)]) : Sides();
  };
  check(landed(at), limits_of(0.1f), {sides, 0.4});
  CHECK(lone > 4 * 4);
  CHECK(torn > 4 * 8);
}

TEST_CASE("footprints: where neighbours lie about as far, sides are their mean, else those to the nearer") {
  SUBCASE("a tear across the columns and one across the rows") {
    const dmat2 m(0.03, 0.01, -0.01, 0.02);
    const auto at = [&](uint32_t c, uint32_t r) {
      return Landing{m * dvec2(c, r) + (c < 3 ? dvec2(0) : dvec2(0.3, 0.1)) + (r < 5 ? dvec2(0) : dvec2(-0.1, 0.4))};
    };
    check(landed(at), limits_of(0.1f), {[&](uint32_t, uint32_t) { return m; }});
  }
  SUBCASE("columns ever farther apart") {
    const auto at = [](uint32_t c, uint32_t r) { return Landing{{0.01 * c * c, 0.02 * r}}; };
    const auto sides = [](uint32_t c, uint32_t) {
      constexpr double u[columns] = {1, 1, 4, 6, 8, 9};  // the second's neighbours are 1 and 3 away
      return dmat2(0.01 * u[c], 0, 0, 0.02);
    };
    check(landed(at), limits_of(0.1f), {sides});
  }
}

TEST_CASE("footprints: neighbours that lie more than 30 degrees off the plane do not count") {
  const dmat2 m(0.05, 0, 0, 0.04);
  for (const bool by_row : {false, true})
    for (const double degrees : {-31, -29, 29, 31}) {
      CAPTURE(by_row);
      CAPTURE(degrees);
      const double slope = std::tan(degrees / 180 * std::numbers::pi);
      const auto at = [&](uint32_t c, uint32_t r) {
        return Landing{m * dvec2(c, r), slope * (by_row ? m[1][1] * r : m[0][0] * c)};
      };
      const Sides sides = std::abs(degrees) < 30 ? Sides(m) : Sides();
      check(landed(at), limits_of(0.1f), {[&](uint32_t, uint32_t) { return sides; }, 0.4});
    }
}

TEST_CASE("footprints: who is alone on his way spreads over a square, the wider the rarer he is") {
  const auto at = [](uint32_t c, uint32_t r) { return Landing{{0.01 * c, 0.01 * r}, 0, 1 + c * rows + r}; };
  const auto nobody = [](uint32_t, uint32_t) { return Sides(); };
  for (const auto& [spacing, side] : {std::pair{1.0f, 4.0}, {6.0f, 6.0}, {20.0f, 8.0}})
    check(landed(at), limits_of(0.125f), {nobody, 0.125 * side}, true, spacing);
  for (const auto& [spacing, side] : {std::pair{1.0f, 1.0}, {3.0f, 3.0}, {20.0f, 8.0}})
    check(landed(at), limits_of(0.125f), {nobody, 0.125 * side}, false, spacing);
}

TEST_CASE("footprints: their axes have a least and a largest length, and at an edge a least ratio") {
  const struct {
    double first, second;       // axes of the map
    float largest, sharpness;
  } cases[] = {{0.05, 0.01, 0.1f, 0.01f},      // the short one grows to what lies between samples,
               {0.05, -0.01, 0.1f, 0.01f},     // also where the map mirrors
               {0.002, 0.001, 0.1f, 0.01f},    // both do,
               {0.002, 0.001, 0.1f, 1.0f},     // but not beyond the largest
               {0.05, 0.00001, 0.1f, 0.0f},    // an eye close by: a thousandth of the largest
               {0.05, 0.002, 0.1f, 0.0f},      // at an edge, an eighth of the long one
               {0.2, 0.03, 0.0005f, 0.0f},     // the long one is cut,
               {0.2, -0.1, 0.0005f, 0.0f}};    // both are
  for (const auto& c : cases)
    // By the last angle, the last point of a column lies about where the first of the next does.
    for (const double other_turn : {0.4, 2.0, -std::atan(1.0 / (rows - 1))}) {
      CAPTURE(c.first);
      CAPTURE(c.second);
      CAPTURE(other_turn);
      const kernel::FootprintLimits limits = limits_of(c.largest, c.sharpness);
      const dmat2 m = with_axes(0.7, c.first, c.second, other_turn);
      const auto sides = [&](uint32_t column, uint32_t row) {
        const double largest = static_cast<double>(c.largest);
        const double distance = glm::distance(in_space(m * dvec2(column, row)), dvec3(0, 0, 3));
        const double sample = static_cast<double>(c.sharpness) * distance;
        const double least = std::max(std::min(sample, largest), 0.001 * largest);
        const double first = std::max(std::min(c.first, 128 * largest), least);
        const double least_second = at_edge(column, row) ? std::max(least, first / 8) : least;
        const double second = std::max(std::min(std::abs(c.second), 128 * largest), least_second);
        return with_axes(0.7, first, c.second < 0 ? -second : second, other_turn);
      };
      check(landed([&](uint32_t column, uint32_t row) { return Landing{m * dvec2(column, row)}; }), limits, {sides});
    }
  // All in one place, 3 m from the eye.
  check(landed([](uint32_t, uint32_t) { return Landing{}; }), limits_of(0.1f, 0.01f),
        {[](uint32_t, uint32_t) { return Sides(); }, 0.03});
}

namespace {

/// An entry of the photon map (kernels/photon_map.h).
struct Entry {
  dvec3 place, power, across[2];
  glm::ivec3 direction;
  uint32_t cell = 0, level = 0;
  bool in_own_cell = false;
};

std::vector<Entry> entries_of(Device& device, const PhotonMap& map) {
  const auto buckets = device.read(map.buckets, 0, map.bucket_counts.size());
  const uint32_t cells_of_bucket = 1u << map.grid.bucket_shift;
  const auto firsts = device.read(map.first_of_cell, 0, (size_t{cells_of_bucket} + 1) * buckets.size());
  std::vector<Entry> entries;
  for (uint32_t b = 0; b < buckets.size(); ++b) {
    const std::vector<float> fields = device.read(map.photons, size_t{buckets[b].start} * MAP_BLOCK,
                                                  kernel::map_floats(map.bucket_counts[b], map.fields));
    for (uint32_t cell = b << map.grid.bucket_shift; cell < (b + 1) << map.grid.bucket_shift; ++cell)
      for (uint32_t i = firsts[cell + b]; i < firsts[cell + b + 1]; ++i) {
        const auto value = [&](uint32_t field) { return fields[kernel::map_place(i, field, map.fields)]; };
        const auto vector = [&](uint32_t field) {
          return dvec3(glm::vec3(value(field), value(field + 1), value(field + 2)));
        };
        const auto bits = std::bit_cast<int32_t>(value(PHOTON_DIRECTION));
        const auto flags = std::bit_cast<uint32_t>(value(FOOTPRINT_FLAGS));
        entries.push_back({vector(PHOTON_X), vector(PHOTON_POWER), {vector(FOOTPRINT_U), vector(FOOTPRINT_V)},
                           {bits << 22 >> 22, bits << 12 >> 22, bits << 2 >> 22}, cell,
                           flags & ~IN_OTHER_CELL, (flags & IN_OTHER_CELL) == 0});
      }
  }
  return entries;
}

}  // namespace

TEST_CASE("footprints: what is gathered is the sum over all that cover a place, whatever else its cells list") {
  Scene scene = ball_over_plane(1.5, Spectrum(0.0), 4.0);
  // Askew, so that it crosses cells along each axis; in the corner, what belongs to the one plane is near the other.
  const Plane planes[] = {{{0, -2, 0}, glm::normalize(dvec3(0.4, 1, 0.3)), {}, {}}, {{1.4, 0, 0}, {-1, 0, 0}, {}, {}}};
  scene.shapes[1].geometry = planes[0];
  add(scene, planes[1], 1);
  scene.photons.estimate = PhotonEstimate::footprints;
  scene.photons.nearest = 8;
  Device device;
  constexpr uint32_t count = 512;
  PhotonRun run(scene, device);
  run.run(0, 0, 0, count);
  const PhotonMap& map = run.map();
  const std::vector<Entry> entries = entries_of(device, map);
  REQUIRE(entries.size() == map.count);

  // What this is about: cells that list footprints of more than one level.
  std::set<uint32_t> cells[LEVELS];
  for (const Entry& entry : entries) cells[entry.level].insert(entry.cell);
  size_t shared = 0;
  for (size_t level = 0; level < LEVELS; ++level)
    for (const uint32_t cell : cells[level])
      shared += std::any_of(cells, cells + level, [cell](const std::set<uint32_t>& below) { return below.contains(cell); });
  CHECK(shared > 50);

  std::mt19937 bits(3);
  const auto between = [&bits](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(bits);
  };
  std::vector<Query> queries;
  for (int i = 0; i < 6000; ++i) {
    const dvec3 place(between(-1.4, 1.4), between(-2.5, -1), between(-1.4, 1.4));
    const Plane& plane = planes[i % 2];
    // On a plane, or about it and askew.
    const double off = i % 3 == 0 ? between(-0.02, 0.02) : 0.0;
    const dvec3 turned = plane.normal + (i % 3 == 0 ? 0.5 * place : dvec3(0));
    const double height = glm::dot(place - plane.point, plane.normal);
    queries.push_back({place + (off - height) * plane.normal, glm::normalize(turned)});
  }
  const PlacedQueries placed = placed_queries(device, queries);
  cl::Kernel kernel = gather_kernel(device, {}, scene_features(scene));
  gather(device, kernel, map, scene, placed);
  const std::vector<glm::vec3> found = irradiance_of(device, placed);

  constexpr double u = 0x1p-24;
  const double most_off_plane = 0.125 * static_cast<double>(map.radius);
  size_t wrong = 0, lit = 0, in_doubt = 0;
  for (size_t i = 0; i < queries.size(); ++i) {
    const dvec3 n(queries[i].normal);
    double sum = 0, error = 0;
    bool doubtful = false;
    for (const Entry& entry : entries) {
      const dvec3 d = entry.place - dvec3(queries[i].position);
      double tent[2], rounding[2];
      for (int k = 0; k < 2; ++k) {
        tent[k] = 1 - std::abs(glm::dot(d, entry.across[k]));
        // Three products and as many sums.
        rounding[k] = 4 * u * (1 + glm::dot(glm::abs(d), glm::abs(entry.across[k])));
      }
      if (!entry.in_own_cell || tent[0] < -rounding[0] || tent[1] < -rounding[1]) continue;
      const double along = glm::dot(dvec3(entry.direction), n);
      // Of the place and of the footprint.
      const dvec3 own = glm::normalize(glm::cross(entry.across[0], entry.across[1]));
      const double off_plane = std::max(std::abs(glm::dot(d, n)), std::abs(glm::dot(d, own)));
      doubtful |= std::abs(along) < 1e-4 || std::abs(off_plane / most_off_plane - 1) < 1e-4;
      if (along >= 0 || off_plane > most_off_plane) continue;
      sum += std::max(tent[0], 0.0) * std::max(tent[1], 0.0) * entry.power.x;
      error += (rounding[0] + rounding[1] + 8 * u) * entry.power.x;
    }
    in_doubt += doubtful;
    lit += sum > 0;
    wrong += !doubtful && !(std::abs(static_cast<double>(found[i].x) - sum) <= error);
  }
  CHECK(wrong == 0);
  CHECK(in_doubt < 60);
  CHECK(lit > 1000);
}
