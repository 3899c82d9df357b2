#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <limits>

#include "film/statistics.hpp"

using namespace vitrum;

namespace {

const double pi = std::acos(-1.0);

/// How far `value` is from `truth`, relative to it.
double relative(double value, double truth) { return std::abs(value / truth - 1.0); }

}  // namespace

TEST_CASE("normal probabilities, from the middle to the far tail") {
  // Abramowitz and Stegun, table 26.1 and 26.2: Q(x), of which two sides make twice as much.
  CHECK(normal_two_sided(0.0) == 1.0);
  CHECK(relative(normal_two_sided(1.0), 2 * 0.158655253931457) < 1e-13);
  CHECK(relative(normal_two_sided(-1.959963984540054), 0.05) < 1e-13);
  CHECK(relative(normal_two_sided(6.0), 2 * 9.86587645037698e-10) < 1e-13);
  CHECK(relative(normal_two_sided(-20.0), 2 * 2.75362411860623e-89) < 1e-12);
  CHECK(std::isnan(normal_two_sided(std::numeric_limits<double>::quiet_NaN())));
}

TEST_CASE("Student's probabilities are those of the closed forms") {
  // Abramowitz and Stegun 26.7.3 and 26.7.4, in forms that keep their digits where the probability is small.
  for (int exponent = -40; exponent <= 40; ++exponent) {
    const double t = std::exp2(exponent);
    CAPTURE(t);
    CHECK(relative(student_two_sided(t, 1), 2 / pi * std::atan2(1.0, t)) < 1e-13);
    const double root = std::sqrt(2 + t * t);
    CHECK(relative(student_two_sided(t, 2), 2 / (root * (root + t))) < 1e-13);
    CHECK(student_two_sided(-t, 2) == student_two_sided(t, 2));
  }
  for (double t = 0.125; t < 20.0; t *= 1.5) {
    CAPTURE(t);
    const double three = std::atan(t / std::sqrt(3.0)), four = std::atan(t / 2.0);
    CHECK(std::abs(student_two_sided(t, 3) - (1 - 2 / pi * (three + std::sin(three) * std::cos(three)))) < 1e-14);
    CHECK(std::abs(student_two_sided(t, 4) - (1 - std::sin(four) * (1 + std::pow(std::cos(four), 2) / 2))) < 1e-14);
  }
  CHECK(student_two_sided(0.0, 7) == 1.0);
  CHECK(student_two_sided(std::numeric_limits<double>::infinity(), 7) == 0.0);
  CHECK(std::isnan(student_two_sided(std::numeric_limits<double>::quiet_NaN(), 7)));
}

TEST_CASE("Student's probabilities are those of the tables") {
  // To the seven digits of the quantiles.
  CHECK(relative(student_two_sided(2.364624, 7), 0.05) < 1e-6);
  CHECK(relative(student_two_sided(5.407883, 7), 0.001) < 1e-6);
  CHECK(relative(student_two_sided(2.144787, 14), 0.05) < 1e-6);
  CHECK(relative(student_two_sided(4.140454, 14), 0.001) < 1e-6);
}

TEST_CASE("Student's distribution of many degrees of freedom is the normal one") {
  // But for the first term of its expansion in 1 / degrees, twice (z^3 + z) phi(z) / (4 degrees); Fisher, "Expansion of
  // Student's integral in powers of n^-1", Metron 5 (1925). The next is below 1e-7 of the probability here.
  for (const double z : {0.01, 0.5, 1.0, 3.0, 6.0}) {
    CAPTURE(z);
    const double density = std::exp(-0.5 * z * z) / std::sqrt(2 * pi);
    CHECK(relative(student_two_sided(z, 1e6), normal_two_sided(z) + (z * z * z + z) * density / 2e6) < 1e-7);
  }
}

TEST_CASE("the limit is where its probability begins") {
  for (const double degrees : {1.0, 7.0, 14.0, 1000.0, 1e6}) {
    for (const double p : {0.9, 0.05, 1e-3, 1e-9, 1e-30}) {
      CAPTURE(degrees);
      CAPTURE(p);
      CHECK(relative(student_two_sided(student_limit(p, degrees), degrees), p) < 1e-9);
    }
  }
}

TEST_CASE("Sidak's correction") {
  CHECK(sidak(0.03, 1) == doctest::Approx(0.03).epsilon(1e-15));
  CHECK(sidak(0.5, 2) == 0.75);
  CHECK(sidak(0.5, 3) == 0.875);
  CHECK(relative(sidak(1e-20, 1000000), 1e-14) < 1e-12);  // where 1 - p is 1 in double
  CHECK(sidak(0.0, 10) == 0.0);
  CHECK(sidak(1.0, 10) == 1.0);
  for (const uint64_t tests : {1ull, 3ull, 1000000ull}) {
    CHECK(relative(sidak(sidak_level(1e-3, tests), tests), 1e-3) < 1e-12);
  }
}

TEST_CASE("Fisher's distribution is that of the closed forms, of Student's, and of the tables") {
  for (double f = 1e-6; f < 1e6; f *= 7.0) {
    CAPTURE(f);
    // Two degrees above: (1 + 2 f / b)^(-b / 2). The square of Student's variable has one.
    for (const double b : {1.0, 2.0, 7.0, 30.0}) CHECK(relative(fisher_above(f, 2, b), std::pow(1 + 2 * f / b, -b / 2)) < 1e-9);
    CHECK(relative(fisher_above(f, 1, 7), student_two_sided(std::sqrt(f), 7)) < 1e-9);
  }
  // Tables of the 5 % and 1 % points.
  CHECK(relative(fisher_limit(0.05, 4, 10), 3.4780) < 1e-4);
  CHECK(relative(fisher_limit(0.01, 10, 20), 3.3682) < 1e-4);
  CHECK(relative(fisher_limit(0.05, 1000, 3000), 1 / fisher_limit(0.95, 3000, 1000)) < 1e-8);
  CHECK(fisher_above(0.0, 3, 5) == 1.0);
}
