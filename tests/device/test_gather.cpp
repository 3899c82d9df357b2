// Both ways to gather photons against every photon looked at, in double.
#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>
#include <random>

#include "verify/gatherer.hpp"

using namespace vitrum;
using glm::dvec3;
using glm::vec3;

namespace {

struct Random {
  std::mt19937 bits{7};
  float between(float low, float high) { return std::uniform_real_distribution<float>(low, high)(bits); }
  vec3 in_box(vec3 low, vec3 high) {
    return {between(low.x, high.x), between(low.y, high.y), between(low.z, high.z)};
  }
  vec3 direction() {
    for (;;) {
      const vec3 v = in_box(vec3(-1), vec3(1));
      if (glm::length(v) > 0.1f && glm::length(v) < 1.0f) return glm::normalize(v);
    }
  }
};

/// A photon that came to a query's front, as the query sees it.
struct Seen {
  double distance2, off_plane;
  dvec3 power;
  /// The square of the least radius that takes it in.
  double reach2() const { return std::max(distance2, 16.0 * off_plane * off_plane); }
};

/// What brute force says; `in_doubt` where rounding may decide on a photon.
struct Answer {
  dvec3 irradiance{0};
  dvec3 rounding{0};  ///< what floats may take it off beyond a relative error
  bool in_doubt = false;
};

bool near(double a, double b) { return a != b && std::abs(a - b) < 1e-5 * std::max(std::abs(a), std::abs(b)); }

std::vector<Seen> seen_by(const Query& query, const std::vector<cl_float8>& photons, bool* in_doubt) {
  std::vector<Seen> seen;
  const dvec3 n(query.normal);
  for (const cl_float8& p : photons) {
    const int32_t bits = std::bit_cast<int32_t>(p.s[3]);
    const double along = glm::dot(dvec3(bits << 22 >> 22, bits << 12 >> 22, bits << 2 >> 22), n);
    if (along != 0.0 && std::abs(along) < 1e-4) *in_doubt = true;
    if (along >= 0.0) continue;
    const dvec3 d = dvec3(vec3(p.s[0], p.s[1], p.s[2])) - dvec3(query.position);
    seen.push_back({glm::dot(d, d), std::abs(glm::dot(d, n)), vec3(p.s[4], p.s[5], p.s[6])});
  }
  return seen;
}

Answer brute_within(const Query& query, const std::vector<cl_float8>& photons, double radius) {
  Answer answer;
  dvec3 sum(0), power(0);
  for (const Seen& s : seen_by(query, photons, &answer.in_doubt)) {
    if (s.distance2 >= radius * radius) continue;
    power += s.power;
    answer.in_doubt |= near(s.off_plane, 0.25 * radius);
    if (s.off_plane <= 0.25 * radius) sum += (1.0 - s.distance2 / (radius * radius)) * s.power;
  }
  answer.irradiance = 2.0 * sum / (std::numbers::pi * radius * radius);
  // d^2 / r^2 is off by 6 roundings at most, which counts where the weight is small.
  answer.rounding = 6 * 0x1p-24 * 2.0 * power / (std::numbers::pi * radius * radius);
  return answer;
}

Answer brute_nearest(const Query& query, const std::vector<cl_float8>& photons, size_t k, double max_radius) {
  Answer answer;
  std::vector<Seen> seen = seen_by(query, photons, &answer.in_doubt);
  double radius2 = max_radius * max_radius;
  if (seen.size() >= k) {
    const auto kth = seen.begin() + static_cast<std::ptrdiff_t>(k - 1);
    std::nth_element(seen.begin(), kth, seen.end(),
                     [](const Seen& a, const Seen& b) { return a.reach2() < b.reach2(); });
    radius2 = std::min(radius2, kth->reach2());
  }
  dvec3 sum(0);
  for (const Seen& s : seen) {
    answer.in_doubt |= near(s.reach2(), radius2);
    if (s.reach2() <= radius2) sum += s.power;
  }
  answer.irradiance = sum / (std::numbers::pi * std::max(radius2, 1e-14));
  return answer;
}

/// Checks the answers but those in doubt, at most one in fifty.
template <typename Brute>
void check(const std::vector<vec3>& irradiance, const std::vector<Query>& queries, Brute brute) {
  size_t wrong = 0, in_doubt = 0;
  double lit = 0;
  for (size_t i = 0; i < queries.size(); ++i) {
    const Answer answer = brute(queries[i]);
    lit += glm::length(answer.irradiance);
    if (answer.in_doubt) {
      ++in_doubt;
      continue;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const double found = static_cast<double>(irradiance[i][axis]), right = answer.irradiance[axis];
      if (!(std::abs(found - right) <= 2e-6 * right + answer.rounding[axis]) && ++wrong < 5)
        MESSAGE("query " << i << ": " << found << " instead of " << right);
    }
  }
  CHECK(wrong == 0);
  CHECK(in_doubt <= queries.size() / 50);
  CHECK(lit > 0.0);
}

/// A caustic on a lawn, photons on other surfaces, and photons that wander everywhere.
std::vector<cl_float8> many_photons(Random& random) {
  std::vector<cl_float8> photons;
  const auto add = [&](vec3 p, vec3 direction) {
    photons.push_back(photon(p, direction, random.in_box(vec3(0.1f), vec3(1))));
  };
  for (int i = 0; i < 2000; ++i) {
    const float r = random.between(0, 1) * random.between(0, 1), phi = random.between(0, 6.2831853f);
    add({0.3f + r * std::cos(phi), 0.0f, r * std::sin(phi)}, glm::normalize(vec3(0.3f, -1, 0.2f)));
  }
  for (int i = 0; i < 1000; ++i)
    add({1.0f, random.between(0, 1), random.between(-1, 1)}, glm::normalize(vec3(1, -0.5f, random.between(-1, 1))));
  for (int i = 0; i < 1000; ++i) add(random.in_box(vec3(-2, -1, -2), vec3(2, 1, 2)), random.direction());
  for (int i = 0; i < 200; ++i) add(random.in_box(vec3(90, 0, -3), vec3(91, 0, -2)), {0, -1, 0});
  return photons;
}

std::vector<Query> many_queries(Random& random) {
  std::vector<Query> queries;
  const auto add = [&](vec3 p, vec3 n) { queries.push_back({p, n}); };
  for (int i = 0; i < 200; ++i) add(random.in_box(vec3(-1, 0, -1), vec3(2, 0, 1)), {0, 1, 0});
  for (int i = 0; i < 100; ++i) add(random.in_box(vec3(1, 0, -1), vec3(1, 1, 1)), {-1, 0, 0});
  for (int i = 0; i < 200; ++i) add(random.in_box(vec3(-2, -1, -2), vec3(2, 1, 2)), random.direction());
  for (int i = 0; i < 100; ++i) add(random.in_box(vec3(89, 0, -4), vec3(92, 0, -1)), {0, 1, 0});
  for (int i = 0; i < 20; ++i) add(random.in_box(vec3(1e4f), vec3(2e4f)), {0, 1, 0});
  return queries;
}

Gatherer& shared_gatherer() {
  static Device device;
  static Gatherer gatherer(device);
  return gatherer;
}

const std::vector<Query> one_query{{vec3(0), vec3(0, 1, 0)}};

}  // namespace

