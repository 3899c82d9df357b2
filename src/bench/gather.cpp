// Queries a second of both ways to gather photons, by their number, beside nanoflann's searches of the same photons.

#include <cmath>
#include <nanoflann.hpp>
#include <numbers>
#include <random>

#include "bench/benchmarks.hpp"
#include "bench/side_by_side.hpp"
#include "verify/gatherer.hpp"

namespace vitrum {
namespace {

using glm::vec3;

constexpr int wanted = 50;                // photons a query

/// Photons in a disc of 1 m, or places to ask at, that thicken towards its middle as a caustic does.
std::vector<vec3> places_in_disc(size_t count, uint32_t seed) {
  std::mt19937 bits(seed);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  std::vector<vec3> places;
  for (size_t i = 0; i < count; ++i) {
    const float r = uniform(bits), phi = 2 * std::numbers::pi_v<float> * uniform(bits);
    places.emplace_back(r * std::cos(phi), 0.0f, r * std::sin(phi));
  }
  return places;
}

/// Row by row, as neighbouring pixels ask.
void sort_into_rows(std::vector<Query>& queries) {
  const auto row = [](const Query& q) { return std::floor(q.position.x * 200.0f); };
  std::ranges::sort(queries, [&](const Query& a, const Query& b) {
    return row(a) != row(b) ? row(a) < row(b) : a.position.z < b.position.z;
  });
}

/// What nanoflann wants of points.
struct Cloud {
  const std::vector<cl_float8>& photons;
  size_t kdtree_get_point_count() const { return photons.size(); }
  float kdtree_get_pt(size_t i, size_t axis) const { return photons[i].s[axis]; }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const { return false; }
};

/// nanoflann's tree with its own defaults; its answers are summed as vitrum sums.
class Flann {
 public:
  explicit Flann(const std::vector<cl_float8>& photons) : photons_(photons), cloud_{photons}, tree_(3, cloud_) {
    tree_.buildIndex();
  }

  /// Epanechnikov's kernel over what radiusSearch finds, in no order.
  void within(const std::vector<Query>& queries, float radius, unsigned threads, std::vector<vec3>& irradiance) const {
    const float radius2 = radius * radius, scale = 2.0f / (std::numbers::pi_v<float> * radius2);
    in_threads(threads, queries.size(), [&](size_t first, size_t last) {
      std::vector<std::pair<uint32_t, float>> found;
      const nanoflann::SearchParams unsorted(0, 0.0f, false);
      for (size_t i = first; i < last; ++i) {
        tree_.radiusSearch(&queries[i].position.x, radius2, found, unsorted);
        vec3 sum(0);
        for (const auto& [photon, distance2] : found) sum += (1.0f - distance2 / radius2) * power(photon);
        irradiance[i] = scale * sum;
      }
    });
  }

  /// The power that knnSearch finds over its circle.
  void nearest(const std::vector<Query>& queries, unsigned threads, std::vector<vec3>& irradiance) const {
    in_threads(threads, queries.size(), [&](size_t first, size_t last) {
      uint32_t found[wanted];
      float distances2[wanted];
      for (size_t i = first; i < last; ++i) {
        tree_.knnSearch(&queries[i].position.x, wanted, found, distances2);
        vec3 sum(0);
        for (const uint32_t photon : found) sum += power(photon);
        irradiance[i] = sum / (std::numbers::pi_v<float> * distances2[wanted - 1]);
      }
    });
  }

  /// Photons that a query finds within the radius, on average over some of them.
  double found(const std::vector<Query>& queries, float radius) const {
    std::vector<std::pair<uint32_t, float>> found;
    const size_t step = std::max<size_t>(queries.size() / 1000, 1);
    double sum = 0.0, asked = 0.0;
    for (size_t i = 0; i < queries.size(); i += step, ++asked)
      sum += static_cast<double>(tree_.radiusSearch(&queries[i].position.x, radius * radius, found, {}));
    return sum / asked;
  }

 private:
  vec3 power(uint32_t photon) const {
    const cl_float8& p = photons_[photon];
    return {p.s[PHOTON_POWER], p.s[PHOTON_POWER + 1], p.s[PHOTON_POWER + 2]};
  }

