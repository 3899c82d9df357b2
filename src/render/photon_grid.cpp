#include "render/photon_grid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "render/photon_pass.hpp"

namespace vitrum {
namespace {

constexpr uint32_t sort_blocks = 32;           // ranges of runs that are counted side by side
constexpr uint32_t photons_per_bucket = 4096;  // their rows fit a CPU's second cache
constexpr size_t sample_size = 1024;
constexpr size_t judged_places = 128;          // of the sample, around which the density is looked at

/// Places of photons from all runs, the first few of each: those of a low-discrepancy sequence spread well.
std::vector<glm::vec3> sample_of(Device& device, const PhotonMap& map) {
  std::vector<glm::vec3> sample;
  const size_t runs = map.stored_by_run.size();
  if (runs == 0) return sample;
  const size_t step = std::max<size_t>(1, runs / sample_size);
  const size_t from_each = std::min<size_t>(map.run_length, (sample_size * step + runs - 1) / runs);
  const auto coordinates = [&](uint32_t field) {
    return device.read_strided(map.photons, kernel::photon_in_run(map.run_length, 0, field), from_each,
                               step * kernel::photon_in_run(map.run_length, 1, 0), (runs + step - 1) / step);
  };
  const std::vector<float> x = coordinates(PHOTON_X), y = coordinates(PHOTON_Y), z = coordinates(PHOTON_Z);
  for (size_t i = 0; i < x.size(); ++i)
    if (i % from_each < map.stored_by_run[i / from_each * step]) sample.push_back({x[i], y[i], z[i]});
  return sample;
}

}  // namespace

PhotonGrid::PhotonGrid(const KernelContext& context) : context_(context) {
  bounds_ = context_.device.allocate<cl_float8>(sort_blocks, "photon map");
}

float automatic_radius(std::span<const glm::vec3> sample, uint64_t count, int wanted) {
  if (sample.size() < 16) return 0.01f;
  constexpr size_t k = 8;
  std::vector<float> distance2(sample.size()), radius2;
  for (size_t place = 0; place < sample.size(); place += (sample.size() + judged_places - 1) / judged_places) {
    const glm::vec3 p = sample[place];
    for (size_t i = 0; i < sample.size(); ++i) {
      const glm::vec3 d = sample[i] - p;
      distance2[i] = glm::dot(d, d);
    }
    // The place itself is the first.
    std::nth_element(distance2.begin(), distance2.begin() + k, distance2.end());
    radius2.push_back(distance2[k]);
  }
  std::nth_element(radius2.begin(), radius2.begin() + static_cast<std::ptrdiff_t>(radius2.size() / 2), radius2.end());
  const double thinning = static_cast<double>(sample.size()) / static_cast<double>(std::max<uint64_t>(count, 1));
  const double r2 = radius2[radius2.size() / 2] * wanted / static_cast<double>(k) * thinning;
  return std::max(static_cast<float>(std::sqrt(r2)), 1e-7f);
}

kernel::GridData choose_grid(std::span<const glm::vec3> sample, uint64_t count, float radius) {
  const float cell = radius * 1.001f;  // so that rounding never puts a neighbour two cells away
  uint32_t size[3];
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float> values;
    for (const glm::vec3& p : sample) values.push_back(p[axis]);
    std::sort(values.begin(), values.end());
    // The outer twentieths may wrap around.
    const float extent = values.empty() ? 0.0f : values[values.size() * 19 / 20] - values[values.size() / 20];
    const double cells = std::min(static_cast<double>(extent) / cell, 4096.0);
    const double least = axis == 0 ? 2.0 : 0.0;
    size[axis] = static_cast<uint32_t>(std::max(least, std::ceil(std::log2(std::max(cells, 1.0)))));
  }
  const uint32_t most = std::clamp(static_cast<uint32_t>(std::log2(static_cast<double>(count + 1) / 4.0)), 8u, 20u);
  // Spare cells go to the axes along which photons spread, so that places outside of the crowd rarely wrap into it.
  const bool flat[3] = {size[0] <= 2, size[1] <= 1, size[2] <= 1};
  while (size[0] + size[1] + size[2] < most && !(flat[0] && flat[1] && flat[2])) {
    int least = -1;
    for (int axis = 0; axis < 3; ++axis)
      if (!flat[axis] && (least < 0 || size[axis] < size[least])) least = axis;
    ++size[least];
  }
  while (size[0] + size[1] + size[2] > most) {
    uint32_t& largest = *std::max_element(size, size + 3);
    --largest;
  }
  return {1.0f / cell, size[0], size[1], size[2]};
}

