// Queries a second of both ways to gather photons, and of nanoflann's tree, over caustics of some sizes.
// bench_gather [KERNELS]: a folder of kernels to take instead of those in the binary.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <nanoflann.hpp>
#include <random>

#include "device/gatherer.hpp"

using namespace vitrum;

namespace {

constexpr size_t n_queries = 200'000, k = 50;

/// What nanoflann wants of a point cloud.
struct Cloud {
  const std::vector<cl_float8>& photons;
  size_t kdtree_get_point_count() const { return photons.size(); }
  float kdtree_get_pt(size_t i, size_t axis) const { return photons[i].s[axis]; }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const { return false; }
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Photons that thicken towards the middle of a disc of 1 m, and queries spread as they are.
void run(size_t n_photons, const KernelFiles& kernels) {
  std::mt19937 bits(1);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  const auto place = [&] {
    const float r = uniform(bits), phi = 6.2831853f * uniform(bits);
    return glm::vec3(r * std::cos(phi), 0.0f, r * std::sin(phi));
  };
  std::vector<cl_float8> photons;
  for (size_t i = 0; i < n_photons; ++i) photons.push_back(photon(place(), {0.3f, -0.9f, 0.1f}, glm::vec3(1)));
  // As neighbouring pixels do, neighbouring queries lie near each other.
  std::vector<Query> queries(n_queries);
  for (Query& query : queries) query.position = place();
  std::sort(queries.begin(), queries.end(), [](const Query& a, const Query& b) {
    const auto row = [](const Query& q) { return std::floor(q.position.x * 200.0f); };
    return row(a) != row(b) ? row(a) < row(b) : a.position.z < b.position.z;
  });

  const auto build_start = std::chrono::steady_clock::now();
  const PhotonTree tree = build_photon_tree(photons);
  const double build = seconds_since(build_start);

  const float radius = std::sqrt(static_cast<float>(k) * 0.5f / static_cast<float>(n_photons));  // at r = 0.5
  Gatherer gatherer(32, kernels);
  double within_seconds = 1e30, nearest_seconds = 1e30;  // the least of some
  std::map<std::string, double> before;
  for (int repeat = 0; repeat < 8; ++repeat) {
    gatherer.within(photons, queries, radius);
    gatherer.nearest(photons, queries, k, 1.0f);
    std::map<std::string, double> after = gatherer.seconds();
    within_seconds = std::min(within_seconds, after["within"] - before["within"]);
    nearest_seconds = std::min(nearest_seconds, after["nearest"] - before["nearest"]);
    before = after;
  }
  std::printf("%zu photons: tree built in %.3f s; Mqueries/s: fixed radius %.2f, %zu nearest %.3f", n_photons, build,
              n_queries / within_seconds * 1e-6, k, n_queries / nearest_seconds * 1e-6);

  const Cloud cloud{photons};
  const auto flann_start = std::chrono::steady_clock::now();
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3, uint32_t> flann(3, cloud);
  flann.buildIndex();
  const double flann_build = seconds_since(flann_start);
  const auto search_start = std::chrono::steady_clock::now();
  uint32_t indices[k];
  float distances2[k];
  double sum = 0.0;
  for (size_t i = 0; i < n_queries; i += 8) {
    flann.knnSearch(&queries[i].position.x, k, indices, distances2);
    for (size_t j = 0; j < k; ++j) sum += static_cast<double>(photons[indices[j]].s[PHOTON_POWER]);
  }
  std::printf("; nanoflann (1 thread, no power but red): built in %.3f s, %.3f%s\n", flann_build,
              n_queries / 8 / seconds_since(search_start) * 1e-6, sum > 0.0 ? "" : "!");
}

}  // namespace

int main(int argc, char** argv) {
  for (size_t n_photons : {20'000, 1'000'000}) run(n_photons, {argc > 1 ? argv[1] : "", ""});
}
