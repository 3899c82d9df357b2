#include "render/patch_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/photon_pass.hpp"

namespace vitrum {
namespace {

constexpr uint32_t photons_at_once = 1u << 16;  // their rows take 22 MB
constexpr uint32_t tile_size = 32;              // [spots]
constexpr size_t most_spots = 8'000'000;
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

/// Are both the same plane, seen from the same side? As a patch's plane is compared with a pixel's; fields are `stride` apart.
bool is_same_plane(const float* a, const float* b, size_t stride) {
  const float along = a[0] * b[0] + a[stride] * b[stride] + a[2 * stride] * b[2 * stride];
  return along > VIEW_SAME_NORMAL && std::abs(a[VIEW_OFFSET * stride] - b[VIEW_OFFSET * stride]) <=
                                std::min(a[VIEW_TOLERANCE * stride], b[VIEW_TOLERANCE * stride]);
}

}  // namespace

PatchView::PatchView(const KernelContext& context) : context_(context) {
  Device& device = context.device;
  const auto width = static_cast<uint32_t>(context.scene.film.width), height = static_cast<uint32_t>(context.scene.film.height);
  // Texture and irradiance of a pixel are not independent. Taking the mean of each spot is wrong by less than the camera's noise.
  const int samples = context.scene.render.by_rounds() ? 16 : context.scene.render.samples;
  layout_.detail = !context.features.textures || samples < 16 ? 1 : samples < 64 ? 2 : 4;
  while (layout_.detail > 1 && size_t{layout_.detail} * layout_.detail * width * height > most_spots) layout_.detail /= 2;
  layout_.plane_stride = padded(uint64_t{width} * height);
  layout_.pitch = (layout_.detail * width + tile_size - 1) / tile_size * tile_size;
  layout_.spot_stride = padded(uint64_t{layout_.pitch} * layout_.detail * height);

  const uint32_t corners = (width + 1) * (height + 1), corner_stride = padded(corners);
  const Buffer<float> at_corners = device.allocate<float>(size_t{VIEW_FIELDS} * corner_stride, "caustic seen directly");
  cl::Kernel look = context.kernels.get("look_at_corners");
  const unsigned next = context.device_scene.set_arguments(look);
  set_arguments(look, next, context.device_scene.camera, context.data.eye_media, corner_stride, at_corners);
  device.launch("patches: look", look, device.packets(corners));
  std::vector<float> fields;    // by field and corner
  for (size_t field = 0; field < VIEW_FIELDS; ++field) {
    const std::vector<float> values = device.read(at_corners, field * corner_stride, corners);
    fields.insert(fields.end(), values.begin(), values.end());
  }
  // Do the four corners of a pixel show one plane? Beyond the picture's borders they may.
  std::vector<uint8_t> at_own_corners(size_t{width + 2} * (height + 2), 1);
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x) {
      const float* corner = &fields[y * (width + 1) + x];
      at_own_corners[(y + 1) * (width + 2) + x + 1] = is_same_plane(corner, corner + 1, corners) &&
                                                      is_same_plane(corner, corner + width + 1, corners) &&
                                                      is_same_plane(corner, corner + width + 2, corners);
    }
  // A pixel shows one plane if its neighbours do so too, so that what ends just beside it is none of it.
  std::vector<float> planes(size_t{VIEW_FIELDS} * layout_.plane_stride, 0.0f);
  std::fill_n(planes.begin(), layout_.plane_stride, nan);
  is_all_ = true;
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x) {
      bool is_one = true;
      for (uint32_t row = y; row < y + 3; ++row)
        for (uint32_t column = x; column < x + 3; ++column) is_one &= at_own_corners[row * (width + 2) + column] != 0;
      is_all_ &= is_one;
      if (!is_one) continue;
      for (size_t field = 0; field < VIEW_FIELDS; ++field)
        planes[field * layout_.plane_stride + y * width + x] = fields[size_t{field} * corners + y * (width + 1) + x];
    }
  planes_ = device.upload(planes, "caustic seen directly");
  irradiance_ = device.allocate<float>(size_t{3} * layout_.spot_stride, "caustic seen directly");
  device.fill_zero(irradiance_);
}

void PatchView::start() { context_.device.fill_zero(irradiance_); }

bool PatchView::add(const PhotonRuns& runs, const kernel::FootprintLimits& limits) {
  Device& device = context_.device;
  const auto all_runs = static_cast<uint32_t>(runs.reports.size()), most_runs = photons_at_once / runs.length;
  const uint32_t at_once = std::min(all_runs, most_runs);
  if (reports_.size() < at_once) {
    rows_ = device.allocate<float>(size_t{PATCH_ROW} * kernel::patches_stride(runs.length) * at_once, "caustic seen directly");
    boxes_ = device.allocate<float>(size_t{4} * kernel::patch_boxes(runs.length) * at_once, "caustic seen directly");
    reports_ = device.allocate<kernel::PatchRunData>(at_once, "caustic seen directly");
  }
  const uint32_t height = layout_.detail * static_cast<uint32_t>(context_.scene.film.height);
  const size_t tiles = size_t{layout_.pitch / tile_size} * ((height + tile_size - 1) / tile_size);
  cl::Kernel project = context_.kernels.get("project_patches"), draw = context_.kernels.get("draw_patches");
  bool has_room = true;
  for (uint32_t first = 0; first < all_runs; first += at_once) {
    const uint32_t n_runs = std::min(at_once, all_runs - first);
    set_arguments(project, 0, context_.device_scene.camera, layout_.detail, first, n_runs, runs.length, runs.lattice, limits, runs.photons,
                  runs.landings, runs.on_device, rows_, boxes_, reports_);
    device.launch_singly("patches: project", project, n_runs);
    set_arguments(draw, 0, context_.device_scene.camera, n_runs, runs.length, tile_size, rows_, boxes_, reports_, layout_,
                  planes_, irradiance_);
    device.launch_singly("patches: draw", draw, tiles);
    for (const kernel::PatchRunData& run : device.read(reports_, 0, n_runs)) has_room &= run.too_many == 0;
  }
  return has_room;
}

void PatchView::give_up() {
  context_.device.write(planes_, std::vector<float>(planes_.size(), nan));
  is_all_ = false;
}

unsigned PatchView::set_arguments_of(cl::Kernel& kernel, unsigned first) const {
  set_arguments(kernel, first, layout_, planes_, irradiance_);
  return first + 3;
}

}  // namespace vitrum
