// kernels/fresnel.cl on the device against the same text compiled for the host.
#include <doctest/doctest.h>

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "device/interface.hpp"
#include "device/kernels.hpp"
#include "device/opencl.hpp"
#include "verify/fresnel_inputs.hpp"

using namespace vitrum;

namespace {

constexpr uint32_t batch = 1u << 18;
constexpr uint32_t batches = 40;             // 10,485,760 inputs

/// What may lie between host and device in one output: floats, or for amplitudes and components of directions, which
/// pass through 0, an absolute difference.
struct Output {
  std::string name;
  double floats, absolute;
};

// The host rounds division and sqrt correctly; OpenCL 1.2 (7.4) allows the device 2.5 and 3 ulp. With u = 2^-24, of
// which an ulp is at most two: Q differs by 7u, w and e by 15u, r by 34u, b by 26u absolute; so R by 100u and T by 44u
// of their size. bend (and so the directions) differs by 19u of its size: at most 10 here.
constexpr double u = 0x1p-24;
const std::vector<Output> border_outputs = {
    {"R", 100, 0},           {"T", 44, 0},            {"r_perp", 34, 0},       {"r_par", 0, 64 * u},
    {"bend", 20, 0},         {"total", 0, 0},         {"refracted.x", 0, 1e-4}, {"refracted.y", 0, 1e-4},
    {"refracted.z", 0, 1e-4}, {"reflected.x", 0, 0},   {"reflected.y", 0, 0},   {"reflected.z", 0, 0}};
// Attenuation takes no function that a device may round in its own way; denormals may be flushed. The quotient: 2.5 and
// .5.
const std::vector<Output> medium_outputs = {{"transmittance", 0, 0}, {"absorptance", 0, 0x1p-126}, {"sigma_a", 3, 0}};

void set(std::vector<float>& fields, uint32_t i, uint32_t first, std::initializer_list<float> values) {
  for (const float value : values) fields[size_t{batch} * first++ + i] = value;
}

/// Runs kernel and host over `rounds` batches and holds them against each other.
class Comparison {
 public:
  Comparison(Device& device, unsigned width, const char* kernel, uint32_t n_inputs, const std::vector<Output>& outputs)
      : device_(device),
        width_(width),
        outputs_(outputs),
        differing_(outputs.size()),
        most_floats_(outputs.size()),
        most_(outputs.size()),
        inputs_(size_t{batch} * n_inputs),
        expected_(size_t{batch} * outputs.size()) {
    kernel_ = cl::Kernel(device.build("checks/fresnel.cl",
                                      "#undef WIDTH\n#define WIDTH " + std::to_string(width) + "\n" +
                                          kernel_source({}, {"checks/fresnel.cl"}),
                                      "-cl-std=CL1.2"),
                         kernel);
  }

  /// `fill` makes input i and the host's outputs of it.
  void run(uint32_t rounds, const std::function<void(uint32_t, std::vector<float>&, std::vector<float>&)>& fill) {
    for (uint32_t round = 0; round < rounds; ++round) {
      for (uint32_t i = 0; i < batch; ++i) fill(i, inputs_, expected_);
      const auto in = device_.upload(inputs_, "test inputs");
      const auto out = device_.allocate<float>(expected_.size(), "test outputs");
      set_arguments(kernel_, 0, in, out, batch);
      device_.launch("test", kernel_, batch / width_);
      compare(device_.read(out, 0, expected_.size()));
    }
  }

  /// Prints the differences. Asserts that bits are equal where `exact(output)`, else OpenCL's bounds.
  void check(const std::function<bool(size_t)>& exact) const {
    CAPTURE(width_);
    for (size_t field = 0; field < outputs_.size(); ++field) {
      const Output& output = outputs_[field];
      CAPTURE(output.name);
      if (differing_[field] > 0)
        MESSAGE("width " << width_ << ": " << output.name << " differs in " << differing_[field] << " of " << total_
                         << ", by at most " << most_floats_[field] << " ulp, " << most_[field] << " absolute");
      if (exact(field))
        CHECK(differing_[field] == 0);
      else
        CHECK((static_cast<double>(most_floats_[field]) <= output.floats || most_[field] <= output.absolute));
    }
  }