TEST_CASE("photons within a fixed radius are those of brute force") {
  Random random;
  const std::vector<cl_float8> photons = many_photons(random);
  const std::vector<Query> queries = many_queries(random);
  Gatherer& gatherer = shared_gatherer();
  for (float radius : {0.01f, 0.1f, 0.5f}) {
    CAPTURE(radius);
    check(gatherer.irradiance(gatherer.grid(photons, radius), queries), queries,
          [&](const Query& query) { return brute_within(query, photons, static_cast<double>(radius)); });
  }
}

TEST_CASE("photons far from the origin, where coordinates are coarse beside the radius") {
  // Planes across each axis and aslant, so that rows of cells lie beside a place in every way.
  Random random;
  Gatherer& gatherer = shared_gatherer();
  for (float radius : {0.05f, 0.01f, 0.002f}) {
    CAPTURE(radius);
    const vec3 middle(1000, -300, 500);
    std::vector<cl_float8> photons;
    std::vector<Query> queries;
    for (const vec3 n : {vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1), glm::normalize(vec3(1, 2, 3))}) {
      const auto place = [&] {
        const vec3 v = random.in_box(vec3(-8 * radius), vec3(8 * radius));
        return middle + v - n * glm::dot(v, n);
      };
      for (int i = 0; i < 2000; ++i) photons.push_back(photon(place(), -n, random.in_box(vec3(0.1f), vec3(1))));
      for (int i = 0; i < 200; ++i) queries.push_back({place(), n});
    }
    check(gatherer.irradiance(gatherer.grid(photons, radius), queries), queries,
          [&](const Query& query) { return brute_within(query, photons, static_cast<double>(radius)); });
  }
}

