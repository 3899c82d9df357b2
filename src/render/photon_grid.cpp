#include "render/photon_grid.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace vitrum {
namespace {

constexpr uint32_t photons_per_bucket = 8192;  // their rows fit a CPU's second cache, twice
constexpr uint32_t most_log2_buckets = 10;     // each takes a line of a processor's cache while photons are dealt out
constexpr uint64_t entries_of_footprint = 6;   // about
constexpr size_t judged_places = 128;          // of a sample, around which the density is looked at,
constexpr size_t judging_places = 1024;        // by so many of it

uint32_t log2_cells(const kernel::GridData& grid) { return grid.log2_x + grid.log2_y + grid.log2_z; }

constexpr uint32_t margin_rows = 16;           // a sorted bucket is whole blocks
/// Buckets start at a multiple of MAP_BLOCK floats, which are one or two rows; an even number of them is whole in any case.
uint32_t whole_units(uint32_t rows) { return (rows + 1) / 2 * 2; }

}  // namespace

uint32_t pilot_size(uint64_t count) { return static_cast<uint32_t>(std::clamp<uint64_t>(count / 128, 1024, 65536)); }

uint32_t cell_of(const kernel::GridData& grid, const glm::vec3& p) {
  const auto coordinate = [](float x, float inverse_cell, uint32_t log2) {
    const float cell = std::clamp(std::floor(x * inverse_cell), -1e9f, 1e9f);
    return static_cast<uint32_t>(static_cast<int32_t>(cell)) & ((1u << log2) - 1u);
  };
  const uint32_t y = coordinate(p.y, grid.inverse_cell, grid.log2_y);
  const uint32_t z = coordinate(p.z, grid.inverse_cell, grid.log2_z);
  return (z << grid.log2_y | y) << grid.log2_x | coordinate(p.x, grid.inverse_cell_x, grid.log2_x);
}

float automatic_radius(std::span<const glm::vec3> places, uint64_t count, double wanted) {
  if (places.size() < 16) return 0.01f;
  std::vector<glm::vec3> sample;
  for (size_t i = 0; i < places.size(); i += (places.size() + judging_places - 1) / judging_places)
    sample.push_back(places[i]);
  constexpr size_t k = 8;
  std::vector<float> radius2;
  for (size_t place = 0; place < sample.size(); place += (sample.size() + judged_places - 1) / judged_places) {
    const glm::vec3 p = sample[place];
    // The least squared distances, in order; that of the place itself is the first.
    std::array<float, k + 1> least;
    least.fill(std::numeric_limits<float>::infinity());
    for (const glm::vec3& other : sample) {
      const glm::vec3 d = other - p;
      const float distance2 = glm::dot(d, d);
      if (!(distance2 < least[k])) continue;
      size_t at = k;
      for (; at > 0 && least[at - 1] > distance2; --at) least[at] = least[at - 1];
      least[at] = distance2;
    }
    radius2.push_back(least[k]);
  }
  std::nth_element(radius2.begin(), radius2.begin() + static_cast<std::ptrdiff_t>(radius2.size() / 2), radius2.end());
  const double thinning = static_cast<double>(sample.size()) / static_cast<double>(std::max<uint64_t>(count, 1));
  const double r2 = radius2[radius2.size() / 2] * wanted / static_cast<double>(k) * thinning;
  return std::max(static_cast<float>(std::sqrt(r2)), 1e-7f);
}

double progressive_area(uint64_t pass) {
  // The product of the ratios, by gamma functions.
  constexpr double alpha = 2.0 / 3.0;
  const double i = static_cast<double>(pass) + 1.0;
  return std::exp(std::lgamma(i + alpha) - std::lgamma(1.0 + alpha) - std::lgamma(i + 1.0));
}

