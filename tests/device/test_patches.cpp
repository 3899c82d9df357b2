// Patches of light drawn into a picture, against the areas of clipped polygons in double.
#include <doctest/doctest.h>

#include <bit>
#include <functional>
#include <random>

#include "device/kernel_headers.hpp"
#include "device/kernels.hpp"
#include "device/opencl.hpp"
#include "scene/features.hpp"

using namespace vitrum;
using glm::dvec2;

namespace {

constexpr uint32_t width = 70, height = 45, tile_size = 32, run_length = 64;
constexpr double power[3] = {1.0, 0.5, 0.25};

/// A row of kernels/patch.h: a quadrangle's corners [pixels], or a tent's middle and half widths.
struct Patch {
  dvec2 corners[4];
  double scales[2] = {1.0, 1.0};
  bool is_tent = false;
};

Patch tent(const dvec2& middle, const dvec2& half_widths) { return {{middle, half_widths, {}, {}}, {1.0, 0.0}, true}; }

/// Draws patches on a picture that shows one plane, or, on its right side, another.
class DrawKernel {
 public:
  DrawKernel(unsigned vector_width, uint32_t detail) : device_("", 32, vector_width), detail_(detail) {
    Features features;
    features.caustics = features.footprints = true;
    kernel_ = cl::Kernel(device_.build("stages/patch_drawing.cl", kernel_source({}, {"stages/patch_drawing.cl"}),
                                       "-cl-std=CL1.2" + features.build_options()),
                         "draw_patches");
  }

  /// Red, green and blue of each spot. `shown`: pixels from there on show another plane.
  std::vector<double> operator()(const std::vector<Patch>& patches, uint32_t shown = width) {
    const uint32_t stride = width * height, pitch = (detail_ * width + tile_size - 1) / tile_size * tile_size;
    std::vector<float> planes(VIEW_FIELDS * stride), rows, boxes;
    for (uint32_t pixel = 0; pixel < stride; ++pixel) {
      const bool other = pixel % width >= shown;
      planes[(VIEW_NORMAL + 1) * stride + pixel] = 1.0f;
      planes[VIEW_OFFSET * stride + pixel] = other ? 2.001f : 2.0f;
      planes[VIEW_TOLERANCE * stride + pixel] = 1e-4f;
    }
    const uint32_t n_runs = (static_cast<uint32_t>(patches.size()) + run_length - 1) / run_length;
    std::vector<kernel::PatchRunData> runs(n_runs, kernel::PatchRunData{});
    rows.resize(size_t{PATCH_ROW} * kernel::patches_stride(run_length) * n_runs);
    boxes.resize(size_t{4} * kernel::patch_boxes(run_length) * n_runs);
    for (size_t i = 0; i < patches.size(); ++i) {
      const size_t run = i / run_length, k = i % run_length;
      float* row = &rows[PATCH_ROW * (run * kernel::patches_stride(run_length) + k)];
      const auto d = static_cast<double>(detail_);
      for (size_t corner = 0; corner < 4; ++corner) {
        row[PATCH_CORNER + 2 * corner] = static_cast<float>(d * patches[i].corners[corner].x);
        row[PATCH_CORNER + 2 * corner + 1] = static_cast<float>(d * patches[i].corners[corner].y);
      }
      for (size_t channel = 0; channel < 3; ++channel) row[PATCH_POWER + channel] = static_cast<float>(power[channel]);
      for (size_t half = 0; half < 2; ++half) row[PATCH_SCALE + half] = static_cast<float>(d * d * patches[i].scales[half]);
      if (patches[i].is_tent) row[PATCH_SCALE + 1] = PATCH_TENT;
      row[PATCH_NORMAL + 1] = 1.0f;
      row[PATCH_OFFSET] = 2.0f;
      ++runs[run].rows;
      float* box = &boxes[4 * (run * kernel::patch_boxes(run_length) + k / PATCH_BLOCK)];
      const auto grow = [&](float x, float y, bool begins) {
        box[0] = begins ? x : std::min(box[0], x);
        box[1] = begins ? y : std::min(box[1], y);
        box[2] = begins ? x : std::max(box[2], x);
        box[3] = begins ? y : std::max(box[3], y);
      };
      if (patches[i].is_tent) {
        grow(row[0] - row[2], row[1] - row[3], k % PATCH_BLOCK == 0);
        grow(row[0] + row[2], row[1] + row[3], false);
      } else {
        for (size_t corner = 0; corner < 4; ++corner)
          grow(row[2 * corner], row[2 * corner + 1], corner == 0 && k % PATCH_BLOCK == 0);
      }
    }
    const kernel::ViewLayout layout{detail_, stride, pitch, pitch * detail_ * height};
    kernel::CameraData camera{};
    camera.width = width;
    camera.height = height;
    const auto irradiance = device_.allocate<float>(3 * size_t{layout.spot_stride}, "test outputs");
    device_.fill_zero(irradiance);
    const auto camera_data = device_.upload<kernel::CameraData>({camera}, "test inputs");
    const auto on_device = device_.upload(rows, "test inputs"), boxes_on_device = device_.upload(boxes, "test inputs");
    const auto reports = device_.upload(runs, "test inputs");
    const auto planes_on_device = device_.upload(planes, "test inputs");
    set_arguments(kernel_, 0, camera_data, n_runs, run_length, tile_size, on_device, boxes_on_device, reports, layout,
                  planes_on_device, irradiance);
    device_.launch_singly("test", kernel_, size_t{pitch / tile_size} * ((detail_ * height + tile_size - 1) / tile_size));
    const std::vector<float> spots = device_.read(irradiance, 0, irradiance.size());
    std::vector<double> picture;
    for (uint32_t y = 0; y < detail_ * height; ++y)
      for (uint32_t x = 0; x < detail_ * width; ++x)
        for (size_t channel = 0; channel < 3; ++channel)
          picture.push_back(static_cast<double>(spots[channel * layout.spot_stride + y * pitch + x]));
    return picture;
  }

