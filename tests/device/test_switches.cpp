// The kernels under every switch and at every width. tools/check_races runs this file under oclgrind too, so its scenes
// are small.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "device/interface.hpp"
#include "device/kernels.hpp"
#include "render/render.hpp"
#include "verify/fresnel_inputs.hpp"
#include "verify/switch_scenes.hpp"

namespace vitrum {
namespace {

constexpr unsigned widths[] = {1, 4, 8, 16};

/// The values that each -D switch takes over the scenes.
std::map<std::string, std::set<std::string>> switches_of(const std::vector<NamedScene>& scenes) {
  std::map<std::string, std::set<std::string>> values;
  for (const NamedScene& s : scenes) {
    std::istringstream options(scene_features(s.scene).build_options());
    for (std::string option; options >> option;)
      values[option.substr(2, option.find('=') - 2)].insert(option.substr(option.find('=') + 1));
  }
  return values;
}

}  // namespace

TEST_CASE("switches: the scenes take each both ways") {
  const auto values = switches_of(switch_scenes(1, 1));
  for (const auto& [name, taken] : values) {
    CAPTURE(name);
    if (name.rfind("HAS_", 0) == 0) CHECK(taken == std::set<std::string>{"0", "1"});
  }
  CHECK(values.at("CAUSTICS").size() == 4);
  CHECK(values.at("CAMERA_STACK").size() == 2);
  CHECK(values.at("LIGHT_KINDS").contains("63"));
  CHECK(values.contains("CONSTANT_REFLECTANCE"));
}

TEST_CASE("switches: pictures are the same at every width") {
  std::vector<NamedScene> scenes = switch_scenes(6, 300);
  // More than one run of 1024, so that oclgrind sees work-items of the photons' kernels side by side.
  scenes.push_back({"runs of photons", clear_ball(1, 2100)});
  // Photons lie in another order, so sums of up to 80 of them round in another way.
  constexpr double rounding = 80 * 0x1p-23;
  RenderOptions options;
  options.views = {View::beauty, View::photons, View::caustics, View::albedo, View::normal, View::depth};
  for (const NamedScene& s : scenes) {
    CAPTURE(s.name);
    std::vector<RenderResult> results;
    for (const unsigned width : widths) {
      Device device("", 32, width);
      results.push_back(render(s.scene, device, options));
    }
    const RenderResult& first = results.front();
    if (first.features.caustics) CHECK(first.photons.photons_stored > 0);
    for (size_t k = 1; k < results.size(); ++k) {
      CAPTURE(widths[k]);
      CHECK(results[k].photon_radius == first.photon_radius);
      CHECK(results[k].photons.photons_stored == first.photons.photons_stored);
      CHECK(results[k].photons.photons_absorbed == first.photons.photons_absorbed);
      CHECK(results[k].photons.photons_lost == first.photons.photons_lost);
      for (const std::string& name : first.film.names()) {
        CAPTURE(name);
        const bool sums_photons = first.features.caustics && (name == "radiance" || name == "caustics");
        const std::vector<double> one = first.film.mean(name), other = results[k].film.mean(name);
        size_t differing = 0;
        for (size_t i = 0; i < one.size(); ++i)
          differing += !(one[i] == other[i] ||
                         (sums_photons && std::abs(one[i] - other[i]) <= rounding * std::abs(one[i])));
        CHECK(differing == 0);
      }
    }
  }
}

TEST_CASE("switches: the kernels of checks are the same at every width") {
  constexpr uint32_t count = 64;
  const struct {
    const char* kernel;
    size_t inputs, outputs;
  } kernels[] = {{"border", 11, 12}, {"medium", 3, 3}};
  for (const auto& k : kernels) {
    CAPTURE(k.kernel);
    FresnelInputs inputs(1);
    std::vector<float> in(count * k.inputs);
    const auto set = [&in](uint32_t i, std::initializer_list<float> values) {
      for (size_t field = 0; const float value : values) in[count * field++ + i] = value;
    };
    for (uint32_t i = 0; i < count; ++i) {
      if (k.inputs == 3) {
        const auto [sigma_a, distance] = inputs.absorbing_path();
        set(i, {sigma_a, distance, inputs.reflectance()});
      } else {
        const Indices n = inputs.glass();
        const kernel::InterfaceData b = make_interface(n.n_i, n.n_t);
        const float c = std::min(inputs.cosine(n), 1.0f), s = std::sqrt((1 - c) * (1 + c));
        set(i, {b.eta, b.eta_inverse, b.k_hi, b.k_lo, c, s, -c, 0, 0, 1, 0});
      }
    }
    std::vector<std::vector<float>> results;
    for (const unsigned width : widths) {
      Device device("", 32, width);
      const cl::Program program =
          device.build("checks/fresnel.cl", kernel_source({}, {"checks/fresnel.cl"}), "-cl-std=CL1.2");
      cl::Kernel kernel(program, k.kernel);
      const auto from = device.upload(in, "test inputs");
      const auto to = device.allocate<float>(count * k.outputs, "test outputs");
      set_arguments(kernel, 0, from, to, count);
      device.launch("test", kernel, count / width);
      results.push_back(device.read(to, 0, to.size()));
    }
    for (const std::vector<float>& result : results) {
      const bool same_bits = std::memcmp(result.data(), results[0].data(), result.size() * sizeof(float)) == 0;
      CHECK(same_bits);
    }
  }
}

}  // namespace vitrum