 private:
  void compare(const std::vector<float>& found) {
    total_ += batch;
    for (size_t n = 0; n < found.size(); ++n) {
      const float a = found[n], b = expected_[n];
      if (std::bit_cast<uint32_t>(a) == std::bit_cast<uint32_t>(b)) continue;
      const size_t field = n / batch;
      ++differing_[field];
      most_floats_[field] = std::max(most_floats_[field], floats_between(a, b));
      const double difference = std::abs(static_cast<double>(a) - b);
      most_[field] = std::max(most_[field], std::isnan(difference) ? INFINITY : difference);
    }
  }

  Device& device_;
  unsigned width_;
  cl::Kernel kernel_;
  const std::vector<Output>& outputs_;
  std::vector<size_t> differing_;
  std::vector<int64_t> most_floats_;
  std::vector<double> most_;
  std::vector<float> inputs_, expected_;
  size_t total_ = 0;
};

bool is_pocl(const Device& device) { return device.info().platform == "Portable Computing Language"; }

/// The device's own width over all batches, the others over a few (16 only where it is the device's own).
void for_each_width(const std::function<void(Device&, unsigned width, uint32_t rounds)>& test) {
  prepare_opencl(0);
  Device device;
  for (const unsigned width : std::set{1u, 4u, 8u, device.width()})
    test(device, width, width == device.width() ? batches : 2);
}

}  // namespace

TEST_CASE("fresnel.cl on device and host: the border") {
  for_each_width([](Device& device, unsigned width, uint32_t rounds) {
    FresnelInputs inputs(width);
    Comparison comparison(device, width, "border", 11, border_outputs);
    std::vector<glm::vec3> frames;           // pairs of a normal and a tangent
    for (int i = 0; i < 1024; ++i) {
      const glm::dvec3 up = inputs.unit_vector();
      frames.push_back(up);
      frames.push_back(glm::normalize(glm::cross(up, inputs.unit_vector())));
    }
    comparison.run(rounds, [&](uint32_t i, std::vector<float>& in, std::vector<float>& out) {
      const Indices n = inputs.below(4) == 0 ? inputs.any_indices() : inputs.glass();
      const kernel::InterfaceData data = make_interface(n.n_i, n.n_t);
      const kernel::Interface b = {data.eta, data.eta_inverse, data.k_hi, data.k_lo};
      const float c = inputs.cosine(n);
      const size_t frame = 2 * inputs.below(1024);
      const glm::vec3 d = -c * frames[frame] + std::sqrt(std::max(1 - c * c, 0.0f)) * frames[frame + 1];
      const kernel::Vec3 normal = {frames[frame].x, frames[frame].y, frames[frame].z}, direction = {d.x, d.y, d.z};
      set(in, i, 0, {b.eta, b.eta_inverse, b.k_hi, b.k_lo, c, d.x, d.y, d.z, normal.x, normal.y, normal.z});

      const kernel::Fresnel f = kernel::fresnel(b, c);
      const kernel::Vec3 refracted = kernel::refracted_direction(b, f, direction, normal);
      const kernel::Vec3 reflected = kernel::reflected_direction(direction, normal);
      set(out, i, 0, {f.R, f.T, f.r_perp, f.r_par, f.bend, f.total ? 1.0f : 0.0f});
      set(out, i, 6, {refracted.x, refracted.y, refracted.z, reflected.x, reflected.y, reflected.z});
    });
    const bool pocl = is_pocl(device);
    comparison.check([pocl](size_t field) { return pocl || field == 5 || field >= 9; });
  });
}

TEST_CASE("fresnel.cl on device and host: the medium") {
  for_each_width([](Device& device, unsigned width, uint32_t rounds) {
    FresnelInputs inputs(width);
    Comparison comparison(device, width, "medium", 3, medium_outputs);
    comparison.run(rounds, [&](uint32_t i, std::vector<float>& in, std::vector<float>& out) {
      const auto [sigma_a, distance] = inputs.absorbing_path();
      const float rho_d = inputs.reflectance();
      set(in, i, 0, {sigma_a, distance, rho_d});
      set(out, i, 0,
          {kernel::transmittance(sigma_a, distance), kernel::attenuation(sigma_a, distance).taken,
           kernel::sigma_a_from_rho_d(rho_d)});
    });
    const bool pocl = is_pocl(device);
    comparison.check([pocl](size_t field) { return pocl || field == 0; });
  });
}