 private:
  Device device_;
  uint32_t detail_;
  cl::Kernel kernel_;
};

double twice_area(const std::vector<dvec2>& polygon) {
  double sum = 0;
  for (size_t k = 0; k < polygon.size(); ++k) {
    const dvec2 &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    sum += a.x * b.y - a.y * b.x;
  }
  return sum;
}

/// Sutherland and Hodgman: what of a polygon lies where sign * (p[axis] - at) >= 0.
std::vector<dvec2> clipped(const std::vector<dvec2>& polygon, int axis, double at, double sign) {
  std::vector<dvec2> inside;
  for (size_t k = 0; k < polygon.size(); ++k) {
    const dvec2 &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    const double da = sign * (a[axis] - at), db = sign * (b[axis] - at);
    if (da >= 0) inside.push_back(a);
    if ((da >= 0) != (db >= 0)) inside.push_back(a + da / (da - db) * (b - a));
  }
  return inside;
}

/// Share of a triangle in a spot.
double share_of(const dvec2& a, const dvec2& b, const dvec2& c, double x, double y, double size) {
  const std::vector<dvec2> triangle = {a, b, c};
  const auto within = clipped(clipped(clipped(clipped(triangle, 0, x, 1), 0, x + size, -1), 1, y, 1), 1, y + size, -1);
  return within.empty() ? 0.0 : std::abs(twice_area(within) / twice_area(triangle));
}

double tent_below(double t) {
  t = std::clamp(t, -1.0, 1.0);
  return t < 0 ? 0.5 * (1 + t) * (1 + t) : 1 - 0.5 * (1 - t) * (1 - t);
}

/// Adds a patch to a picture in red of spots with `detail` along each side of a pixel.
void add_truth(const Patch& patch, uint32_t detail, std::vector<double>& picture) {
  const double size = 1.0 / detail;
  for (uint32_t row = 0; row < detail * height; ++row)
    for (uint32_t column = 0; column < detail * width; ++column) {
      const double x = size * column, y = size * row;
      double share = 0;
      if (patch.is_tent) {
        const dvec2 m = patch.corners[0], h = patch.corners[1];
        share = patch.scales[0] * (tent_below((x + size - m.x) / h.x) - tent_below((x - m.x) / h.x)) *
                (tent_below((y + size - m.y) / h.y) - tent_below((y - m.y) / h.y));
      } else {
        for (int k = 0; k < 2; ++k)
          share += 0.5 * patch.scales[k] * share_of(patch.corners[0], patch.corners[1 + k], patch.corners[2 + k], x, y, size);
      }
      picture[row * detail * width + column] += power[0] * share * detail * detail;
    }
}

using Random = std::mt19937_64;
double uniform(Random& random, double low, double high) { return std::uniform_real_distribution<>(low, high)(random); }

/// A convex quadrangle of about `size` pixels, its corners floats in the picture.
Patch quadrangle(Random& random, double size) {
  const dvec2 middle(uniform(random, -5, width + 5), uniform(random, -5, height + 5));
  const double turn = uniform(random, 0, 7), sign = uniform(random, -1, 1) < 0 ? -1 : 1;
  Patch patch;
  for (int k = 0; k < 4; ++k) {
    const double angle = turn + sign * (1.5707963 * k + uniform(random, -0.5, 0.5));
    const dvec2 corner = middle + size * uniform(random, 0.5, 1) * dvec2(std::cos(angle), std::sin(angle));
    patch.corners[k] = dvec2(glm::vec2(corner));
  }
  patch.scales[0] = uniform(random, 0.5, 2);
  patch.scales[1] = uniform(random, 0.5, 2);
  return patch;
}

double sum_of(const std::vector<double>& picture, size_t channel) {
  double sum = 0;
  for (size_t i = channel; i < picture.size(); i += 3) sum += picture[i];
  return sum;
}

/// Largest error of red in a spot, for patches one by one.
double worst_of(const std::vector<Patch>& patches, DrawKernel& draw, uint32_t detail) {
  double worst = 0;
  for (const Patch& patch : patches) {
    const std::vector<double> drawn = draw({patch});
    std::vector<double> truth(size_t{width} * height * detail * detail, 0.0);
    add_truth(patch, detail, truth);
    for (size_t i = 0; i < truth.size(); ++i) worst = std::max(worst, std::abs(drawn[3 * i] - truth[i]));
    // The channels differ in power alone.
    CHECK(sum_of(drawn, 1) == doctest::Approx(0.5 * sum_of(drawn, 0)).epsilon(1e-5));
    CHECK(sum_of(drawn, 2) == doctest::Approx(0.25 * sum_of(drawn, 0)).epsilon(1e-5));
  }
  return worst;
}

}  // namespace

