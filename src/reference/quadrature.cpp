#include "reference/quadrature.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace vitrum::reference {
namespace {

// Nodes and weights of Piessens et al., QUADPACK (1983), qk15; odd nodes are Gauss's.
constexpr std::array<double, 8> nodes{0.991455371120812639206854697526329, 0.949107912342758524526189684047851,
                                      0.864864423359769072789712788640926, 0.741531185599394439863864773280788,
                                      0.586087235467691130294144691258380, 0.405845151377397166906606412076961,
                                      0.207784955007898467600689403773245, 0.0};
constexpr std::array<double, 8> kronrod{0.022935322010529224963732008058970, 0.063092092629978553290700663189204,
                                        0.104790010322250183839876322541518, 0.140653259715525918745189590510238,
                                        0.169004726639267902826583426598550, 0.190350578064785409913256402421014,
                                        0.204432940075298892414161999234649, 0.209482141084727828012999174891714};
constexpr std::array<double, 4> gauss{0.129484966168869693270611432679082, 0.279705391489276667901467771423780,
                                      0.381830050505118944950369775488975, 0.417959183673469387755102040816327};

double adaptive(const Function& f, double a, double b, double tolerance, int depth) {
  const double centre = (a + b) / 2, half = (b - a) / 2;
  double by_gauss = 0, by_kronrod = 0;
  for (size_t k = 0; k < nodes.size(); ++k) {
    const double x = half * nodes[k];
    const double sum = nodes[k] == 0 ? f(centre) : f(centre - x) + f(centre + x);
    by_kronrod += kronrod[k] * sum;
    if (k % 2 == 1) by_gauss += gauss[k / 2] * sum;
  }
  if (std::abs(by_kronrod - by_gauss) * half <= tolerance || depth == 0) return by_kronrod * half;
  return adaptive(f, a, centre, tolerance / 2, depth - 1) + adaptive(f, centre, b, tolerance / 2, depth - 1);
}

double bisected(const Function& f, double a, double b) {
  const bool negative_at_a = f(a) < 0;
  for (;;) {
    const double middle = (a + b) / 2;
    if (middle <= a || middle >= b) return middle;
    (((f(middle) < 0) == negative_at_a) ? a : b) = middle;
  }
}

// Where f is extreme in [a, b], holding one extreme: golden section on sign * f, looking for the least.
double extreme(const Function& f, double sign, double a, double b) {
  const double ratio = (std::sqrt(5.0) - 1) / 2;
  for (int k = 0; k < 80; ++k) {
    const double left = b - ratio * (b - a), right = a + ratio * (b - a);
    (sign * f(left) < sign * f(right) ? b : a) = sign * f(left) < sign * f(right) ? right : left;
  }
  return (a + b) / 2;
}

}  // namespace

double integral(const Function& f, double a, double b, double tolerance) {
  return adaptive(f, a, b, tolerance, 40);
}

std::vector<double> roots(const Function& f, double a, double b, int steps) {
  std::vector<double> places, values;
  const auto visit = [&](double x) { places.push_back(x), values.push_back(f(x)); };
  for (int k = 0; k <= steps; ++k) visit(a + (b - a) * k / steps);

  // An extreme that bends towards zero between three scanned places may cross it and come back.
  for (int k = 1; k < steps; ++k) {
    const double before = values[k - 1], here = values[k], after = values[k + 1];
    const double sign = here < 0 ? -1 : 1;
    if (sign * here <= sign * before && sign * here <= sign * after)
      visit(extreme(f, sign, places[k - 1], places[k + 1]));
  }

  std::vector<size_t> order(places.size());
  for (size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::sort(order.begin(), order.end(), [&](size_t p, size_t q) { return places[p] < places[q]; });
  std::vector<double> found;
  for (size_t k = 1; k < order.size(); ++k)
    if ((values[order[k - 1]] < 0) != (values[order[k]] < 0))
      found.push_back(bisected(f, places[order[k - 1]], places[order[k]]));
  return found;
}

}  // namespace vitrum::reference