TEST_CASE("where all photons of a bucket count they need no test, and elsewhere they get one") {
  // A floor in buckets of .8 m along z: in one a third of the photons comes from below, in the next a single one does, in the
  // next none; then a third is above the floor, then a third is below it; the last is as it should be.
  Random random;
  std::vector<cl_float8> photons;
  bool is_first = true;
  for (int i = 0; i < 80'000; ++i) {
    vec3 p = random.in_box(vec3(-1, 0, -2), vec3(1, 0, 2));
    const bool is_third = i % 3 == 0, is_lone = is_first && i > 100 && p.z > -1.5f && p.z < -0.9f;
    if (is_lone) is_first = false;
    if (is_third && p.z > 0.0f && p.z < 0.8f) p.y = 0.05f;
    if (is_third && p.z > 0.8f && p.z < 1.6f) p.y = -0.05f;
    const float up = is_lone || (is_third && p.z < -1.65f) ? 1.0f : -1.0f;
    photons.push_back(photon(p, glm::normalize(vec3(0.3f, up, 0.2f)), random.in_box(vec3(0.1f), vec3(1))));
  }
  std::vector<Query> queries;
  for (const cl_float8& p : photons)  // where the lone one is, too
    if (queries.size() < 800) queries.push_back({{p.s[0], 0, p.s[2]}, {0, queries.size() % 4 == 3 ? -1 : 1, 0}});
  Gatherer& gatherer = shared_gatherer();
  const SortedPhotons sorted = gatherer.grid(photons, 0.1f);
  CHECK(sorted.map.bucket_counts.size() >= 16);
  check(gatherer.irradiance(sorted, queries), queries, [&](const Query& query) { return brute_within(query, photons, 0.1); });
}

TEST_CASE("what is known of a bucket is not taken for what another place's neighbours know of theirs") {
  // A floor and, farther along z, a wall, with buckets of their own, two layers of cells each; on stripes of the floor a
  // third of the photons comes from below. Two places by turns: while the one finds nothing under the floor of the next
  // bucket, the other still looks at its last one.
  Random random;
  std::vector<cl_float8> photons;
  std::vector<Query> queries;
  const vec3 up(0, 1, 0), along(1, 0, 0);
  const auto on_floor = [&] { return random.in_box(vec3(0, 0, -1), vec3(2, 0, 0)); };
  const auto on_wall = [&] { return random.in_box(vec3(0, 0, 0.25f), vec3(0, 2, 1.2f)); };
  for (int i = 0; i < 120'000; ++i) {
    const bool is_floor = i % 2 == 0;
    const vec3 p = is_floor ? on_floor() : on_wall(), n = is_floor ? up : along;
    const bool behind = is_floor && i % 3 == 0 && static_cast<int>(std::floor(p.z / 0.32f)) % 2 != 0;
    photons.push_back(photon(p, behind ? n : -n, random.in_box(vec3(0.1f), vec3(1))));
  }
  for (int pair = 0; pair < 200; ++pair) {
    const vec3 places[] = {on_floor(), on_wall()};
    for (int i = 0; i < 16; ++i) queries.push_back({places[i % 2], i % 2 == 0 ? up : along});
  }
  Gatherer& gatherer = shared_gatherer();
  const SortedPhotons sorted = gatherer.grid(photons, 0.08f);
  CHECK(sorted.map.bucket_counts.size() >= 16);
  check(gatherer.irradiance(sorted, queries), queries, [&](const Query& query) { return brute_within(query, photons, 0.08); });
}

TEST_CASE("the k nearest photons are those of brute force") {
  Random random;
  const std::vector<cl_float8> photons = many_photons(random);
  const std::vector<Query> queries = many_queries(random);
  Gatherer& gatherer = shared_gatherer();
  for (int k : {1, 50, 64})
    for (float max_radius : {0.05f, 1.0f, 300.0f}) {
      CAPTURE(k);
      CAPTURE(max_radius);
      check(gatherer.irradiance(gatherer.tree(photons, k, max_radius), queries), queries,
            [&](const Query& query) { return brute_nearest(query, photons, k, static_cast<double>(max_radius)); });
    }
}

TEST_CASE("trees of few photons, and fewer photons than k") {
  Random random;
  const std::vector<cl_float8> all = many_photons(random);
  const std::vector<Query> queries = many_queries(random);
  Gatherer& gatherer = shared_gatherer();
  for (size_t count : {1, 2, 7, 8, 9, 64, 65, 513}) {
    CAPTURE(count);
    const std::vector<cl_float8> photons(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count));
    check(gatherer.irradiance(gatherer.tree(photons, 8, 2.0f), queries), queries,
          [&](const Query& query) { return brute_nearest(query, photons, 8, 2.0); });
  }
}

