#pragma once
// Photons and places to gather them at, and the kernels that do so, for benchmarks and tests.

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

#include "render/photon_grid.hpp"
#include "render/photon_pass.hpp"
#include "render/photon_tree.hpp"

namespace vitrum {

/// Where irradiance is asked for: a place [m] and the side of a surface.
struct Query {
  glm::vec3 position{0}, normal{0, 1, 0};
};

/// A photon as it is stored.
inline cl_float8 photon(glm::vec3 p, glm::vec3 direction, glm::vec3 power) {
  uint32_t packed = 0;
  for (int axis = 0; axis < 3; ++axis)
    packed |= (static_cast<uint32_t>(std::lrint(direction[axis] * 511.0f)) & 1023u) << (10 * axis);
  return {{p.x, p.y, p.z, std::bit_cast<float>(packed), power.x, power.y, power.z, 0}};
}

/// Photons on the device, sorted.
struct SortedPhotons {
  PhotonMap map;
  int nearest = 0;              ///< how many of them are gathered; 0: those within the map's radius
};

/// Queries on the device.
struct PlacedQueries {
  uint32_t count = 0;
  Buffer<float> places, irradiance;
};

inline PlacedQueries placed_queries(Device& device, const std::vector<Query>& queries) {
  std::vector<float> places;
  for (const Query& query : queries)
    for (const glm::vec3& v : {query.position, query.normal}) places.insert(places.end(), {v.x, v.y, v.z});
  return {static_cast<uint32_t>(queries.size()), device.upload(places, "queries"),
          device.allocate<float>(3 * queries.size(), "queries")};
}

/// kernels/checks/gather.cl for these features.
inline cl::Kernel gather_kernel(const Device& device, const KernelFiles& files, const Features& features) {
  return cl::Kernel(device.build("checks/gather.cl", kernel_source(files, {"checks/gather.cl"}),
                                 "-cl-std=CL1.2" + features.build_options()),
                    "gather_at");
}

/// Leaves the irradiance of the queries, and waits for it. `scene`: its photon settings count.
inline void gather(Device& device, cl::Kernel& kernel, const PhotonMap& map, const Scene& scene,
                   const PlacedQueries& queries) {
  set_arguments(kernel, 0, queries.count, queries.places);
  set_arguments(kernel, set_map_arguments(kernel, 2, map, scene), queries.irradiance);
  device.launch("gather", kernel, device.packets(queries.count));
  device.finish();
}

/// What `gather` left, red, green and blue [W/m2].
inline std::vector<glm::vec3> irradiance_of(Device& device, const PlacedQueries& queries) {
  const std::vector<float> values = device.read(queries.irradiance, 0, queries.irradiance.size());
  std::vector<glm::vec3> irradiance(queries.count);
  for (size_t i = 0; i < irradiance.size(); ++i) irradiance[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  return irradiance;
}

/// The kernels that sort and gather.
class Gatherer {
 public:
  explicit Gatherer(Device& device, const KernelFiles& files = {})
      : device_(device),
        kernels_(device_, files, {"photon_sort"}, Features{}.build_options()),
        context_{device_, kernels_, scene_, data_, device_scene_, features_},
        within_(gather_kernel(device_, files, features_of(false))),
        nearest_(gather_kernel(device_, files, features_of(true))) {}

  /// In a grid, to be gathered within `radius` [m].
  SortedPhotons grid(const std::vector<cl_float8>& photons, float radius) {
    scene_.photons.estimate = PhotonEstimate::fixed_radius;
    scene_.photons.radius = static_cast<double>(radius);
    PhotonGrid grid(context_);
    std::vector<glm::vec3> places;
    for (const cl_float8& p : photons) places.push_back({p.s[0], p.s[1], p.s[2]});
    // As a pass does: room is made for what a few photons promise.
    grid.start(std::span(places).first(std::min<size_t>(places.size(), 1000)), places.size(), {});
    for (size_t first = 0; first < photons.size(); first += 5 * run_length)
      grid.add(runs_of(std::span(photons).subspan(first, std::min(5 * run_length, photons.size() - first)), grid));
    grid.finish();
    return {grid.map()};
  }

  /// In a tree, of which the `nearest` within `max_radius` [m] are to be gathered.
  SortedPhotons tree(const std::vector<cl_float8>& photons, int nearest, float max_radius) {
    SortedPhotons sorted{{}, nearest};
    fill_photon_tree(device_, sorted.map, photons, static_cast<double>(max_radius));
    return sorted;
  }

  PlacedQueries place(const std::vector<Query>& queries) { return placed_queries(device_, queries); }

  /// Leaves the irradiance of the queries, and waits for it.
  void gather(const SortedPhotons& photons, const PlacedQueries& queries) {
    cl::Kernel& kernel = photons.nearest > 0 ? nearest_ : within_;
    scene_.photons.estimate = photons.nearest > 0 ? PhotonEstimate::nearest : PhotonEstimate::fixed_radius;
    scene_.photons.nearest = photons.nearest;
    vitrum::gather(device_, kernel, photons.map, scene_, queries);
  }

  /// Irradiance of the queries, red, green and blue [W/m2].
  std::vector<glm::vec3> irradiance(const SortedPhotons& photons, const std::vector<Query>& queries) {
    const PlacedQueries placed = place(queries);
    gather(photons, placed);
    return irradiance_of(device_, placed);
  }

 private:
  static constexpr size_t run_length = 1000;

  static Features features_of(bool nearest) {
    Features features;
    features.caustics = true;
    features.nearest_photons = nearest;
    return features;
  }

  /// Photons as a launch leaves them, in runs that are nearly full.
  PhotonRuns runs_of(std::span<const cl_float8> photons, const PhotonGrid& grid) {
    PhotonRuns runs;
    runs.length = run_length + 3;
    const uint32_t n_runs = static_cast<uint32_t>((photons.size() + run_length - 1) / run_length);
    std::vector<float> fields(kernel::photon_in_run(runs.length, n_runs, 0, PHOTON_ROW));
    std::vector<uint32_t> counts(size_t{n_runs} * grid.buckets());
    for (uint32_t run = 0; run < n_runs; ++run) {
      const size_t first = run * run_length, count = std::min(run_length, photons.size() - first);
      kernel::PhotonRunData report{};
      report.photons[OUTCOME_STORED] = static_cast<uint32_t>(count);
      std::fill_n(report.low, 3, INFINITY);
      std::fill_n(report.high, 3, -INFINITY);
      for (size_t i = 0; i < count; ++i) {
        const cl_float8& photon = photons[first + i];
        const uint32_t cell = cell_of(grid.grid(), {photon.s[0], photon.s[1], photon.s[2]});
        ++counts[run * grid.buckets() + (cell >> grid.grid().bucket_shift)];
        for (uint32_t field = 0; field < PHOTON_ROW; ++field)
          fields[kernel::photon_in_run(runs.length, run, field, PHOTON_ROW) + i] =
              field == PHOTON_CELL ? std::bit_cast<float>(cell) : photon.s[field];
        for (int axis = 0; axis < 3; ++axis) {
          report.low[axis] = std::min(report.low[axis], photon.s[axis]);
          report.high[axis] = std::max(report.high[axis], photon.s[axis]);
        }
      }
      runs.reports.push_back(report);
    }
    runs.photons = device_.upload(fields, "photons");
    runs.counts = device_.upload(counts, "photons");
    runs.on_device = device_.upload(runs.reports, "photons");
    return runs;
  }

  Device& device_;
  Kernels kernels_;
  Scene scene_;
  SceneData data_;
  DeviceScene device_scene_;
  Features features_;
  KernelContext context_;
  cl::Kernel within_, nearest_;
};

}  // namespace vitrum
