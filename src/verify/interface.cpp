// Fresnel's equations and Snell's law on the device, against quadruple precision.

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "device/interface.hpp"
#include "reference/fresnel.hpp"
#include "verify/error_profile.hpp"
#include "verify/fresnel_inputs.hpp"
#include "verify/fresnel_kernel.hpp"
#include "verify/groups.hpp"
#include "verify/textbook.hpp"

namespace vitrum {
namespace {

using glm::dvec3;

constexpr std::array glasses = {1 + 0x1p-23, 1.00001, 1.00028, 1.01, 1.1, 1.333, 1.5, 1.7, 2.0, 2.4, 3.0, 4.0};
constexpr size_t sides = 2 * glasses.size();

// Fields of the kernel `border`.
enum : size_t { out_R, out_T, out_r_perp, out_r_par, out_bend, out_total, out_refracted, border_outputs = 12 };
constexpr size_t border_inputs = 11;

/// Entering (even) or leaving one of the glasses.
Indices side_of(size_t side) {
  const double n = glasses[side / 2];
  return side % 2 == 0 ? Indices{1.0, n} : Indices{n, 1.0};
}

float critical_cosine(Indices n) {
  const double ratio = n.n_t / n.n_i;
  return ratio < 1 ? static_cast<float>(std::sqrt((1 - ratio) * (1 + ratio))) : 0.0f;
}

float brewster_cosine(Indices n) { return static_cast<float>(n.n_i / std::hypot(n.n_i, n.n_t)); }

/// Cosine `i` of `count`: floats next to Brewster's and the critical angle, next to 0 and 1, every so many of all
/// floats from 0 to 1, and half of them of any kind.
float cosine_of(FresnelInputs& inputs, Indices n, uint32_t i, uint32_t count) {
  static constexpr uint32_t one = 0x3f800000;
  const auto next_to = [](float centre, uint32_t k) {
    const uint32_t bits = std::bit_cast<uint32_t>(centre) + k;
    return std::bit_cast<float>(bits < 128 ? 0 : std::min(bits - 128, one));
  };
  if (i < 256) return next_to(brewster_cosine(n), i);
  if (i < 512) return next_to(critical_cosine(n), i - 256);
  if (i < 640) return std::bit_cast<float>(i - 512);
  if (i < 768) return std::bit_cast<float>(one - (i - 640));
  if (i % 2 == 0) return std::bit_cast<float>(static_cast<uint32_t>(uint64_t{one} * i / count));
  return inputs.cosine(n);
}

void set_border(Fields& in, uint32_t i, Indices n, float cosine) {
  const kernel::InterfaceData data = make_interface(n.n_i, n.n_t);
  in(0, i) = data.eta;
  in(1, i) = data.eta_inverse;
  in(2, i) = data.k_hi;
  in(3, i) = data.k_lo;
  in(4, i) = cosine;
  in(7, i) = -1.0f;             // along the normal, where nobody asks for the direction
  in(10, i) = 1.0f;
}

std::string input_text(Indices n, float cosine) {
  return printed("n_i = %.17g, n_t = %.17g, cos_theta_i = %.9g", n.n_i, n.n_t, cosine);
}

/// How far the two floats are apart in ulp; 0 for the same bits.
double bits_apart(float a, float b) {
  if (std::bit_cast<uint32_t>(a) == std::bit_cast<uint32_t>(b)) return 0.0;
  if (std::isnan(a) || std::isnan(b)) return std::numeric_limits<double>::infinity();
  return static_cast<double>(floats_between(a, b));
}

struct AngleTally {
  Worst R, T, balance, range, total, bits;