TEST_CASE("patches: each spot takes the share of a quadrangle's triangles that lies in it") {
  for (const uint32_t detail : {1u, 2u, 4u}) {
    DrawKernel draw(detail == 1 ? 1 : 8, detail);
    CAPTURE(detail);
    Random random(7);
    // Where corners are floats, their edges are off by 4e-6 pixels, and a density of size^-2 is by that times a spot's sides.
    for (const double size : {0.05, 0.3, 1.0, 3.0, 20.0, 100.0}) {
      CAPTURE(size);
      std::vector<Patch> patches;
      for (int k = 0; k < 12; ++k) patches.push_back(quadrangle(random, size));
      const double worst = worst_of(patches, draw, detail);
      MESSAGE("spots of " << 1.0 / detail << " pixels, quadrangles of " << size << ": off by " << worst);
      CHECK(worst < 1e-4 * detail * detail / std::max(size * size, 0.25));
    }
    // Corners on borders of spots, and edges along them.
    const std::vector<Patch> even = {{{{4, 4}, {8, 4}, {8, 9}, {4, 9}}},
                                     {{{31, 31}, {33, 31}, {33, 33}, {31, 33}}},
                                     {{{10, 10}, {10, 14}, {14, 14}, {14, 10}}},
                                     {{{-10, -10}, {80, -10}, {80, 60}, {-10, 60}}},
                                     {{{0.25, 40}, {69.75, 44.75}, {69.75, 45}, {0.25, 45}}}};
    CHECK(worst_of(even, draw, detail) < 2e-6 * detail * detail);
  }
}

