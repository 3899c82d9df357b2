#pragma once
// Significance: how likely chance alone gives a statistic at least so far from 0. Pure functions, in double, also where
// probabilities are as small as 1e-300.

#include <cstdint>

namespace vitrum {

/// Probability that a standard normal variable is at least |z| away from 0. NaN for NaN.
double normal_two_sided(double z);

/// Probability that a variable of Student's distribution with `degrees` > 0 degrees of freedom is at least |t| away
/// from 0. It is that of a difference over its standard error where the latter is itself estimated, from degrees + 1
/// normal values, and has far longer tails than the normal one: |t| = 6 is met by chance in 5e-4 of all cases with 7
/// degrees, in 2e-9 of the cases where the standard error is known. NaN for NaN; relative error below 1e-8 up to 1e6
/// degrees and |t| = 1e150.
/// NIST Digital Library of Mathematical Functions, 8.17.5 to 8.17.22; Abramowitz and Stegun, 26.7.1.
double student_two_sided(double t, double degrees);

/// The t > 0 with student_two_sided(t, degrees) = p, for p in (0, 1): where an alarm of that probability begins.
double student_limit(double p, double degrees);

/// Probability that a variable of Fisher's distribution, the ratio of two independent chi-squared variables over their
/// degrees of freedom, a > 0 above and b > 0 below, is at least f >= 0. DLMF 8.17, Abramowitz and Stegun 26.6.2.
double fisher_above(double f, double a, double b);

/// The f > 0 with fisher_above(f, a, b) = p, for p in (0, 1).
double fisher_limit(double p, double a, double b);

/// Probability that the least of the p-values of `tests` >= 1 tests is `p` or less if there is nothing to find:
/// 1 - (1 - p)^tests, exact for independent tests. Where the tests depend on each other, as pixels do that share their
/// photons, it is an upper bound for two-sided tests of normal values, whatever their correlations:
/// Sidak, "Rectangular confidence regions for the means of multivariate normal distributions", JASA 62 (1967).
double sidak(double p, uint64_t tests);

/// The p-value that each of `tests` >= 1 tests may have so that sidak() gives `alpha`, in (0, 1): inverse of sidak().
double sidak_level(double alpha, uint64_t tests);

}  // namespace vitrum
