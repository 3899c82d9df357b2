// The z-test of two pictures: that it finds what is there, and does not find more than it says.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>

#include "film/metrics.hpp"

using namespace vitrum;

namespace {

/// A picture of random values with their standard errors.
struct Noisy {
  std::vector<float> values, errors;
  Estimate estimate() const { return {values, errors}; }
};

enum class Errors { known, of_8_replicates };

/// `count` values, each the mean of 8 normal ones around `truth`, of standard error `sigma`, which is either known or
/// estimated from the 8.
Noisy noisy(size_t count, double truth, double sigma, Errors errors, std::mt19937_64& random) {
  std::normal_distribution<double> normal(truth, sigma * std::sqrt(8.0));
  Noisy picture;
  for (size_t i = 0; i < count; ++i) {
    double sum = 0.0, squares = 0.0;
    for (int r = 0; r < 8; ++r) {
      const double value = normal(random);
      sum += value - truth;
      squares += (value - truth) * (value - truth);
    }
    const double variance = (squares - sum * sum / 8.0) / 7.0;
    picture.values.push_back(float(truth + sum / 8.0));
    picture.errors.push_back(float(errors == Errors::known ? sigma : std::sqrt(variance / 8.0)));
  }
  return picture;
}

constexpr int width = 6, height = 5, values_of_picture = width * height * 3, pictures = 2000;
constexpr double alpha = 0.05;

struct Alarms {
  int count = 0;
  double mean_square = 0.0;
};

/// How often pictures of the same truth, with these standard errors, are told from each other.
Alarms alarms(double sigma_a, double sigma_b, Errors errors, double degrees) {
  std::mt19937_64 random(20110704);
  Alarms found;
  for (int i = 0; i < pictures; ++i) {
    const Noisy a = noisy(values_of_picture, 3.0, sigma_a, errors, random);
    const Noisy b = noisy(values_of_picture, 3.0, sigma_b, errors, random);
    const ZTest test = z_test(a.estimate(), b.estimate(), width, 3, degrees, alpha);
    CHECK(test.tested == values_of_picture);
    CHECK((test.p_value < alpha) == (std::abs(test.largest) > test.limit));
    found.count += test.p_value < alpha;
    found.mean_square += test.mean_square / pictures;
  }
  return found;
}

// Of 2000 independent pictures a share of alpha gives alarm: 100, with a deviation of sqrt(2000 * .05 * .95) = 9.7.
// Five deviations are passed by chance in one of two million tests like this; the seed is fixed, so that it is no
// matter of luck.
constexpr int expected_alarms = 100, tolerance = 49;

}  // namespace

TEST_CASE("z-test: the figures of a tiny picture") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  // Four pixels of two channels: z = 2 and -5, untested and 0, NaN and 1, error NaN and error below 0.
  const std::vector<float> a{12, 0, 5, 7, nan, 2, 1, 1}, sa{3, 0.6f, 0, 1, 1, 1, nan, -1};
  const std::vector<float> b{2, 5, 5, 7, 1, 1, 2, 2}, sb{4, 0.8f, 0, 0, 1, 0, 1, 1};
  const ZTest test = z_test({a, sa}, {b, sb}, 2, 2, 7, 0.01);
  CHECK(test.tested == 4);
  CHECK(test.tested_pixels == 3);
  CHECK(test.not_testable == 3);
  CHECK(test.largest == doctest::Approx(-5).epsilon(1e-6));
  CHECK(test.largest_x == 0);
  CHECK(test.largest_y == 0);
  CHECK(test.largest_channel == 1);
  CHECK(test.mean_square == doctest::Approx((4 + 25 + 0 + 1) / 4.0).epsilon(1e-6));
  // Student's two-sided probability of 5 with 7 degrees is .0015649; four tests make about four times as much.
  CHECK(test.p_value == doctest::Approx(1 - std::pow(1 - 0.00156493, 4)).epsilon(1e-4));
  CHECK((test.p_value < 0.01) == (5 > test.limit));
}