TEST_CASE("patches: tents are taken by their integral") {
  DrawKernel draw(4, 2);
  Random random(8);
  std::vector<Patch> tents;
  for (int k = 0; k < 24; ++k)
    tents.push_back(tent(dvec2(glm::vec2(uniform(random, -4, 74), uniform(random, -4, 49))),
                         dvec2(glm::vec2(std::exp2(uniform(random, -6, 5)), std::exp2(uniform(random, -6, 5))))));
  CHECK(worst_of(tents, draw, 2) < 1e-4);
}

TEST_CASE("patches: nothing of their power is lost, however thin they are") {
  DrawKernel draw(16, 1);
  Random random(9);
  for (const double thickness : {1e-1, 1e-2, 3e-3, 1e-3, 3e-4, 1e-5, 0.0}) {
    CAPTURE(thickness);
    double worst = 0, astray = 0;
    for (int k = 0; k < 40; ++k) {
      const double turn = uniform(random, 0, 7), length = uniform(random, 0.1, 18);
      const dvec2 along(std::cos(turn), std::sin(turn)), across(-along.y, along.x);
      const dvec2 start(uniform(random, 26, 44), uniform(random, 26, 19));
      Patch patch;
      for (int c = 0; c < 4; ++c)
        patch.corners[c] = dvec2(glm::vec2(start + (c == 1 || c == 2 ? length * 0.9 : 0.0) * along + (c >= 2 ? thickness : 0.0) * across));
      if (k % 2) patch.corners[2] = dvec2(glm::vec2(start - 0.1 * length * along));    // goes back
      const std::vector<double> drawn = draw({patch});
      worst = std::max(worst, std::abs(sum_of(drawn, 0) - 1));
      // The middle of what was drawn is that of the triangles, within what a pixel hides.
      dvec2 centre(0), truth(0);
      for (uint32_t i = 0; i < width * height; ++i)
        centre += drawn[3 * i] * dvec2(i % width + 0.5, i / width + 0.5);
      for (int t = 0; t < 2; ++t) truth += (patch.corners[0] + patch.corners[1 + t] + patch.corners[2 + t]) / 6.0;
      astray = std::max(astray, glm::length(centre - truth));
    }
    MESSAGE("thickness " << thickness << ": power off by " << worst << ", place by " << astray);
    // Lines keep all of it; areas are as good as places are in comparison.
    CHECK(worst < (thickness < 2e-3 ? 1e-6 : 2e-6 / thickness));
    CHECK(astray < 0.75);
  }
}

TEST_CASE("patches: they add up, run by run and across tiles, and only where their plane is seen") {
  DrawKernel draw(8, 1);
  Random random(10);
  std::vector<Patch> patches;
  for (int k = 0; k < 300; ++k) patches.push_back(quadrangle(random, 4));
  for (int k = 0; k < 20; ++k) patches.push_back(tent({uniform(random, 0, 70), uniform(random, 0, 45)}, {5, 3}));
  std::vector<double> truth(size_t{width} * height, 0.0);
  for (const Patch& patch : patches) add_truth(patch, 1, truth);
  for (const uint32_t shown : {width, 37u, 3u}) {
    CAPTURE(shown);
    const std::vector<double> drawn = draw(patches, shown);
    double worst = 0;
    for (uint32_t i = 0; i < truth.size(); ++i)
      worst = std::max(worst, std::abs(drawn[3 * i] - (i % width < shown ? truth[i] : 0.0)));
    CHECK(worst < 1e-4);
  }
}