kernel::GridData choose_grid(std::span<const glm::vec3> sample, uint64_t cells_at_most, float radius,
                             uint32_t along_x) {
  // So that rounding rarely puts a neighbour two cells away: not within 8,000 cells of the origin.
  const float cell = radius * 1.001f;
  const auto log2_along_x = static_cast<uint32_t>(std::countr_zero(along_x));
  uint32_t size[3];  // log2, in cubes
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float> values;
    for (const glm::vec3& p : sample) values.push_back(p[axis]);
    std::sort(values.begin(), values.end());
    // The outer twentieths may wrap around.
    const float extent = values.empty() ? 0.0f : values[values.size() * 19 / 20] - values[values.size() / 20];
    const double cells = std::min(static_cast<double>(extent) / cell, 4096.0);
    size[axis] = static_cast<uint32_t>(std::ceil(std::log2(std::max(cells, 1.0))));
  }
  const bool flat[3] = {size[0] <= 2, size[1] <= 1, size[2] <= 1};
  const uint32_t least_x = LEAST_LOG2_BUCKET - log2_along_x;
  size[0] = std::max(size[0], least_x);
  const auto log2_most = static_cast<uint32_t>(std::log2(static_cast<double>(cells_at_most + 1)));
  const uint32_t most = std::clamp(log2_most, 8u, 22u) - log2_along_x;
  // Spare cells go to the axes along which photons spread, so that places outside of the crowd rarely wrap into it.
  while (size[0] + size[1] + size[2] < most && !(flat[0] && flat[1] && flat[2])) {
    int least = -1;
    for (int axis = 0; axis < 3; ++axis)
      if (!flat[axis] && (least < 0 || size[axis] < size[least])) least = axis;
    ++size[least];
  }
  while (size[0] + size[1] + size[2] > most) --*std::max_element(size + (size[0] > least_x ? 0 : 1), size + 3);
  return {static_cast<float>(along_x) / cell, 1.0f / cell, size[0] + log2_along_x, size[1], size[2], 0};
}

PhotonGrid::PhotonGrid(const KernelContext& context)
    : context_(context), row_(context.features.footprints ? FOOTPRINT_ROW : PHOTON_ROW) {
  map_.fields = context.features.footprints ? FOOTPRINT_FIELDS : PHOTON_FIELDS;
}

void PhotonGrid::reserve_rows(uint64_t rows) {
  const size_t floats = (rows + margin_rows) * row_;
  if (map_.photons.size() >= floats) return;
  const Buffer<float> larger = context_.device.allocate<float>(floats, "photon map");
  if (used_rows_ > 0) context_.device.copy(map_.photons, 0, larger, 0, size_t{used_rows_} * row_);
  map_.photons = larger;
}

PhotonGrid::Room PhotonGrid::new_room(uint32_t rows) {
  const Room room{used_rows_, whole_units(rows)};
  if (map_.photons.size() < size_t{used_rows_ + room.size + margin_rows} * row_)
    reserve_rows(uint64_t{used_rows_} + room.size + used_rows_ / 4);
  used_rows_ += room.size;
  return room;
}

void PhotonGrid::start(std::span<const glm::vec3> sample, uint64_t expected, const PhotonPassPlan& plan) {
  const PhotonSettings& settings = context_.scene.photons;
  samples_ = plan.samples;
  if (plan.pass == 0 || !settings.progressive) {
    // Footprints are as large as photons of one pass are apart.
    const bool by_pass = settings.progressive || context_.features.footprints;
    const double wanted = by_pass ? settings.nearest : settings.nearest * plan.share;
    first_radius_ = settings.estimate != PhotonEstimate::fixed_radius
                        ? static_cast<double>(automatic_radius(sample, expected, wanted))
                        : settings.radius;
  }
  map_.radius = static_cast<float>(settings.progressive ? first_radius_ * std::sqrt(progressive_area(plan.pass)) : first_radius_);
  // A footprint is listed in each cell that it reaches into.
  if (context_.features.footprints) expected *= entries_of_footprint;
  map_.grid = context_.features.footprints ? choose_grid(sample, expected / 4, map_.radius, 1)
                                           : choose_grid(sample, expected, map_.radius, CELLS_ALONG_X);
  const uint32_t cells = log2_cells(map_.grid);
  const auto wanted_log2 = static_cast<uint32_t>(std::bit_width(expected / photons_per_bucket));
  const uint32_t log2_buckets = std::min({wanted_log2, most_log2_buckets, cells - LEAST_LOG2_BUCKET});
  map_.grid.bucket_shift = cells - log2_buckets;
  map_.count = 0;
  map_.low.fill(std::numeric_limits<float>::infinity());
  map_.high.fill(-std::numeric_limits<float>::infinity());
  map_.bucket_counts.assign(size_t{1} << log2_buckets, 0);

  used_rows_ = 0;
  room_.assign(map_.bucket_counts.size(), {});
  if (context_.features.footprints) return reserve_rows(0);  // their entries are counted before they come
  // Room by the sample's share in each bucket, with some to spare; what is not enough grows later.
  std::vector<uint32_t> in_bucket(map_.bucket_counts.size(), 0);
  for (const glm::vec3& p : sample) ++in_bucket[cell_of(map_.grid, p) >> map_.grid.bucket_shift];
  const double each = static_cast<double>(expected) / static_cast<double>(std::max<size_t>(sample.size(), 1));
  std::vector<uint32_t> rows;
  for (uint32_t n : in_bucket) {
    const double wanted = each * (n + 2.0 * std::sqrt(n) + 1.0);
    rows.push_back(whole_units(static_cast<uint32_t>(std::min(wanted, static_cast<double>(expected))) + margin_rows));
  }
  const uint64_t all = std::accumulate(rows.begin(), rows.end(), uint64_t{0});
  const auto promised = static_cast<uint64_t>(largest_row_share * static_cast<double>(expected));
  reserve_rows(std::max(all + margin_rows, promised) - margin_rows);
  for (size_t bucket = 0; bucket < rows.size(); ++bucket) room_[bucket] = new_room(rows[bucket]);
}

