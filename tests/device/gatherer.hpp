#pragma once
// Photons and places to gather them at, and the kernels that do so, for tests and benchmarks.

#include <bit>
#include <cmath>
#include <stdexcept>

#include "render/photon_grid.hpp"
#include "render/photon_pass.hpp"
#include "render/photon_tree.hpp"

namespace vitrum {

/// A surface that scatters.
struct Query {
  glm::vec3 position{0}, normal{0, 1, 0};
  glm::vec3 diffuse{1};
};

/// A photon as it is stored.
inline cl_float8 photon(glm::vec3 p, glm::vec3 direction, glm::vec3 power) {
  uint32_t packed = 0;
  for (int axis = 0; axis < 3; ++axis)
    packed |= (static_cast<uint32_t>(std::lrint(direction[axis] * 511.0f)) & 1023u) << (10 * axis);
  return {{p.x, p.y, p.z, std::bit_cast<float>(packed), power.x, power.y, power.z, 0}};
}

/// The device with the kernels that sort and gather.
class Gatherer {
 public:
  explicit Gatherer(unsigned group_size, const KernelFiles& files = {})
      : device_("", group_size),
        programs_(device_, files, {"photon_sort", "gather", "gather_nearest"}, Features{}.build_options()),
        context_{device_, programs_, scene_, data_, device_scene_, features_} {}

  std::vector<glm::vec3> within(const std::vector<cl_float8>& photons, const std::vector<Query>& queries, float radius) {
    scene_.photons.estimate = PhotonEstimate::fixed_radius;
    scene_.photons.radius = static_cast<double>(radius);
    PhotonMap map = stored(photons);
    PhotonGrid(context_).sort(map);
    return run(queries, "gather", [&](cl::Kernel& kernel, auto count, auto stride, auto&... buffers) {
      const cl_float4 low = {{map.low[0], map.low[1], map.low[2], 0}};
      const cl_float4 high = {{map.high[0], map.high[1], map.high[2], 0}};
      set_arguments(kernel, 0, count, stride, map.grid, map.radius, low, high, map.stride, map.first_of_cell,
                    map.sorted, buffers...);
    });
  }

  std::vector<glm::vec3> nearest(const std::vector<cl_float8>& photons, const std::vector<Query>& queries, uint32_t k,
                            float max_radius) {
    PhotonMap map = stored(photons);
    fill_photon_tree(device_, map, static_cast<double>(max_radius));
    return run(queries, "gather_nearest", [&](cl::Kernel& kernel, auto count, auto stride, auto&... buffers) {
      set_arguments(kernel, 0, count, stride, k, map.radius, map.tree, map.nodes, map.leaves, buffers...);
    });
  }

  /// Seconds that the kernels ran, by stage.
  std::map<std::string, double> seconds() { return device_.stage_seconds(); }

 private:
  PhotonMap stored(const std::vector<cl_float8>& photons) {
    PhotonMap map;
    map.count = static_cast<uint32_t>(photons.size());
    map.photons = device_.upload(photons, "photons");
    return map;
  }

  /// Radiance of the queries.
  template <typename SetArguments>
  std::vector<glm::vec3> run(const std::vector<Query>& queries, const char* name, SetArguments set) {
    const uint32_t count = static_cast<uint32_t>(queries.size()), stride = padded(count);
    std::vector<float> surfaces(size_t{SURFACE_FIELDS} * stride), scatter(size_t{SCATTER_FIELDS} * stride);
    for (size_t i = 0; i < count; ++i)
      for (int axis = 0; axis < 3; ++axis) {
        const auto row = static_cast<size_t>(axis);
        surfaces[(SURFACE_POSITION + row) * stride + i] = queries[i].position[axis];
        scatter[(SCATTER_NORMAL + row) * stride + i] = queries[i].normal[axis];
        scatter[(SCATTER_DIFFUSE + row) * stride + i] = queries[i].diffuse[axis];
      }
    const Buffer<float> on_device[] = {device_.upload(surfaces, "test"), device_.upload(scatter, "test"),
                                       device_.upload(std::vector<float>(size_t{SHARE_FIELDS} * stride), "test")};
    cl::Kernel kernel = programs_.kernel(name, name);
    set(kernel, count, stride, on_device[0], on_device[1], on_device[2]);
    device_.launch(name, kernel, count);
    const std::vector<float> shares = device_.read(on_device[2], 0, size_t{SHARE_FIELDS} * stride);
    std::vector<glm::vec3> radiance(count);
    size_t unlike = 0;
    for (size_t i = 0; i < count; ++i)
      for (int axis = 0; axis < 3; ++axis) {
        const auto row = static_cast<size_t>(axis);
        radiance[i][axis] = shares[(SHARE_BEAUTY + row) * stride + i];
        unlike += shares[(SHARE_CAUSTICS + row) * stride + i] != radiance[i][axis];
      }
    if (unlike > 0) throw std::logic_error("caustics and beauty differ");
    return radiance;
  }

  Device device_;
  Programs programs_;
  Scene scene_;
  SceneData data_;
  DeviceScene device_scene_;
  Features features_;
  KernelContext context_;
};

}  // namespace vitrum
