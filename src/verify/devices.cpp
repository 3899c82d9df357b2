// Two devices, the same inputs: how far apart their answers are, in ulp. OpenCL rounds all operations alike but
// division and square root (2.5 and 3 ulp, OpenCL 1.2, 7.4), so only what follows from those may differ.

#include <bit>
#include <cmath>
#include <functional>
#include <limits>

#include "device/interface.hpp"
#include "render/render.hpp"
#include "verify/fresnel_inputs.hpp"
#include "verify/fresnel_kernel.hpp"
#include "verify/groups.hpp"
#include "verify/switch_scenes.hpp"

namespace vitrum {
namespace {

/// How far the floats are apart in ulp; 0 for the same bits, infinite where only one is a number.
double ulp_between(float a, float b) {
  if (std::bit_cast<uint32_t>(a) == std::bit_cast<uint32_t>(b)) return 0.0;
  if (std::isnan(a) && std::isnan(b)) return 0.0;
  if (std::isnan(a) || std::isnan(b)) return std::numeric_limits<double>::infinity();
  return static_cast<double>(floats_between(a, b));
}

/// The largest difference and how many had none.
struct Difference {
  Worst worst;
  uint64_t same = 0;

  void add(double difference, uint64_t index) {
    worst.add(difference, index);
    same += difference == 0;
  }
  CheckResult row(const std::string& name, double bound, const char* unit, const std::string& rule,
                  const std::string& where) const {
    return {"devices/" + name, worst.cases, worst.error, bound, unit,
            rule + printed("; %.4g %% are bit-equal",
                           100.0 * static_cast<double>(same) / static_cast<double>(worst.cases)),
            where};
  }
};

/// An output of one of the kernels and by how much two devices may differ there: ulp, or an absolute difference of what
/// passes through 0.
struct Output {
  const char* name;
  double bound;
  bool absolute;
  const char* rule;
};

// What each device may be off by is derived in tests/device/test_fresnel.cpp. Two may be off to different sides, so twice
// that; bend is at most 4 here.
constexpr double u = 0x1p-24;
constexpr Output border_outputs[] = {
    {"R", 200, false, "division 2.5, sqrt 3 ulp, twice"},
    {"T", 88, false, "the same"},
    {"r_perp", 68, false, "the same"},
    {"r_par", 128 * u, true, "the same"},
    {"bend", 40, false, "the same"},
    {"total reflection", 0, false, "exact operations only"},
    {"refracted x", 200 * u, true, "bend, at most 4"},
    {"refracted y", 200 * u, true, "bend, at most 4"},
    {"refracted z", 200 * u, true, "bend, at most 4"},
    {"reflected x", 0, false, "exact operations only"},
    {"reflected y", 0, false, "exact operations only"},
    {"reflected z", 0, false, "exact operations only"},
};
// Devices may flush denormals.
constexpr Output medium_outputs[] = {
    {"transmittance", 0, false, "exact operations only"},
    {"absorptance", 0x1p-126, true, "exact but for denormals"},
    {"sigma_a of rho_d", 5, false, "division 2.5 ulp, twice"},
};

template <size_t outputs>
void compare(const CheckContext& context, const char* kernel, const Fields& in, const Output (&fields)[outputs],
             const std::function<std::string(uint32_t)>& input, std::vector<CheckResult>& rows) {
  const CheckContext there{*context.other, "", context.kernels, context.full, nullptr, [](double) {}};
  const Fields one = FresnelKernel(context, kernel, outputs).run(in);
  const Fields other = FresnelKernel(there, kernel, outputs).run(in);
  for (size_t field = 0; field < outputs; ++field) {
    Difference difference;
    for (uint32_t i = 0; i < in.count(); ++i) {
      const float a = one(field, i), b = other(field, i);
      const double ulp = ulp_between(a, b);
      difference.add(fields[field].absolute && std::isfinite(ulp) && ulp > 0 ? std::abs(double{a} - b) : ulp, i);
    }
    const auto at = static_cast<uint32_t>(difference.worst.at);
    rows.push_back(difference.row(fields[field].name, fields[field].bound, fields[field].absolute ? "" : "ulp",
                                  fields[field].rule,
                                  input(at) + printed(": %.9g and %.9g", one(field, at), other(field, at))));
  }
}

void compare_borders(const CheckContext& context, std::vector<CheckResult>& rows) {
  const uint32_t count = context.full ? 8'000'000 : 800'000;
  FresnelInputs inputs(300);
  Fields in(count, 11);
  for (uint32_t i = 0; i < count; ++i) {
    const Indices n = inputs.glass();
    const kernel::InterfaceData border = make_interface(n.n_i, n.n_t);
    const double c = std::min(inputs.cosine(n), 1.0f), s = std::sqrt((1 - c) * (1 + c));
    const glm::dvec3 up = inputs.unit_vector(), along = glm::normalize(glm::cross(up, inputs.unit_vector()));
    const glm::dvec3 direction = s * along - c * up;
    for (size_t field = 0; const double value :
         {double{border.eta}, double{border.eta_inverse}, double{border.k_hi}, double{border.k_lo}, c, direction.x,
          direction.y, direction.z, up.x, up.y, up.z})
      in(field++, i) = static_cast<float>(value);
  }
  compare(context, "border", in, border_outputs, [&in](uint32_t i) {
    return printed("eta = %.9g, k = %.9g + %.9g, cos_theta_i = %.9g", in(0, i), in(2, i), in(3, i), in(4, i));
  }, rows);
}

void compare_media(const CheckContext& context, std::vector<CheckResult>& rows) {
  const uint32_t count = context.full ? 8'000'000 : 800'000;
  FresnelInputs inputs(400);
  const Fields in = medium_inputs(inputs, count);
  compare(context, "medium", in, medium_outputs, [&in](uint32_t i) {
    return printed("sigma_a = %.9g, distance = %.9g, rho_d = %.9g", in(0, i), in(1, i), in(2, i));
  }, rows);
}

constexpr double rounding = 1e-5;           // of a pixel, as in the group slab-and-ball

/// Root of the mean square of a - b, of that of b.
double relative_rms(const std::vector<double>& a, const std::vector<double>& b) {
  double apart = 0.0, size = 0.0;
  for (size_t i = 0; i < a.size(); ++i) {
    apart += (a[i] - b[i]) * (a[i] - b[i]);
    size += b[i] * b[i];
  }
  return std::sqrt(apart / size);
}

/// Pictures by each switch of the kernels. Most values differ by roundings or not at all, but a ray or photon that just
/// meets an edge on one device misses it on the other. Together that must be little against what another seed does.
void compare_pictures(const CheckContext& context, std::vector<CheckResult>& rows) {
  for (NamedScene& s : switch_scenes(context.full ? 256 : 48, context.full ? 1'000'000 : 50'000)) {
    // The automatic radius hangs on a few photons, and all of the picture on the radius.
    PhotonEstimate& estimate = s.scene.photons.estimate;
    if (estimate == PhotonEstimate::automatic || estimate == PhotonEstimate::automatic_radius) estimate = PhotonEstimate::fixed_radius;
    s.scene.photons.radius = 0.03;
    RenderOptions options;
    options.kernels = context.kernels;
    const auto picture = [&](Device& device) { return render(s.scene, device, options).film.mean("radiance"); };
    const std::vector<double> one = picture(context.device), other = picture(*context.other);
    ++s.scene.render.seed;
    const std::vector<double> reseeded = picture(context.device);
    Difference ulp;
    for (size_t i = 0; i < one.size(); ++i)
      ulp.add(ulp_between(static_cast<float>(one[i]), static_cast<float>(other[i])), i);
    const size_t at = ulp.worst.at, pixel = at / 3, width = static_cast<size_t>(s.scene.film.width);
    CheckResult row = ulp.row(s.name, std::max(0.1 * relative_rms(reseeded, one), rounding), "of RMS",
                              printed("a tenth of another seed's; %.3g ulp at most", ulp.worst.error),
                              printed("pixel (%zu, %zu), channel %zu: %.9g and %.9g", pixel % width, pixel / width,
                                      at % 3, one[at], other[at]));
    row.worst = relative_rms(other, one);
    rows.push_back(row);
  }
}

}  // namespace

std::vector<CheckResult> check_devices(const CheckContext& context) {
  std::vector<CheckResult> rows;
  if (!context.other) return rows;
  compare_borders(context, rows);
  compare_media(context, rows);
  compare_pictures(context, rows);
  return rows;
}

}  // namespace vitrum