void PhotonGrid::make_room(const PhotonRuns& runs) {
  Device& device = context_.device;
  const uint32_t n_runs = static_cast<uint32_t>(runs.reports.size());
  // Bucket by bucket, and in it run by run, so that photons keep their order.
  std::vector<uint32_t> places = device.read(runs.counts, 0, size_t{n_runs} * buckets()), rows(buckets()), added(buckets());
  for (uint32_t run = 0; run < n_runs; ++run)
    for (uint32_t bucket = 0; bucket < buckets(); ++bucket) added[bucket] += places[run * buckets() + bucket];
  // The first have just the room that they need, the only ones of one light and one caster.
  const bool is_first = used_rows_ == 0;
  if (is_first)
    reserve_rows(std::accumulate(added.begin(), added.end(), uint64_t{0}) + uint64_t{buckets()} * 2 * margin_rows);
  for (uint32_t bucket = 0; bucket < buckets(); ++bucket) {
    const uint32_t before = std::exchange(map_.bucket_counts[bucket], map_.bucket_counts[bucket] + added[bucket]);
    const uint32_t needed = map_.bucket_counts[bucket] + margin_rows;
    if (Room& room = room_[bucket]; room.size < needed) {
      const Room larger = new_room(is_first ? needed : 2 * needed);
      device.copy(map_.photons, size_t{room.start} * row_, map_.photons, size_t{larger.start} * row_,
                  size_t{before} * row_);
      room = larger;
    }
    rows[bucket] = room_[bucket].start + before;
  }
  for (uint32_t run = 0; run < n_runs; ++run)
    for (uint32_t bucket = 0; bucket < buckets(); ++bucket) {
      uint32_t& place = places[run * buckets() + bucket];
      rows[bucket] += std::exchange(place, rows[bucket]);
    }
  if (places_.size() < places.size()) places_ = device.allocate<uint32_t>(places.size(), "photon map");
  device.write(places_, places);
}

kernel::FootprintLimits PhotonGrid::footprint_limits() const {
  const kernel::CameraData& camera = context_.data.camera;
  kernel::FootprintLimits limits{};
  std::copy(std::begin(camera.eye), std::end(camera.eye), limits.eye);
  limits.sharpness = camera.step_x / std::sqrt(static_cast<float>(samples_));
  // Two sides reach to the farthest corner of a tent.
  limits.largest = map_.radius / 2.0f;
  return limits;
}