  const std::vector<cl_float8>& photons_;
  Cloud cloud_;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3, uint32_t> tree_;
};

/// The radius within which queries find as many photons as are wanted.
float radius_for(const Flann& flann, const std::vector<Query>& queries) {
  float low = 0.0f, high = 1.0f;
  for (int step = 0; step < 20; ++step) {
    const float middle = 0.5f * (low + high);
    (flann.found(queries, middle) < wanted ? low : high) = middle;
  }
  return high;
}

/// The mean difference of the answers, relative to their mean. Single ones differ by a photon, where two are equally far.
double mean_difference(const std::vector<vec3>& ours, const std::vector<vec3>& theirs) {
  double difference = 0.0, sum = 0.0;
  for (size_t i = 0; i < ours.size(); ++i) {
    difference += static_cast<double>(glm::length(ours[i] - theirs[i]));
    sum += static_cast<double>(glm::length(theirs[i]));
  }
  return difference / sum;
}

}  // namespace

BenchResult bench_gather(const BenchContext& context) {
  std::vector<size_t> sizes = {20'000};
  if (!context.quick) sizes.insert(sizes.end(), {200'000, 1'000'000});
  const size_t n_queries = context.quick ? 5'000 : 100'000;
  const int rounds = context.quick ? 3 : 5;
  const std::string unit = SideBySide::unit(context);
  BenchResult result;
  result.plot = {"Gathering 50 photons a query, against nanoflann", "photons", "times as fast as nanoflann", {}, true, true};
  for (const char* name : {"radius, coherent", "radius, random", "nearest, coherent", "nearest, random"})
    result.plot.lines.push_back({name, {}});
  Gatherer gatherer(context.device, context.kernels);
  double done = 0.0;
  for (const size_t n_photons : sizes) {
    std::vector<cl_float8> photons;
    for (const vec3& p : places_in_disc(n_photons, 1)) photons.push_back(photon(p, {0.3f, -0.9f, 0.1f}, vec3(1, 2, 3)));
    std::vector<Query> random;
    for (const vec3& p : places_in_disc(n_queries, 2)) random.push_back({p, {0, 1, 0}});
    std::vector<Query> coherent = random;
    sort_into_rows(coherent);
    const Flann flann(photons);
    const float radius = radius_for(flann, random);
    const double found = flann.found(random, radius);
    for (size_t k = 0; k < result.plot.lines.size(); ++k) {
      const bool nearest = k >= 2;
      const std::vector<Query>& queries = k % 2 == 0 ? coherent : random;
      const SortedPhotons sorted = nearest ? gatherer.tree(photons, wanted, 1.0f) : gatherer.grid(photons, radius);
      const PlacedQueries placed = gatherer.place(queries);
      std::vector<vec3> theirs(queries.size());
      const SideBySide both(
          context, rounds, [&] { gatherer.gather(sorted, placed); },
          [&] {
            if (nearest) flann.nearest(queries, context.threads, theirs);
            else flann.within(queries, radius, context.threads, theirs);
          });
      PlotLine& line = result.plot.lines[k];
      const double millions = 1e-6 * static_cast<double>(queries.size());
      result.rows.push_back({line.name, {{"photons", static_cast<double>(n_photons)},
                                         {"a query", nearest ? wanted : found},
                                         {"M queries/" + unit, millions / both.ours()},
                                         {"nanoflann's", millions / both.theirs()}, {"times as fast", both.speedup()},
                                         {"difference", mean_difference(gatherer.irradiance(sorted, queries), theirs)}}});
      line.points.emplace_back(static_cast<double>(n_photons), both.speedup());
      context.progress(done += 0.25 / static_cast<double>(sizes.size()));
    }
  }
  result.findings.push_back(printed("nanoflann %x.%x.%x: radiusSearch unsorted, knnSearch, its own leaf size, compiled as "
                                    "vitrum's host code is",
                                    NANOFLANN_VERSION >> 8, NANOFLANN_VERSION >> 4 & 15, NANOFLANN_VERSION & 15));
  return result;
}

}  // namespace vitrum