TEST_CASE("photons all in one place") {
  Gatherer& gatherer = shared_gatherer();
  const std::vector<cl_float8> photons(1000, photon({0.25f, 0, 0}, {0, -1, 0}, vec3(1, 2, 3)));
  const std::vector<Query> queries{one_query[0], {{0.25f, 0, 0}, {0, 1, 0}}, {{9, 0, 0}, {0, 1, 0}}};
  check(gatherer.irradiance(gatherer.tree(photons, 50, 1.0f), queries), queries,
        [&](const Query& query) { return brute_nearest(query, photons, 50, 1.0); });
  check(gatherer.irradiance(gatherer.grid(photons, 0.5f), queries), queries,
        [&](const Query& query) { return brute_within(query, photons, 0.5); });
}

TEST_CASE("photons exactly at the border") {
  Gatherer& gatherer = shared_gatherer();
  std::vector<cl_float8> photons;
  for (vec3 p : {vec3(0.25f, 0, 0), vec3(0, 0, 0.5f), vec3(-0.5f, 0, 0), vec3(0, 0.125f, 0), vec3(0, -0.125f, 0.25f),
                 vec3(0, 0, -0.75f), vec3(0, 0.15625f, 0)})
    photons.push_back(photon(p, {0, -1, 0}, vec3(1)));
  // Within .5: the photon at .25, two at .5, two at .125 off the plane.
  const auto irradiance = [&](int k, float max_radius) {
    return static_cast<double>(gatherer.irradiance(gatherer.tree(photons, k, max_radius), one_query)[0].x);
  };
  const auto circle = [](double radius) { return std::numbers::pi * radius * radius; };
  CHECK(irradiance(1, 1.0f) == doctest::Approx(1 / circle(0.25)).epsilon(1e-6));
  CHECK(irradiance(5, 1.0f) == doctest::Approx(5 / circle(0.5)).epsilon(1e-6));
  CHECK(irradiance(2, 1.0f) == doctest::Approx(5 / circle(0.5)).epsilon(1e-6));  // equally near
  CHECK(irradiance(64, 0.5f) == doctest::Approx(5 / circle(0.5)).epsilon(1e-6));
  CHECK(irradiance(6, 1.0f) == doctest::Approx(6 / circle(0.625)).epsilon(1e-6));
  CHECK(irradiance(64, 2.0f) == doctest::Approx(7 / circle(2)).epsilon(1e-6));
  CHECK(irradiance(64, 0.125f) == 0.0);

  const double within = static_cast<double>(gatherer.irradiance(gatherer.grid(photons, 0.5f), one_query)[0].x);
  const double weights = (1 - 0.25) + (1 - 0.0625) + (1 - (0.0625 + 0.015625) / 0.25);
  CHECK(within == doctest::Approx(2 * weights / circle(0.5)).epsilon(1e-6));
}

TEST_CASE("room for a pass is within what capacity counts on, however photons spread over the buckets") {
  prepare_opencl(0);
  Device device;
  Scene scene;
  const SceneData data;
  const DeviceScene device_scene;
  const Features features;
  const Kernels kernels(device, {}, {"photon_sort"}, features.build_options());
  Random random;
  for (const uint64_t count : {500'000u, 5'000'000u, 9'000'000u}) {
    CAPTURE(count);
    PhotonGrid grid({device, kernels, scene, data, device_scene, features});
    std::vector<vec3> sample;
    for (uint32_t i = 0; i < pilot_size(count); ++i) sample.push_back(random.in_box(vec3(-1, 0, -1), vec3(1, 0, 1)));
    grid.start(sample, count, {});
    CHECK(static_cast<double>(grid.map().photons.size()) <= largest_row_share * PHOTON_ROW * static_cast<double>(count));
  }
}

TEST_CASE("gathering does not depend on the size of groups") {
  Random random;
  const std::vector<cl_float8> photons = many_photons(random);
  const std::vector<Query> queries = many_queries(random);
  Device in_small_groups("", 4), in_large_groups("", 128);
  Gatherer small(in_small_groups), large(in_large_groups);
  const auto within = [&](Gatherer& gatherer) { return gatherer.irradiance(gatherer.grid(photons, 0.1f), queries); };
  const auto nearest = [&](Gatherer& gatherer) { return gatherer.irradiance(gatherer.tree(photons, 50, 1.0f), queries); };
  CHECK(within(small) == within(large));
  CHECK(nearest(small) == nearest(large));
}