void PhotonGrid::add(const PhotonRuns& runs) {
  Device& device = context_.device;
  const uint32_t n_runs = static_cast<uint32_t>(runs.reports.size());
  std::vector<kernel::PhotonRunData> reports = runs.reports;
  if (context_.features.footprints) {
    const kernel::FootprintLimits limits = footprint_limits();
    cl::Kernel count = context_.kernels.get("count_footprints"), place = context_.kernels.get("place_footprints");
    set_arguments(count, 0, n_runs, runs.length, runs.lattice, limits, map_.grid, buckets(), runs.photons, runs.landings,
                  runs.counts, runs.on_device);
    device.launch_singly("footprints", count, n_runs);
    reports = device.read(runs.on_device, 0, n_runs);  // with the box around entries for that around photons
    make_room(runs);
    set_arguments(place, 0, n_runs, runs.length, runs.lattice, limits, map_.grid, buckets(), runs.photons, runs.landings,
                  places_, runs.on_device, map_.photons);
    device.launch_singly("footprints", place, n_runs);
  } else {
    make_room(runs);
    cl::Kernel kernel = context_.kernels.get("sort_into_buckets");
    set_arguments(kernel, 0, n_runs, runs.length, buckets(), map_.grid.bucket_shift, runs.on_device, runs.photons, places_,
                  map_.photons);
    device.launch_singly("sort", kernel, n_runs);
  }

  for (const kernel::PhotonRunData& run : reports)
    for (size_t axis = 0; axis < 3; ++axis) {
      map_.low[axis] = std::min(map_.low[axis], run.low[axis]);
      map_.high[axis] = std::max(map_.high[axis], run.high[axis]);
    }
}

void PhotonGrid::finish() {
  Device& device = context_.device;
  const std::vector<uint32_t>& counts = map_.bucket_counts;
  map_.count = std::accumulate(counts.begin(), counts.end(), 0u);
  std::vector<kernel::BucketData> buckets;
  std::vector<uint32_t> by_size;
  for (uint32_t bucket = 0; bucket < counts.size(); ++bucket) {
    buckets.push_back({room_[bucket].start / (MAP_BLOCK / row_), {}, {}, {}, {}});
    by_size.push_back(bucket);
  }

  // The largest buckets first, each to the worker that has least to do. All scratch together is about a quarter of the
  // map, at least that of the largest bucket.
  std::stable_sort(by_size.begin(), by_size.end(), [&](uint32_t a, uint32_t b) { return counts[a] > counts[b]; });
  const uint32_t largest = std::max(counts[by_size.front()], 1u);
  const uint32_t workers = std::clamp(map_.count / 4 / largest, 1u, 2 * device.info().compute_units);
  std::vector<std::vector<uint32_t>> buckets_of(workers);
  std::vector<uint64_t> load(workers, 0);
  for (uint32_t bucket : by_size) {
    const size_t worker = static_cast<size_t>(std::min_element(load.begin(), load.end()) - load.begin());
    buckets_of[worker].push_back(bucket);
    load[worker] += counts[bucket] + 64;
  }
  std::vector<uint32_t> tasks, first_task, first_scratch;
  uint32_t scratch = 0;
  for (const std::vector<uint32_t>& own : buckets_of) {
    first_task.push_back(static_cast<uint32_t>(tasks.size()));
    first_scratch.push_back(scratch);
    tasks.insert(tasks.end(), own.begin(), own.end());
    if (!own.empty()) scratch += kernel::map_floats(counts[own.front()], map_.fields) / MAP_BLOCK;
  }
  first_task.push_back(static_cast<uint32_t>(tasks.size()));

  const auto fill = [&device]<typename T>(Buffer<T>& buffer, const std::vector<T>& values) {
    if (buffer.size() < values.size()) buffer = device.allocate<T>(values.size(), "photon map");
    device.write(buffer, values);
  };
  const auto reserve = [&device]<typename T>(Buffer<T>& buffer, size_t size) {
    if (buffer.size() < size) buffer = device.allocate<T>(size, "photon map");
  };
  fill(map_.buckets, buckets);
  fill(counts_, counts);
  fill(tasks_, tasks);
  fill(first_task_, first_task);
  fill(first_scratch_, first_scratch);
  const size_t cells = size_t{1} << log2_cells(map_.grid);
  reserve(scratch_, size_t{scratch} * MAP_BLOCK);
  reserve(next_of_cell_, cells);
  reserve(map_.first_of_cell, cells + counts.size());
  cl::Kernel kernel = context_.kernels.get("sort_into_cells");
  set_arguments(kernel, 0, workers, map_.grid.bucket_shift, tasks_, first_task_, first_scratch_, counts_, map_.buckets,
                scratch_, next_of_cell_, map_.first_of_cell, map_.photons);
  device.launch_singly("sort", kernel, workers);
}

}  // namespace vitrum
