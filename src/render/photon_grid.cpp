#include "render/photon_grid.hpp"

#include <algorithm>
#include <cmath>

#include "render/photon_pass.hpp"

namespace vitrum {
namespace {

constexpr uint32_t sort_blocks = 2;     // ranges of photons that are counted side by side
constexpr uint32_t sort_parts = 64;     // ranges of cells whose places are found side by side
constexpr size_t sample_size = 1024;

}  // namespace

float automatic_radius(std::span<const glm::vec3> sample, uint64_t count, int wanted) {
  if (sample.size() < 16) return 0.01f;
  constexpr size_t k = 8;
  std::vector<float> distance2(sample.size()), radius2;
  for (const glm::vec3& p : sample) {
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

PhotonGrid::PhotonGrid(const KernelContext& context) : context_(context) {
  sums_ = context_.device.allocate<uint32_t>(sort_parts, "photon map");
  bounds_ = context_.device.allocate<cl_float8>(sort_blocks, "photon map");
}

void PhotonGrid::sort(PhotonMap& map) {
  Device& device = context_.device;
  const PhotonSettings& settings = context_.scene.photons;
  const uint32_t count = map.count;

  std::vector<glm::vec3> sample;
  const size_t wanted = std::min<size_t>(count, sample_size);
  if (wanted > 0)
    for (const cl_float8& p : device.read_strided(map.photons, count / wanted, wanted))
      sample.push_back({p.s[0], p.s[1], p.s[2]});
  map.radius = settings.estimate == PhotonEstimate::automatic ? automatic_radius(sample, count, settings.nearest)
                                                              : static_cast<float>(settings.radius);
  map.grid = choose_grid(sample, count, map.radius);

  const uint32_t cells = 1u << (map.grid.log2_x + map.grid.log2_y + map.grid.log2_z);
  if (offsets_.size() < size_t{cells} * sort_blocks)
    offsets_ = device.allocate<uint32_t>(size_t{cells} * sort_blocks, "photon map");
  if (map.first_of_cell.size() < cells + 1) map.first_of_cell = device.allocate<uint32_t>(cells + 1, "photon map");
  if (map.stride < count + 8) {
    map.stride = padded(count + 8);
    map.sorted = device.allocate<float>(size_t{PHOTON_FIELDS} * map.stride, "photon map");
  }
  if (rows_.size() < count) rows_ = device.allocate<cl_float8>(count, "photon map");
  device.fill_zero(offsets_);

  auto kernel = [&](const char* name) { return context_.programs.kernel("photon_sort", name); };
  cl::Kernel bound = kernel("sort_bounds"), histogram = kernel("sort_count"), sum = kernel("sort_sum"),
             place = kernel("sort_place"), scatter = kernel("sort_scatter"),
             transpose = kernel("sort_transpose");
  set_arguments(bound, 0, count, sort_blocks, map.photons, bounds_);
  device.launch_singly("sort", bound, sort_blocks);
  set_arguments(histogram, 0, map.grid, count, sort_blocks, map.photons, offsets_);
  device.launch_singly("sort", histogram, sort_blocks);
  set_arguments(sum, 0, cells, sort_blocks, sort_parts, offsets_, sums_);
  device.launch_singly("sort", sum, sort_parts);
  set_arguments(place, 0, cells, sort_blocks, sort_parts, sums_, offsets_, map.first_of_cell);
  device.launch_singly("sort", place, sort_parts);
  set_arguments(scatter, 0, map.grid, count, sort_blocks, map.photons, offsets_, rows_);
  device.launch_singly("sort", scatter, sort_blocks);
  set_arguments(transpose, 0, count, map.stride, rows_, map.sorted);
  device.launch("sort", transpose, (count + 7) / 8);

  map.low.fill(std::numeric_limits<float>::infinity());
  map.high.fill(-std::numeric_limits<float>::infinity());
  for (const cl_float8& b : device.read(bounds_, 0, sort_blocks))
    for (size_t axis = 0; axis < 3; ++axis) {
      map.low[axis] = std::min(map.low[axis], b.s[axis]);
      map.high[axis] = std::max(map.high[axis], b.s[axis + 4]);
    }
}

}  // namespace vitrum
