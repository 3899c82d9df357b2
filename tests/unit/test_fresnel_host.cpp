// kernels/fresnel.cl, compiled for the host, against the reference in quadruple precision and against textbooks.
#include <doctest/doctest.h>

#include <string>

#include "device/interface.hpp"
#include "verify/fresnel_inputs.hpp"
#include "reference/fresnel.hpp"

using namespace vitrum;
using glm::dvec3;

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float least_normal = 0x1p-126f;

kernel::Interface border(Indices n) {
  const kernel::InterfaceData data = make_interface(n.n_i, n.n_t);
  return {data.eta, data.eta_inverse, data.k_hi, data.k_lo};
}

kernel::Vec3 to_kernel(const dvec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

dvec3 to_double(const kernel::Vec3& v) { return {v.x, v.y, v.z}; }

double angle_between(const dvec3& a, const dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

/// The largest error of a quantity and where it was.
struct Worst {
  double error = 0.0;
  Indices n;
  float at = 0.0f;

  void add(double found, Indices indices, float x) {
    if (found <= error) return;              // lets NaN through
    error = std::isnan(found) ? infinity : found;
    n = indices;
    at = x;
  }
};

std::string told(const char* what, const Worst& worst) {
  char text[200];
  std::snprintf(text, sizeof text, "%s: %.3g at n_i = %.9g, n_t = %.9g, cos = %.9g", what, worst.error, worst.n.n_i,
                worst.n.n_t, worst.at);
  return text;
}

/// How far the kernel is from the reference, in ulp, over all that it is given.
struct Accuracy {
  Worst R, T, balance;
  int wrong_total = 0, total = 0, refracted = 0;

  /// `k_error`: how far, relative to its size, k_hi + k_lo may be from the indices' own k. T = O(sqrt(Q^2)) with
  /// Q^2 = cos^2 + k then moves by half of Q^2's relative change.
  void add(Indices n, float cos_theta_i, double k_error = 0.0) {
    const kernel::Fresnel f = kernel::fresnel(border(n), cos_theta_i);
    const reference::Fresnel truth = reference::fresnel(n.n_i, n.n_t, cos_theta_i);
    ++(truth.total_reflection ? total : refracted);
    if (f.total != truth.total_reflection) ++wrong_total;
    R.add(std::abs(f.R - truth.R) / float_ulp(truth.R), n, cos_theta_i);
    const double Q = n.n_t / n.n_i * truth.cos_theta_t, k = (n.n_t / n.n_i - 1) * (n.n_t / n.n_i + 1);
    const double shift = k_error > 0 && Q > 0 ? truth.T * k_error * std::abs(k) / (2 * Q * Q) : 0.0;
    if (cos_theta_i > 1e-30f)
      T.add(std::max(std::abs(f.T - truth.T) - shift, 0.0) / float_ulp(truth.T), n, cos_theta_i);
    balance.add(std::abs(static_cast<double>(f.R) + f.T - 1), n, cos_theta_i);
  }

  void check() const {
    MESSAGE(told("R [ulp]", R));
    MESSAGE(told("T [ulp]", T));
    MESSAGE(told("|R + T - 1|", balance));
    CHECK(R.error <= 16);
    CHECK(T.error <= 8);
    CHECK(balance.error < 1e-6);
    CHECK(wrong_total == 0);
  }
};

/// A ray that meets a border from some direction, in the kernel's floats and exactly.
struct Meeting {
  Indices n;
  kernel::Vec3 direction, normal;
  dvec3 d, up;

  Meeting(FresnelInputs& inputs, Indices indices) : n(indices) {
    const dvec3 exact_normal = inputs.unit_vector();
    const dvec3 tangent = glm::normalize(glm::cross(exact_normal, inputs.unit_vector()));
    const double cos_i = std::min(inputs.cosine(n), 1.0f), sin_i = std::sqrt((1 - cos_i) * (1 + cos_i));
    normal = to_kernel(exact_normal);
    direction = to_kernel(sin_i * tangent - cos_i * exact_normal);
    d = glm::normalize(to_double(direction));
    up = glm::normalize(to_double(normal));
  }
  float cosine() const { return static_cast<float>(std::max(-glm::dot(d, up), 0.0)); }
};

}  // namespace

TEST_CASE("fresnel.cl: the constants of a border") {
  FresnelInputs inputs(1);
  for (int i = 0; i < 100'000; ++i) {
    const Indices n = i % 2 ? inputs.any_indices() : inputs.glass();
    const kernel::InterfaceData data = make_interface(n.n_i, n.n_t);
    const long double i2 = static_cast<long double>(n.n_i) * n.n_i;
    const long double k = (static_cast<long double>(n.n_t) - n.n_i) * (static_cast<long double>(n.n_t) + n.n_i) / i2;
    REQUIRE(std::abs(static_cast<long double>(data.k_hi) + data.k_lo - k) <= 0x1p-48L * std::abs(k));
    REQUIRE((data.k_hi == 0) == (n.n_i == n.n_t));
    REQUIRE(std::abs(data.eta * n.n_i - n.n_t) <= 0x1p-23 * n.n_t);
    REQUIRE(std::abs(data.eta_inverse * n.n_t - n.n_i) <= 0x1p-23 * n.n_i);
  }
}

TEST_CASE("fresnel.cl against quadruple precision: indices of glass") {
  FresnelInputs inputs(2);
  Accuracy entering, leaving;
  for (int i = 0; i < 1'000'000; ++i) {
    const Indices n = inputs.glass();
    (n.n_i > n.n_t ? leaving : entering).add(n, inputs.cosine(n), 0x1p-48);
  }
  entering.check();
  leaving.check();
  CHECK(entering.total == 0);
  CHECK(leaving.total > 100'000);
  CHECK(leaving.refracted > 100'000);
}

TEST_CASE("fresnel.cl against quadruple precision: every float next to the critical angle") {
  // The relative index of 24 bits has a k of 49, which two floats hold: no allowance.
  FresnelInputs inputs(3);
  Accuracy exact_k, glasses;
  const auto around = [](Accuracy& accuracy, Indices n) {
    const double ratio = n.n_t / n.n_i;
    const auto critical = std::bit_cast<uint32_t>(static_cast<float>(std::sqrt((1 - ratio) * (1 + ratio))));
    for (uint32_t bits = critical - 32; bits <= critical + 32; ++bits)
      if (bits <= std::bit_cast<uint32_t>(1.0f)) accuracy.add(n, std::bit_cast<float>(bits));
  };
  for (int i = 0; i < 8000; ++i) {
    const float distance = static_cast<float>(i % 2 ? 0.75 * inputs.uniform() : std::exp2(-24 * inputs.uniform()));
    const float eta = 1 - distance;
    if (eta < 1) around(exact_k, {1.0, eta});
  }
  for (const double n : {1 + 0x1p-23, 1.00028, 1.333, 1.5, 2.4, 4.0})
    for (const double outside : {1.0, 1.00028, 1.333, 1.5})
      if (outside < n) around(glasses, {n, outside});
  exact_k.check();
  glasses.check();
  CHECK(exact_k.total > 100'000);
  CHECK(exact_k.refracted > 100'000);
}

TEST_CASE("fresnel.cl: no NaN and nothing outside its range for any index that a material can have") {
  FresnelInputs inputs(4);
  double most = 0, least = 1, balance = 0;
  int not_finite = 0, wrong_total = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    const Indices n = inputs.any_indices();
    const float c = inputs.cosine(n);
    const kernel::Fresnel f = kernel::fresnel(border(n), c);
    for (const float value : {f.R, f.T, f.r_perp, f.r_par, f.bend}) not_finite += !std::isfinite(value);
    if (i % 4 == 0) wrong_total += f.total != reference::fresnel(n.n_i, n.n_t, c).total_reflection;
    most = std::max({most, double{f.R}, double{f.T}, std::abs(double{f.r_perp}), std::abs(double{f.r_par})});
    least = std::min({least, double{f.R}, double{f.T}});
    balance = std::max(balance, std::abs(static_cast<double>(f.R) + f.T - 1));
  }
  CHECK(not_finite == 0);
  CHECK(wrong_total == 0);
  CHECK(least >= 0);
  CHECK(most <= 1 + 1e-6);
  CHECK(balance < 1e-6);
  // A NaN is not hidden.
  const kernel::Fresnel f = kernel::fresnel(border({1, 1.5}), std::numeric_limits<float>::quiet_NaN());
  CHECK(std::isnan(f.R));
  CHECK(std::isnan(f.T));
}

TEST_CASE("fresnel.cl: equal indices are no border") {
  for (const double n : {0.001, 1.0, 1.333, 10.0}) {
    const kernel::Interface b = border({n, n});
    for (const float c : {0.0f, 0x1p-149f, 1e-20f, 1e-4f, 0.5f, 1.0f, 1.0f + 0x1p-23f}) {
      const kernel::Fresnel f = kernel::fresnel(b, c);
      CHECK(f.R == 0);
      CHECK(f.T == 1);
      CHECK(f.r_perp == 0);
      CHECK(f.r_par == 0);
      CHECK(!f.total);
      const kernel::Vec3 d = {0.3f, -0.2f, 0.7f}, t = kernel::refracted_direction(b, f, d, {0, 1, 0});
      CHECK(to_double(t) == to_double(d));
    }
  }
}

TEST_CASE("fresnel.cl against quadruple precision: reflected directions") {
  FresnelInputs inputs(5);
  Worst length, angle;
  for (int i = 0; i < 200'000; ++i) {
    const Meeting m(inputs, inputs.glass());
    const dvec3 reflected = to_double(kernel::reflected_direction(m.direction, m.normal));
    length.add(std::abs(glm::length(reflected) - 1), m.n, m.cosine());
    angle.add(angle_between(reflected, reference::reflected_direction(m.d, m.up)), m.n, m.cosine());
  }
  MESSAGE(told("length of the reflected direction - 1", length));
  MESSAGE(told("angle of reflection [rad]", angle));
  CHECK(length.error <= 2 * 0x1p-23);
  CHECK(angle.error <= 3e-7);
}

TEST_CASE("fresnel.cl against quadruple precision: refracted directions") {
  // `computed` takes the cosine as the renderer does, from float vectors: it is off by some 1e-7 then, which moves the
  // angle by 1e-7 / sin theta_i, whatever refraction does with it. So ratios stay below 2 there.
  FresnelInputs inputs(6);
  Worst length, rounded, computed;
  int refracted = 0, wrong_side = 0;
  const auto add = [&](const Meeting& m, float cosine, Worst& angle) {
    const kernel::Interface b = border(m.n);
    const kernel::Fresnel f = kernel::fresnel(b, cosine);
    if (f.total) return;
    ++refracted;
    const dvec3 t = to_double(kernel::refracted_direction(b, f, m.direction, m.normal));
    length.add(std::abs(glm::length(t) - 1), m.n, cosine);
    // Into the denser medium refraction narrows angles, so the ray itself is compared; out of it refraction widens them
    // without bound, and the ray is traced back: it must come from a direction next to the given one.
    const bool entering = m.n.n_i <= m.n.n_t;
    const auto truth = entering ? reference::refracted_direction(m.n.n_i, m.n.n_t, m.d, m.up)
                                : reference::refracted_direction(m.n.n_t, m.n.n_i, -t, -m.up);
    REQUIRE(truth);
    if (m.n.n_i != m.n.n_t) wrong_side += glm::dot(t, m.up) >= 0;  // else t is d, which may lie behind by rounding
    angle.add(entering ? angle_between(t, *truth) : angle_between(-*truth, m.d), m.n, cosine);
  };
  for (int i = 0; i < 400'000; ++i) {
    const Meeting m(inputs, inputs.glass());
    add(m, m.cosine(), rounded);
    const float cosine = -kernel::dot3(m.direction, m.normal);
    if (cosine >= 0 && m.n.n_i <= 2 * m.n.n_t) add(m, cosine, computed);
  }
  MESSAGE(told("length of the refracted direction - 1", length));
  MESSAGE(told("angle of refraction, exact cosine [rad]", rounded));
  MESSAGE(told("angle of refraction, computed cosine [rad]", computed));
  CHECK(length.error <= 2 * 0x1p-23);
  CHECK(rounded.error <= 3e-7);
  CHECK(computed.error <= 3e-7);
  CHECK(wrong_side == 0);
  CHECK(refracted > 400'000);
}

TEST_CASE("fresnel.cl: textbook values") {
  for (const double n : {1.00028, 1.333, 1.5, 2.4, 4.0}) {
    CAPTURE(n);
    const kernel::Interface in = border({1, n}), out = border({n, 1});
    const double normal = (n - 1) / (n + 1) * (n - 1) / (n + 1);
    for (const kernel::Interface& b : {in, out}) {
      const kernel::Fresnel f = kernel::fresnel(b, 1.0f);
      CHECK(std::abs(f.R - normal) <= 8 * float_ulp(normal));
      CHECK(f.r_perp == -f.r_par);
    }
    // Brewster: tan theta = n, no reflection in the plane of incidence.
    const kernel::Fresnel brewster = kernel::fresnel(in, static_cast<float>(1 / std::sqrt(1 + n * n)));
    const double s = (n - 1) * (n + 1) / (n * n + 1);
    CHECK(std::abs(brewster.r_par) < 2e-7);
    CHECK(brewster.R == doctest::Approx(s * s / 2).epsilon(1e-6));
    CHECK(brewster.bend == doctest::Approx((n - 1 / n) / std::sqrt(1 + n * n)).epsilon(1e-6));

    const kernel::Fresnel half_right = kernel::fresnel(in, static_cast<float>(std::sqrt(0.5)));
    // r_par / r_perp is a difference of squares of sine and cosine here: known to their rounding.
    CHECK(std::abs(half_right.r_par - half_right.r_perp * half_right.r_perp) <= 2e-7 * std::abs(half_right.r_perp));

    // Reciprocity at conjugate angles: the same T, amplitudes of opposite sign. The conjugate cosine is a float, and
    // so not quite it.
    for (const double c : {0.1, 0.5, 0.9}) {
      const double c_t = std::sqrt(1 - (1 - c * c) / (n * n));
      const kernel::Fresnel there = kernel::fresnel(in, static_cast<float>(c));
      const kernel::Fresnel back = kernel::fresnel(out, static_cast<float>(c_t));
      CHECK(back.T == doctest::Approx(there.T).epsilon(1e-5));
      CHECK(back.r_perp == doctest::Approx(-there.r_perp).epsilon(2e-5));
      CHECK(back.r_par == doctest::Approx(-there.r_par).epsilon(2e-5));
    }

    // Snell's window: out of the denser medium, the directions that pass fill 2 pi (1 - sqrt(1 - 1 / n^2)).
    const double critical = std::sqrt((1 - 1 / n) * (1 + 1 / n));
    CHECK(kernel::fresnel(out, static_cast<float>(critical * (1 - 3e-7))).total);
    CHECK(!kernel::fresnel(out, static_cast<float>(critical * (1 + 3e-7))).total);
    const kernel::Fresnel inside = kernel::fresnel(out, static_cast<float>(critical / 2));
    CHECK(inside.R == 1);
    CHECK(inside.T == 0);
  }
}

TEST_CASE("fresnel.cl: transmittance and absorptance against long double") {
  FresnelInputs inputs(6);
  Worst left, absorbed, sum;
  int dark = 0;
  for (int i = 0; i < 2'000'000; ++i) {
    const auto [sigma_a, distance] = inputs.absorbing_path();
    const float t = kernel::transmittance(sigma_a, distance), a = kernel::attenuation(sigma_a, distance).taken;
    const Indices at = {sigma_a, distance};
    const double truth = reference::transmittance(sigma_a, distance);
    const double x = sigma_a == 0 || distance == 0 ? 0.0 : static_cast<double>(sigma_a) * distance;
    if (truth >= least_normal) {
      left.add(std::abs(t - truth) / truth, at, t);
    } else {
      ++dark;
      // At the limit, one side of it or the other.
      left.add(truth > least_normal * (1 - 5e-7) ? (t == 0 ? 0.0 : std::abs(t - truth) / truth) : t, at, t);
    }
    const double taken = -std::expm1(-x);
    absorbed.add(std::abs(a - taken) / float_ulp(taken), at, a);
    sum.add(std::abs(static_cast<double>(t) + a - 1), at, t);
  }
  MESSAGE(told("transmittance, relative (n_i: sigma_a, n_t: distance)", left));
  MESSAGE(told("absorptance [ulp]", absorbed));
  MESSAGE(told("|transmittance + absorptance - 1|", sum));
  CHECK(left.error <= 5e-7);
  CHECK(absorbed.error <= 6);
  CHECK(sum.error <= 2e-7);
  CHECK(dark > 1000);

  CHECK(kernel::transmittance(infinity, 0.0f) == 1);
  CHECK(kernel::transmittance(infinity, 0x1p-149f) == 0);
  CHECK(kernel::attenuation(infinity, 0.0f).taken == 0);
  CHECK(kernel::attenuation(infinity, 0x1p-149f).taken == 1);
  CHECK(kernel::transmittance(0.0f, 3e38f) == 1);
  CHECK(kernel::attenuation(0.0f, 3e38f).taken == 0);
  CHECK(kernel::transmittance(1e30f, 1e30f) == 0);
  CHECK(kernel::attenuation(1e30f, 1e30f).taken == 1);
}

TEST_CASE("fresnel.cl: sigma_a of rho_d against quadruple precision") {
  FresnelInputs inputs(7);
  Worst worst;
  for (int i = 0; i < 1'000'000; ++i) {
    const float rho_d = inputs.reflectance();
    const float sigma_a = kernel::sigma_a_from_rho_d(rho_d);
    if (rho_d < least_normal) {
      REQUIRE(sigma_a == infinity);
      continue;
    }
    const double truth = reference::sigma_a_from_rho_d(rho_d);
    worst.add(std::abs(sigma_a - truth) / float_ulp(truth), {}, rho_d);
  }
  MESSAGE(told("sigma_a [ulp] (cos: rho_d)", worst));
  CHECK(worst.error <= 2);
  CHECK(kernel::sigma_a_from_rho_d(1.0f) == 0);
  CHECK(kernel::sigma_a_from_rho_d(0.5f) == 1);
  CHECK(kernel::sigma_a_from_rho_d(0.0f) == infinity);
  CHECK(kernel::sigma_a_from_rho_d(1.0f - 0x1p-24f) == doctest::Approx(0x1p-24).epsilon(1e-6));
}