void PhotonGrid::sort(PhotonMap& map) {
  Device& device = context_.device;
  const PhotonSettings& settings = context_.scene.photons;
  const uint32_t n_runs = static_cast<uint32_t>(map.stored_by_run.size());

  const std::vector<glm::vec3> sample = sample_of(device, map);
  map.radius = settings.estimate == PhotonEstimate::automatic ? automatic_radius(sample, map.count, settings.nearest)
                                                              : static_cast<float>(settings.radius);
  map.grid = choose_grid(sample, map.count, map.radius);

  const uint32_t log2_cells = map.grid.log2_x + map.grid.log2_y + map.grid.log2_z;
  const uint32_t cells = 1u << log2_cells;
  const uint32_t log2_buckets =
      std::min(log2_cells, static_cast<uint32_t>(std::bit_width(map.count / photons_per_bucket)));
  const uint32_t buckets = 1u << log2_buckets;
  const uint32_t shift = log2_cells - log2_buckets;
  if (next_of_cell_.size() < cells) next_of_cell_ = device.allocate<uint32_t>(cells, "photon map");
  if (map.first_of_cell.size() < cells + 1) map.first_of_cell = device.allocate<uint32_t>(cells + 1, "photon map");
  if (counts_.size() < sort_blocks * buckets)
    counts_ = device.allocate<uint32_t>(sort_blocks * buckets, "photon map");
  if (first_of_bucket_.size() < buckets + 1)
    first_of_bucket_ = device.allocate<uint32_t>(buckets + 1, "photon map");
  if (bucketed_.size() < map.count) bucketed_ = device.allocate<cl_float8>(map.count, "photon map");

  auto kernel = [&](const char* name) { return context_.kernels.get(name); };
  cl::Kernel count = kernel("sort_count"), into_buckets = kernel("sort_into_buckets"),
             into_cells = kernel("sort_into_cells");
  set_arguments(count, 0, map.grid, n_runs, map.run_length, sort_blocks, buckets, shift, map.runs, map.photons, counts_,
                bounds_);
  device.launch_singly("sort", count, sort_blocks);

  // Bucket by bucket, and in it block by block, so that photons keep their order.
  std::vector<uint32_t> places = device.read(counts_, 0, sort_blocks * buckets), first_of_bucket;
  uint32_t place = 0;
  for (uint32_t bucket = 0; bucket < buckets; ++bucket) {
    first_of_bucket.push_back(place);
    for (uint32_t block = 0; block < sort_blocks; ++block)
      place += std::exchange(places[block * buckets + bucket], place);
  }
  first_of_bucket.push_back(place);
  device.write(counts_, places);
  device.write(first_of_bucket_, first_of_bucket);
  set_arguments(into_buckets, 0, n_runs, map.run_length, sort_blocks, buckets, shift, map.runs, map.photons,
                counts_, bucketed_);
  device.launch_singly("sort", into_buckets, sort_blocks);

  map.stride = padded(map.count + 8);
  set_arguments(into_cells, 0, buckets, shift, first_of_bucket_, bucketed_, next_of_cell_, map.first_of_cell, map.stride,
                map.photons);
  device.launch_singly("sort", into_cells, buckets);

  map.low.fill(std::numeric_limits<float>::infinity());
  map.high.fill(-std::numeric_limits<float>::infinity());
  for (const cl_float8& b : device.read(bounds_, 0, sort_blocks))
    for (size_t axis = 0; axis < 3; ++axis) {
      map.low[axis] = std::min(map.low[axis], b.s[axis]);
      map.high[axis] = std::max(map.high[axis], b.s[axis + 4]);
    }
}

}  // namespace vitrum