TEST_CASE("z-test: rounding is no evidence, and a difference without any error is") {
  const std::vector<float> one{1, 1, 1}, zero{0, 0, 0}, near{1, 1 + 0x1p-23f, 1 - 0x1p-23f}, far{1, 1, 1.001f};
  const ZTest rounded = z_test({one, zero}, {near, zero}, 1, 3, 1e6, 1e-3);
  CHECK(rounded.tested == 2);
  CHECK(std::abs(rounded.largest) <= 1.0);
  CHECK(rounded.p_value > 0.5);
  CHECK(z_test({one, zero}, {far, zero}, 1, 3, 1e6, 1e-3).p_value == 0.0);
}

TEST_CASE("z-test: bit-equal pictures without errors say nothing") {
  const std::vector<float> one{1, 1, 1}, zero{0, 0, 0};
  const ZTest test = z_test({one, zero}, {one, zero}, 1, 3, 7, 1e-3);
  CHECK(test.tested == 0);
  CHECK(test.tested_pixels == 0);
  CHECK(test.p_value == 1.0);
  CHECK(test.mean_square == 0.0);
}

TEST_CASE("z-test: false alarms come at the stated rate") {
  // The variance of z^2 over `values` tells how near its mean is: five deviations here, too. That of Student's
  // distribution of n degrees is n / (n - 2), its fourth moment 3 n^2 / ((n - 2) (n - 4)).
  const double values = double(pictures) * values_of_picture;
  const auto check_mean_square = [&](double mean_square, double mean, double fourth_moment) {
    CHECK(std::abs(mean_square - mean) < 5 * std::sqrt((fourth_moment - mean * mean) / values));
  };
  SUBCASE("errors that are known") {
    const Alarms found = alarms(0.1, 0.3, Errors::known, 1e6);
    CHECK(std::abs(found.count - expected_alarms) < tolerance);
    check_mean_square(found.mean_square, 1.0, 3.0);
  }
  SUBCASE("errors that 8 replicates tell, the same in both: 14 degrees") {
    const Alarms found = alarms(0.1, 0.1, Errors::of_8_replicates, 14);
    CHECK(std::abs(found.count - expected_alarms) < tolerance);
    check_mean_square(found.mean_square, 14.0 / 12, 3 * 196.0 / (12 * 10));
  }
  SUBCASE("errors that 8 replicates tell, all in one: 7 degrees") {
    const Alarms found = alarms(0.1, 0.0, Errors::of_8_replicates, 7);
    CHECK(std::abs(found.count - expected_alarms) < tolerance);
    check_mean_square(found.mean_square, 7.0 / 5, 3 * 49.0 / (5 * 3));
  }
  SUBCASE("7 degrees are never too few, whatever the errors are") {
    for (const double sigma_b : {0.01, 0.03, 0.1}) {
      CAPTURE(sigma_b);
      CHECK(alarms(0.1, sigma_b, Errors::of_8_replicates, 7).count < expected_alarms + tolerance);
    }
  }
  SUBCASE("estimated errors that are taken for known ones give alarm far too often") {
    CHECK(alarms(0.1, 0.1, Errors::of_8_replicates, 1e6).count > 5 * expected_alarms);
  }
}

TEST_CASE("z-test: an error of one per cent is found") {
  // 3072 values of a standard error of .05 % in both: z is around 14, and where 8 replicates make the error seem less
  // than three quarters of what it is, as they do for one value in nine, it is above 19, the limit of alpha = .001.
  std::mt19937_64 random(1867);
  const Noisy a = noisy(3072, 1.0, 0.0005, Errors::of_8_replicates, random);
  const Noisy b = noisy(3072, 1.0, 0.0005, Errors::of_8_replicates, random);
  Noisy wrong = b;
  for (float& value : wrong.values) value *= 1.01f;
  CHECK(z_test(a.estimate(), b.estimate(), 32, 3, 7, 1e-3).p_value > 1e-3);
  const ZTest test = z_test(a.estimate(), wrong.estimate(), 32, 3, 7, 1e-3);
  CHECK(test.p_value < 1e-3);
  CHECK(test.largest < -test.limit);
  CHECK(test.mean_square > 100);
}
