// Bouguer's law on the device, against long double.

#include <cmath>

#include "reference/fresnel.hpp"
#include "verify/error_profile.hpp"
#include "verify/fresnel_inputs.hpp"
#include "verify/fresnel_kernel.hpp"
#include "verify/groups.hpp"
#include "verify/textbook.hpp"

namespace vitrum {
namespace {

constexpr double least_normal = 0x1p-126;
constexpr double promised = 5e-7;           // relative error of transmittance by kernels/fresnel.cl

/// Errors by an input: vitrum's, and those of the form in textbook.hpp.
struct Forms {
  ErrorProfile vitrum, textbook;

  Forms(int least, int most) : vitrum(least, most), textbook(least, most) {}
  void merge(const Forms& other) {
    vitrum.merge(other.vitrum);
    textbook.merge(other.textbook);
  }
  Plot plot(const char* title, const char* x, const char* y, const char* form, double floor, double bound) const {
    return {title, x, y, {vitrum.line("vitrum", floor), textbook.line(form, floor)}, true, true, bound};
  }
};

struct MediumTally {
  Worst left, taken, sigma_a;
  Forms left_by_depth{-10, 6}, taken_by_depth{-20, 6}, sigma_a_by_loss{-24, 0};
  void merge(const MediumTally& other) {
    left.merge(other.left);
    taken.merge(other.taken);
    sigma_a.merge(other.sigma_a);
    left_by_depth.merge(other.left_by_depth);
    taken_by_depth.merge(other.taken_by_depth);
    sigma_a_by_loss.merge(other.sigma_a_by_loss);
  }
};

/// Relative error of a transmittance; below the least normal float 0 is right.
double transmittance_error(float found, double truth) {
  if (truth >= least_normal * (1 + promised)) return std::abs(found - truth) / truth;
  if (truth <= least_normal * (1 - promised)) return std::isnan(found) ? NAN : found;
  return found == 0 ? 0.0 : std::abs(found - truth) / truth;
}

}  // namespace

std::vector<CheckResult> check_absorption(const CheckContext& context) {
  FresnelKernel medium(context, "medium", 3);
  std::vector<CheckResult> rows;

  const uint32_t count = context.full ? 48'000'000 : 1'600'000;
  FresnelInputs inputs(200);
  const Fields in = medium_inputs(inputs, count);
  const Fields out = medium.run(in);
  const auto tally = tallied<MediumTally>(count, [&](MediumTally& sum, uint32_t first, uint32_t last) {
    for (uint32_t i = first; i < last; ++i) {
      const double sigma_a = in(0, i), distance = in(1, i), rho_d = in(2, i);
      const double left = reference::transmittance(sigma_a, distance), depth = sigma_a * distance;
      const double taken = -std::expm1(sigma_a == 0 || distance == 0 ? 0.0 : -depth);
      const auto taken_error = [&](float found) { return std::abs(found - taken) / float_ulp(taken); };
      sum.left.add(transmittance_error(out(0, i), left), i);
      sum.taken.add(taken_error(out(1, i)), i);
      if (depth > 0x1p-20 && depth < 87) {
        sum.left_by_depth.vitrum.add(depth, transmittance_error(out(0, i), left));
        sum.left_by_depth.textbook.add(depth, transmittance_error(textbook::transmittance(in(0, i), in(1, i)), left));
        sum.taken_by_depth.vitrum.add(depth, taken_error(out(1, i)));
        sum.taken_by_depth.textbook.add(depth, taken_error(textbook::absorptance(in(0, i), in(1, i))));
      }
      if (rho_d < least_normal) {
        sum.sigma_a.add(std::isinf(out(2, i)) ? 0 : NAN, i);
      } else {
        const double truth = reference::sigma_a_from_rho_d(rho_d);
        const auto error = [&](float found) { return std::abs(found - truth) / float_ulp(truth); };
        sum.sigma_a.add(error(out(2, i)), i);
        if (rho_d == 1) continue;
        sum.sigma_a_by_loss.vitrum.add(1 - rho_d, error(out(2, i)));
        sum.sigma_a_by_loss.textbook.add(1 - rho_d, error(textbook::sigma_a_from_rho_d(in(2, i))));
      }
    }
  });
  const auto path = [&](const Worst& worst) {
    const auto i = static_cast<uint32_t>(worst.at);
    return printed("sigma_a = %.9g, distance = %.9g", in(0, i), in(1, i));
  };
  rows.push_back({"absorption/transmittance", count, tally.left.error, promised, "relative",
                  "Bouguer: exp(-sigma_a s), long double", path(tally.left),
                  {tally.left_by_depth.plot("Transmittance of an absorbing medium", "sigma_a s", "largest error, relative",
                                            "expf(-(sigma_a s))", 1e-9, promised)}});
  rows.push_back({"absorption/absorptance", count, tally.taken.error, 6, "ulp", "-expm1(-sigma_a s)", path(tally.taken),
                  {tally.taken_by_depth.plot("Absorptance of a medium", "sigma_a s", "largest error [ulp]",
                                             "1 - expf(-(sigma_a s))", 0.1, 6)}});
  // The quotient: 2.5 ulp by OpenCL 1.2, 7.4, and half of one by the difference in front of it.
  rows.push_back({"absorption/sigma_a of rho_d", count, tally.sigma_a.error, rounds_as_host(context.device) ? 2.0 : 4.0,
                  "ulp", "1/rho_d - 1, 113 bits",
                  printed("rho_d = %.9g", in(2, static_cast<uint32_t>(tally.sigma_a.at))),
                  {tally.sigma_a_by_loss.plot("sigma_a of a reflectance rho_d", "1 - rho_d", "largest error [ulp]",
                                              "1 / rho_d - 1", 0.1, 0)}});

  // A path in two pieces: s1 + s2 is exact in float where s2 is between a half and all of the sum (Sterbenz).
  const uint32_t pairs = context.full ? 1u << 22 : 1u << 17;
  Fields pieces(3 * pairs, 3);
  for (uint32_t i = 0; i < pairs; ++i) {
    const double whole = std::exp2(20 * inputs.uniform() - 10), depth = 87 * inputs.uniform();
    const auto s = static_cast<float>(whole);
    const auto part = static_cast<float>(s * (0.5 + 0.5 * inputs.uniform()));
    for (uint32_t k = 0; k < 3; ++k) pieces(0, 3 * i + k) = static_cast<float>(depth / whole);
    pieces(1, 3 * i) = s;
    pieces(1, 3 * i + 1) = part;
    pieces(1, 3 * i + 2) = s - part;
  }
  const Fields parts = medium.run(pieces);
  Worst split;
  for (uint32_t i = 0; i < pairs; ++i) {
    const double product = static_cast<double>(parts(0, 3 * i + 1)) * parts(0, 3 * i + 2);
    if (product >= 2 * least_normal) split.add(std::abs(parts(0, 3 * i) / product - 1), i);
  }
  const auto worst = static_cast<uint32_t>(3 * split.at);
  rows.push_back({"absorption/split path", split.cases, split.error, 3 * promised, "relative",
                  "exp(-a) exp(-b) = exp(-(a + b))",
                  printed("sigma_a = %.9g, %.9g m = %.9g m + %.9g m", pieces(0, worst), pieces(1, worst),
                       pieces(1, worst + 1), pieces(1, worst + 2))});
  return rows;
}

}  // namespace vitrum
