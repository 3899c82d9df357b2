#include "film/statistics.hpp"

#include <cassert>
#include <cmath>
#include <initializer_list>

namespace vitrum {
namespace {

/// 1 / x, or the inverse of a tiny number in place of 0, as Lentz's method wants.
double safe_inverse(double x) {
  constexpr double tiny = 1e-300;
  return 1.0 / (std::abs(x) < tiny ? tiny : x);
}

/// The regularised incomplete beta function I_x(a, b) for x < (a + 1) / (a + b + 2), where its continued fraction
/// (DLMF 8.17.22, by Lentz's method) converges fast; `rest` is 1 - x.
double beta_fraction(double a, double b, double x, double rest) {
  double c = 1.0, d = safe_inverse(1.0 - (a + b) * x / (a + 1.0)), fraction = d;
  for (int m = 1; m < 100000; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    double change = 1.0;
    for (const double step : {even, odd}) {
      d = safe_inverse(1.0 + step * d);
      c = 1.0 + step * safe_inverse(c);
      change = c * d;
      fraction *= change;
    }
    if (std::abs(change - 1.0) < 1e-15) break;
  }
  const double log_factor =
      std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log(rest);
  return std::exp(log_factor) * fraction / a;
}

}  // namespace

double normal_two_sided(double z) { return std::erfc(std::abs(z) / std::sqrt(2.0)); }

double fisher_above(double f, double a, double b) {
  assert(f >= 0.0 && a > 0.0 && b > 0.0);
  // I_x(b / 2, a / 2) with x = b / (b + a f), written so that neither x nor 1 - x loses digits.
  const double ratio = a / b * f;
  const double x = 1.0 / (1.0 + ratio), rest = ratio / (1.0 + ratio);
  if (rest == 0.0) return 1.0;
  if (x == 0.0) return 0.0;
  return x < (0.5 * b + 1.0) / (0.5 * (a + b) + 2.0) ? beta_fraction(0.5 * b, 0.5 * a, x, rest)
                                                      : 1.0 - beta_fraction(0.5 * a, 0.5 * b, rest, x);
}

double fisher_limit(double p, double a, double b) {
  assert(p > 0.0 && p < 1.0);
  double low = -1000.0, high = 1000.0;
  for (int i = 0; i < 70; ++i) {
    const double middle = 0.5 * (low + high);
    (fisher_above(std::exp2(middle), a, b) > p ? low : high) = middle;
  }
  return std::exp2(0.5 * (low + high));
}

double student_two_sided(double t, double degrees) {
  assert(degrees > 0.0);
  if (std::isnan(t)) return t;
  if (t == 0.0) return 1.0;
  // I_x(degrees / 2, 1 / 2) with x = degrees / (degrees + t^2), written so that neither x nor 1 - x loses digits.
  const double square = t * t / degrees;
  if (std::isinf(square)) return 0.0;
  const double x = 1.0 / (1.0 + square), rest = square / (1.0 + square);
  const double a = 0.5 * degrees, b = 0.5;
  return x < (a + 1.0) / (a + b + 2.0) ? beta_fraction(a, b, x, rest) : 1.0 - beta_fraction(b, a, rest, x);
}

double student_limit(double p, double degrees) {
  assert(p > 0.0 && p < 1.0);
  // By bisection of the exponent: the limit may be anywhere from 1e-300 to 1e300.
  double low = -1000.0, high = 1000.0;
  for (int i = 0; i < 70; ++i) {
    const double middle = 0.5 * (low + high);
    (student_two_sided(std::exp2(middle), degrees) > p ? low : high) = middle;
  }
  return std::exp2(0.5 * (low + high));
}

double sidak(double p, uint64_t tests) {
  assert(tests >= 1);
  return -std::expm1(double(tests) * std::log1p(-p));
}

double sidak_level(double alpha, uint64_t tests) {
  assert(tests >= 1);
  return -std::expm1(std::log1p(-alpha) / double(tests));
}

}  // namespace vitrum
