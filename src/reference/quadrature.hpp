#pragma once
// Integrals and roots in one dimension, to nearly the last digit of double.

#include <functional>
#include <vector>

namespace vitrum::reference {

using Function = std::function<double(double)>;

/// Integral of `f` over [a, b] by adaptive Gauss-Kronrod (7, 15): halves intervals until their two estimates differ by
/// at most `tolerance` (absolute, shared out over the halves). `f` should be smooth: split at its jumps.
double integral(const Function& f, double a, double b, double tolerance);

/// Where the continuous function `f` changes its sign in (a, b), ascending. Looked for at `steps` even steps, and
/// around the extremes in between, so that two roots closer than a step are not lost.
std::vector<double> roots(const Function& f, double a, double b, int steps);

}  // namespace vitrum::reference