  void merge(const AngleTally& other) {
    R.merge(other.R);
    T.merge(other.T);
    balance.merge(other.balance);
    range.merge(other.range);
    total.merge(other.total);
    bits.merge(other.bits);
  }
};

/// R, T and total reflection of `count` cosines for each side of each glass.
void check_angles(FresnelKernel& border, const CheckContext& context, std::vector<CheckResult>& rows) {
  const uint32_t count = context.full ? 2'000'000 : 50'000;
  AngleTally all;
  std::string worst_inputs[6];
  for (size_t side = 0; side < sides; ++side) {
    const Indices n = side_of(side);
    const kernel::InterfaceData data = make_interface(n.n_i, n.n_t);
    const kernel::Interface constants = {data.eta, data.eta_inverse, data.k_hi, data.k_lo};
    FresnelInputs inputs(side);
    Fields in(count, border_inputs);
    for (uint32_t i = 0; i < count; ++i) set_border(in, i, n, cosine_of(inputs, n, i, count));
    const Fields out = border.run(in);
    const auto tally = tallied<AngleTally>(count, [&](AngleTally& sum, uint32_t first, uint32_t last) {
      for (uint32_t i = first; i < last; ++i) {
        const float c = in(4, i), R = out(out_R, i), T = out(out_T, i);
        const reference::Fresnel truth = reference::fresnel(n.n_i, n.n_t, c);
        const double R_error = std::abs(R - truth.R) / float_ulp(truth.R);
        // k is held in two floats, within 2^-48 of its size. Q^2 = cos^2 + k, and with it T = O(Q), is off by as much.
        const double Q = n.n_t / n.n_i * truth.cos_theta_t, eta = n.n_t / n.n_i;
        const double shift = Q > 0 ? truth.T * 0x1p-48 * std::abs((eta - 1) * (eta + 1)) / (2 * Q * Q) : 0.0;
        const double T_error =
            c > 1e-30f ? std::max(std::abs(T - truth.T) - shift, std::isnan(T) ? NAN : 0.0) / float_ulp(truth.T) : 0.0;
        sum.R.add(R_error, i);
        sum.T.add(std::isnan(T) ? NAN : T_error, i);
        sum.balance.add(std::abs(static_cast<double>(R) + T - 1), i);
        double outside = 0.0;               // of [0, 1] but for roundings
        for (const float value : {R, T, out(out_r_perp, i), out(out_r_par, i)})
          outside += std::isfinite(value) && std::abs(value) <= 1 + 1e-6f ? 0 : 1;
        sum.range.add(outside + (R < 0 || T < 0 ? 1 : 0) + (std::isfinite(out(out_bend, i)) ? 0 : 1), i);
        sum.total.add((out(out_total, i) != 0) == truth.total_reflection ? 0 : 1, i);
        const kernel::Fresnel host = kernel::fresnel(constants, c);
        sum.bits.add(std::max(bits_apart(R, host.R), bits_apart(T, host.T)), i);
      }
    });
    const Worst* found[] = {&tally.R, &tally.T, &tally.balance, &tally.range, &tally.total, &tally.bits};
    const Worst* before[] = {&all.R, &all.T, &all.balance, &all.range, &all.total, &all.bits};
    for (size_t k = 0; k < 6; ++k)
      if (found[k]->error > before[k]->error)
        worst_inputs[k] = input_text(n, in(4, static_cast<uint32_t>(found[k]->at)));
    all.merge(tally);
  }
  const auto row = [&](const char* name, const Worst& worst, double bound, const char* unit, const char* truth, int input) {
    rows.push_back({name, worst.cases, worst.error, bound, unit, truth, worst_inputs[input]});
  };
  row("interface/reflectance", all.R, 16, "ulp", "Fresnel (Born and Wolf 1.5.2), 113 bits", 0);
  row("interface/transmittance", all.T, 8, "ulp", "the same by amplitudes t, cos > 1e-30", 1);
  row("interface/R + T = 1", all.balance, 1e-6, "", "conservation of energy", 2);
  row("interface/range", all.range, 0, "values", "R, T, |r| in [0, 1], all finite", 3);
  row("interface/total reflection", all.total, 0, "decisions", "Snell, 113 bits", 4);
  row("interface/device and host", all.bits, rounds_as_host(context.device) ? 0 : 100, "ulp",
      "the same text compiled for the host", 5);
}

/// Errors of R and T in ulp by one input: vitrum's, and those of the forms in textbook.hpp.
struct FormsTally {
  static constexpr int least = -31, most = 2;  // binades of the input
  ErrorProfile R{least, most}, R_by_cosines{least, most}, R_by_g{least, most}, T{least, most}, T_by_R{least, most};
  void merge(const FormsTally& other) {
    R.merge(other.R);
    R_by_cosines.merge(other.R_by_cosines);
    R_by_g.merge(other.R_by_g);
    T.merge(other.T);
    T_by_R.merge(other.T_by_R);
  }
};

struct FormsInput {
  Indices n;                    ///< floats, so that all forms have the same border
  float cosine;
  double by;                    ///< what the plot shows the errors against
};

/// Plots of R and T beside other forms, for the rows of reflectance and transmittance.
template <typename Input>
void compare_forms(FresnelKernel& border, const CheckContext& context, const char* where, const char* x, const Input& input,
                   CheckResult& reflectance, CheckResult& transmittance) {
  const uint32_t count = context.full ? 1'000'000 : 40'000;
  FresnelInputs random(300);
  std::vector<FormsInput> inputs;
  Fields in(count, border_inputs);
  for (uint32_t i = 0; i < count; ++i) {
    inputs.push_back(input(random));
    set_border(in, i, inputs[i].n, inputs[i].cosine);
  }
  const Fields out = border.run(in);
  const auto tally = tallied<FormsTally>(count, [&](FormsTally& sum, uint32_t first, uint32_t last) {
    for (uint32_t i = first; i < last; ++i) {
      const auto& [n, c, by] = inputs[i];
      const auto n_i = static_cast<float>(n.n_i), n_t = static_cast<float>(n.n_t);
      const reference::Fresnel truth = reference::fresnel(n.n_i, n.n_t, c);
      const auto R_error = [&](float R) { return std::abs(R - truth.R) / float_ulp(truth.R); };
      const auto T_error = [&](float T) { return std::abs(T - truth.T) / float_ulp(truth.T); };
      const float by_cosines = textbook::reflectance_by_cosines(n_i, n_t, c);
      sum.R.add(by, R_error(out(out_R, i)));
      sum.R_by_cosines.add(by, R_error(by_cosines));
      sum.R_by_g.add(by, R_error(textbook::reflectance_by_g(n_i, n_t, c)));
      sum.T.add(by, T_error(out(out_T, i)));
      sum.T_by_R.add(by, T_error(1.0f - by_cosines));
    }
  });
  constexpr double floor = 0.1;
  reflectance.plots.push_back({std::string("Reflectance R, ") + where, x, "largest error [ulp]",
                               {tally.R.line("vitrum", floor), tally.R_by_cosines.line("r_s and r_p by cosines", floor),
                                tally.R_by_g.line("Cook and Torrance's g", floor)},
                               true, true, reflectance.bound});
  transmittance.plots.push_back({std::string("Transmittance T, ") + where, x, "largest error [ulp]",
                                 {tally.T.line("vitrum", floor), tally.T_by_R.line("1 - R, R by cosines", floor)},
                                 true, true, transmittance.bound});
}

void compare_with_textbook(FresnelKernel& border, const CheckContext& context, CheckResult& reflectance,
                           CheckResult& transmittance) {
  compare_forms(border, context, "into glass of n = 1.5, towards grazing", "cosine of the angle of incidence",
                [](FresnelInputs& random) {
                  const auto c = static_cast<float>(std::exp2(-30 * random.uniform()));
                  return FormsInput{{1.0, 1.5}, c, c};
                }, reflectance, transmittance);
  compare_forms(border, context, "out of glass of n = 1.5, next to the critical angle", "distance from the critical cosine, relative",
                [](FresnelInputs& random) {
                  const double critical = std::sqrt(5.0) / 3, off = 0.34 * std::exp2(-22 * random.uniform());
                  const auto c = static_cast<float>(std::min(critical * (1 + (random.below(2) ? off : -off)), 1.0));
                  return FormsInput{{1.5, 1.0}, c, std::abs(c / critical - 1)};
                }, reflectance, transmittance);
  compare_forms(border, context, "into a medium of index n near 1, cosine .1 to 1", "n - 1",
                [](FresnelInputs& random) {
                  const auto n = static_cast<float>(1 + 3 * std::exp2(-24.5 * random.uniform()));
                  return FormsInput{{1.0, n}, static_cast<float>(0.1 + 0.9 * random.uniform()), n - 1.0};
                }, reflectance, transmittance);
}

struct CosineTally {
  Worst R, T;
  void merge(const CosineTally& other) {
    R.merge(other.R);
    T.merge(other.T);
  }
};

/// R and T of every float from 0 to 1, for each side of each glass. The truth is the textbook's form in double, for the
/// border whose k is k_hi + k_lo: of that, Q^2 = cos^2 + k is off by one rounding even next to the critical angle.
void check_every_cosine(const CheckContext& context, std::vector<CheckResult>& rows) {
  FresnelKernel cosines(context, "cosines", 2);
  constexpr uint64_t end = 0x3f800001u, batch = 1u << 20;  // stays in a CPU's caches
  Worst worst_R, worst_T;
  std::string where_R, where_T;
  for (size_t side = 0; side < sides; ++side) {
    const Indices n = side_of(side);
    const kernel::InterfaceData data = make_interface(n.n_i, n.n_t);
    const double k = static_cast<double>(data.k_hi) + data.k_lo, eta2 = 1 + k;
    for (uint64_t first = 0; first < end; first += batch) {
      context.progress((static_cast<double>(side) + static_cast<double>(first) / end) / sides);
      const auto count = static_cast<uint32_t>(std::min(batch, end - first));
      const Fields out = cosines.run(data, static_cast<uint32_t>(first), (count + 15) / 16 * 16);
      const auto tally = tallied<CosineTally>(count, [&](CosineTally& sum, uint32_t from, uint32_t to) {
        for (uint32_t i = from; i < to; ++i) {
          const double c = std::bit_cast<float>(static_cast<uint32_t>(first) + i);
          const double Q2 = std::fma(c, c, k);
          double R = 1.0, T = 0.0;
          if (Q2 >= 0) {
            const double Q = std::sqrt(Q2), s = 1 / (c + Q), p = 1 / (eta2 * c + Q);
            const double r_s = (c - Q) * s, r_p = (eta2 * c - Q) * p;
            R = 0.5 * (r_s * r_s + r_p * r_p);
            T = 2 * c * Q * (s * s + eta2 * p * p);
          }
          sum.R.add(std::abs(out(0, i) - R) / float_ulp(R), first + i);
          if (c > 1e-30) sum.T.add(std::abs(out(1, i) - T) / float_ulp(T), first + i);
        }
      });
      const auto place = [&](const Worst& worst) {
        return input_text(n, std::bit_cast<float>(static_cast<uint32_t>(worst.at)));
      };
      if (tally.R.error > worst_R.error) where_R = place(tally.R);
      if (tally.T.error > worst_T.error) where_T = place(tally.T);
      worst_R.merge(tally.R);
      worst_T.merge(tally.T);
    }
  }
  rows.push_back({"interface/reflectance, every cosine", worst_R.cases, worst_R.error, 16, "ulp", "Fresnel in double", where_R,
                  {}, {}, "checks/fresnel.cl: cosines"});
  rows.push_back({"interface/transmittance, every cosine", worst_T.cases, worst_T.error, 8, "ulp",
                  "Fresnel in double, cos > 1e-30", where_T, {}, {}, "checks/fresnel.cl: cosines"});
}

/// Brewster's angle, equal indices, cosines that are none, and T from both sides.
void check_special_angles(FresnelKernel& border, std::vector<CheckResult>& rows) {
  struct Input {
    Indices n;
    float cosine;
  };
  std::vector<Input> inputs;
  const auto add = [&](Indices n, double cosine) {
    inputs.push_back({n, static_cast<float>(cosine)});
    return inputs.size() - 1;
  };
  // Brewster: one input each.
  for (size_t side = 0; side < sides; ++side) add(side_of(side), brewster_cosine(side_of(side)));
  // The same index on both sides.
  const size_t first_matched = inputs.size();
  for (const double n : glasses)
    for (const float c : {0.0f, 0x1p-149f, 1e-20f, 1e-4f, 0.5f, 1.0f, 1.0f + 0x1p-23f}) add({n, n}, c);
  // No cosines: above 1 counts as 1, NaN stays NaN.
  const size_t first_odd = inputs.size();
  for (size_t side = 0; side < sides; ++side)
    for (const float c : {1.0f, 1.0f + 0x1p-23f, std::numeric_limits<float>::quiet_NaN()}) add(side_of(side), c);
  // Pairs of conjugate angles.
  const size_t first_pair = inputs.size();
  for (const double n : glasses)
    for (int k = 1; k <= 100; ++k) {
      const double c = std::max(0.1, std::sqrt(0.1 * (n - 1))) + 0.009 * k;
      if (c > 1) continue;
      add({1.0, n}, c);
      const double sin_t = std::sqrt(1 - static_cast<double>(inputs.back().cosine) * inputs.back().cosine) / n;
      add({n, 1.0}, std::sqrt((1 - sin_t) * (1 + sin_t)));
    }

  const auto count = static_cast<uint32_t>((inputs.size() + 15) / 16 * 16);
  Fields in(count, border_inputs);
  for (uint32_t i = 0; i < count; ++i)
    set_border(in, i, inputs[std::min<size_t>(i, inputs.size() - 1)].n, inputs[std::min<size_t>(i, inputs.size() - 1)].cosine);
  const Fields out = border.run(in);
  const auto at = [&](size_t field, size_t i) { return static_cast<double>(out(field, static_cast<uint32_t>(i))); };
  Worst brewster, matched, odd, pairs;
  for (size_t i = 0; i < first_matched; ++i) {
    const double n2 = inputs[i].n.n_t / inputs[i].n.n_i * (inputs[i].n.n_t / inputs[i].n.n_i);
    const double s = (n2 - 1) / (n2 + 1);
    // The cosine is a float, so not quite Brewster's: what that does is no error.
    const reference::Fresnel there = reference::fresnel(inputs[i].n.n_i, inputs[i].n.n_t, inputs[i].cosine);
    brewster.add(std::max(std::abs(at(out_r_par, i)) - std::abs(there.r_par),
                          std::abs(at(out_R, i) - s * s / 2) - std::abs(there.R - s * s / 2)), i);
  }
  for (size_t i = first_matched; i < first_odd; ++i)
    matched.add(std::abs(at(out_R, i)) + std::abs(at(out_T, i) - 1) + std::abs(at(out_refracted + 2, i) + 1), i);
  for (size_t i = first_odd; i < first_pair; i += 3) {
    odd.add(at(out_R, i) == at(out_R, i + 1) && at(out_T, i) == at(out_T, i + 1) ? 0 : 1, i + 1);
    odd.add(std::isnan(out(out_R, static_cast<uint32_t>(i + 2))) && std::isnan(out(out_T, static_cast<uint32_t>(i + 2))) ? 0 : 1,
            i + 2);
  }
  for (size_t i = first_pair; i < inputs.size(); i += 2)
    pairs.add(std::abs(at(out_T, i + 1) / at(out_T, i) - 1), i);
  const auto row = [&](const char* name, const Worst& worst, double bound, const char* unit, const char* truth) {
    rows.push_back({name, worst.cases, worst.error, bound, unit, truth,
                    input_text(inputs[worst.at].n, inputs[worst.at].cosine)});
  };
  row("interface/Brewster", brewster, 2e-7, "", "r_par = 0, R = ((n^2-1)/(n^2+1))^2/2");
  row("interface/index-matched", matched, 0, "", "R = 0, T = 1, straight on");
  row("interface/odd cosines", odd, 0, "values", "above 1 is as 1, NaN is not hidden");
  // The conjugate cosine is a float: half an ulp of it, times T's slope against it where it is at least .1.
  row("interface/reciprocity", pairs, 1e-5, "relative", "Helmholtz: T is the same from both sides");
}

dvec3 vector_at(const Fields& fields, size_t first, uint32_t i) {
  return {fields(first, i), fields(first + 1, i), fields(first + 2, i)};
}

double angle_between(const dvec3& a, const dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

struct DirectionTally {
  Worst refracted, length, reflected;
  void merge(const DirectionTally& other) {
    refracted.merge(other.refracted);
    length.merge(other.length);
    reflected.merge(other.reflected);
  }
};

void check_directions(FresnelKernel& border, const CheckContext& context, std::vector<CheckResult>& rows) {
  const uint32_t count = context.full ? 12'000'000 : 240'000;
  FresnelInputs inputs(100);
  Fields in(count, border_inputs);
  const auto side = [](uint32_t i) { return side_of(i % sides); };
  for (uint32_t i = 0; i < count; ++i) {
    const Indices n = side(i);
    const dvec3 up = inputs.unit_vector(), along = glm::normalize(glm::cross(up, inputs.unit_vector()));
    const double c = std::min(inputs.cosine(n), 1.0f), s = std::sqrt((1 - c) * (1 + c));
    const dvec3 direction = glm::vec3(s * along - c * up), normal = glm::vec3(up);
    // The cosine of what the floats are, rounded once.
    const double cosine = -glm::dot(glm::normalize(direction), glm::normalize(normal));
    set_border(in, i, n, static_cast<float>(std::max(cosine, 0.0)));
    for (size_t k = 0; k < 3; ++k) {
      in(5 + k, i) = static_cast<float>(direction[static_cast<int>(k)]);
      in(8 + k, i) = static_cast<float>(normal[static_cast<int>(k)]);
    }
  }
  const Fields out = border.run(in);
  const auto tally = tallied<DirectionTally>(count, [&](DirectionTally& sum, uint32_t first, uint32_t last) {
    for (uint32_t i = first; i < last; ++i) {
      const Indices n = side(i);
      const dvec3 d = glm::normalize(vector_at(in, 5, i)), up = glm::normalize(vector_at(in, 8, i));
      const dvec3 t = vector_at(out, out_refracted, i), r = vector_at(out, out_refracted + 3, i);
      sum.reflected.add(angle_between(r, reference::reflected_direction(d, up)), i);
      sum.length.add(std::abs(glm::length(r) - 1), i);
      if (out(out_total, i) != 0) continue;
      sum.length.add(std::abs(glm::length(t) - 1), i);
      // Into the denser medium refraction narrows angles, so the ray itself is compared; out of it refraction widens
      // them without bound, and the ray is traced back: it must come from a direction next to the given one.
      const bool entering = n.n_i <= n.n_t;
      const auto truth = entering ? reference::refracted_direction(n.n_i, n.n_t, d, up)
                                  : reference::refracted_direction(n.n_t, n.n_i, -t, -up);
      sum.refracted.add(!truth ? NAN : entering ? angle_between(t, *truth) : angle_between(-*truth, d), i);
    }
  });
  const auto row = [&](const char* name, const Worst& worst, double bound, const char* unit, const char* truth) {
    const auto i = static_cast<uint32_t>(worst.at);
    const dvec3 d = vector_at(in, 5, i), up = vector_at(in, 8, i);
    rows.push_back({name, worst.cases, worst.error, bound, unit, truth,
                    input_text(side(i), in(4, i)) + printed(", direction (%.9g, %.9g, %.9g), normal (%.9g, %.9g, %.9g)", d.x, d.y,
                                                         d.z, up.x, up.y, up.z)});
  };
  row("interface/refracted direction", tally.refracted, 3e-7, "rad", "Snell, 113 bits; leaving: traced back");
  row("interface/reflected direction", tally.reflected, 3e-7, "rad", "law of reflection, 113 bits");
  row("interface/unit length", tally.length, 2 * 0x1p-23, "", "length 1 within 2 ulp");
}

}  // namespace

std::vector<CheckResult> check_interface(const CheckContext& context) {
  FresnelKernel border(context, "border", border_outputs);
  std::vector<CheckResult> rows;
  check_angles(border, context, rows);
  compare_with_textbook(border, context, rows[0], rows[1]);
  check_special_angles(border, rows);
  check_directions(border, context, rows);
  if (context.full) check_every_cosine(context, rows);
  return rows;
}

}  // namespace vitrum
