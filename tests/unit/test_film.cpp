#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/error.hpp"
#include "film/film.hpp"

using namespace vitrum;

TEST_CASE("the mean weights passes by their samples, and passes go to replicates in turn") {
  Film film(2, 1, 4);
  film.add(0, "radiance", 1, std::vector<float>{2, 4}, 2);    // sums of 2 samples: means 1, 2
  film.add(4, "radiance", 1, std::vector<float>{12, 0}, 3);   // the same replicate
  film.add(6, "radiance", 1, std::vector<float>{1, 1}, 5);
  CHECK(film.mean("radiance") == std::vector<double>{1.5, 0.5});
  REQUIRE(film.plane("radiance", 0));
  CHECK(film.plane("radiance", 0)->sums == std::vector<double>{14, 4});
  CHECK(film.plane("radiance", 0)->samples == 5);
  CHECK(film.plane("radiance", 1) == nullptr);
  REQUIRE(film.plane("radiance", 2));
  CHECK(film.plane("radiance", 2)->samples == 5);
  CHECK(film.mean("depth").empty());
  CHECK(film.variance_of_mean("depth").empty());
  film.add(0, "depth", 1, std::vector<float>{1, 1}, 1);
  CHECK(film.names() == std::vector<std::string>{"depth", "radiance"});
  CHECK(film.variance_of_mean("depth").empty());  // one replicate says nothing about scatter
}

TEST_CASE("the variance of the mean, by hand") {
  Film film(1, 1, 8);
  film.add(0, "x", 1, std::vector<float>{2}, 1);
  film.add(1, "x", 1, std::vector<float>{4}, 1);
  film.add(2, "x", 1, std::vector<float>{6}, 1);
  CHECK(film.variance_of_mean("x").at(0) == doctest::Approx(8.0 / (3 * 2)));
  // Replicates of unequal size: means 2 (1 sample), 4 (3 samples); mean 3.5.
  Film uneven(1, 1, 2);
  uneven.add(0, "x", 1, std::vector<float>{2}, 1);
  uneven.add(1, "x", 1, std::vector<float>{12}, 3);
  CHECK(uneven.variance_of_mean("x").at(0) == doctest::Approx((1 * 1.5 * 1.5 + 3 * 0.5 * 0.5) / 4));
}

TEST_CASE("the variance of the mean is unbiased, also with unequal replicates") {
  // Each pixel is an experiment of its own: uniform samples (variance 1/12), 1 + r of them in replicate r.
  constexpr int pixels = 20000;
  Film film(pixels, 1, 8);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform;
  int samples = 0;
  for (int r = 0; r < 8; ++r) {
    std::vector<float> sums(pixels);
    for (float& sum : sums) {
      for (int s = 0; s <= r; ++s) sum += uniform(random);
    }
    film.add(uint64_t(r), "x", 1, sums, r + 1);
    samples += r + 1;
  }
  double mean_variance = 0;
  for (const double variance : film.variance_of_mean("x")) mean_variance += variance / pixels;
  // The estimate of one pixel scatters by about sqrt(2 / 7), so that of 20000 by .4 %; 5 sigma.
  CHECK(std::abs(mean_variance * 12 * samples - 1) < 0.02);
}

TEST_CASE("the variance of the mean is nearly unbiased where all replicates are equally noisy, too") {
  // As photons make them: 7 replicates of 2 samples and one of 1, all of variance 1/12. The variance of their weighted mean
  // is (7 * 4 + 1) / 225 / 12; the estimate's expectation is .3 % less, and with weights w_r alone it is 3.5 % less.
  constexpr int pixels = 100000;
  Film film(pixels, 1, 8);
  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform;
  for (int r = 0; r < 8; ++r) {
    const float samples = r < 7 ? 2 : 1;
    std::vector<float> sums(pixels);
    for (float& sum : sums) sum = samples * uniform(random);
    film.add(uint64_t(r), "x", 1, sums, double(samples));
  }
  double mean_variance = 0;
  for (const double variance : film.variance_of_mean("x")) mean_variance += variance / pixels;
  // The estimate of 100000 pixels scatters by .17 %; 5 sigma and the bias.
  CHECK(std::abs(mean_variance * 12 * 225 / 29 - 1) < 0.012);
}

TEST_CASE("values that are not finite are rejected, counted, and leave the rest of their pixel as it is") {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinite = std::numeric_limits<float>::infinity();
  Film film(2, 1, 2);
  CHECK(film.add(0, "x", 2, std::vector<float>{2, nan, 4, -infinite}, 2) == 2);
  CHECK(film.add(1, "x", 2, std::vector<float>{9, 9, 9, nan}, 3) == 1);
  CHECK(film.add(2, "x", 2, std::vector<float>{1, 5, 1, nan}, 1) == 1);
  const std::vector<double> mean = film.mean("x");
  CHECK(mean[0] == 2);                // (2 + 9 + 1) / 6
  CHECK(mean[1] == 14.0 / 4);         // without the first 2 samples
  CHECK(mean[2] == 14.0 / 6);
  CHECK(std::isnan(mean[3]));         // nothing is left of it
  // Means 5 (1 sample) and 3 (3 samples), 3.5 in all.
  CHECK(film.variance_of_mean("x")[1] == doctest::Approx((1 * 1.5 * 1.5 + 3 * 0.5 * 0.5) / 4));
  CHECK(std::isnan(film.variance_of_mean("x")[3]));
  Film other(2, 1, 2);
  other.add(4, "x", 2, std::vector<float>{nan, 2, 2, 2}, 2);
  film.merge(other);
  CHECK(film.mean("x") == std::vector<double>{2, 16.0 / 6, 2, 1});
}

TEST_CASE("two films merged are the film of all passes") {
  Film whole(2, 2, 3), even(2, 2, 3), odd(2, 2, 3);
  for (uint64_t pass = 0; pass < 12; ++pass) {
    std::vector<float> sums(12);
    for (size_t i = 0; i < sums.size(); ++i) sums[i] = float(pass * 12 + i) * 0.25f;
    whole.add(pass, "radiance", 3, sums, double(pass + 1));
    (pass % 2 ? odd : even).add(pass, "radiance", 3, sums, double(pass + 1));
  }
  odd.add(1, "depth", 1, std::vector<float>{1, 2, 3, 4}, 1);
  even.merge(odd);
  CHECK(even.mean("radiance") == whole.mean("radiance"));
  CHECK(even.variance_of_mean("radiance") == whole.variance_of_mean("radiance"));
  CHECK(even.mean("depth") == std::vector<double>{1, 2, 3, 4});
}

TEST_CASE("films that do not belong together are not merged") {
  Film film(2, 1, 2);
  film.add(0, "a", 1, std::vector<float>{1, 2}, 1);
  CHECK_THROWS_AS(film.merge(Film(1, 2, 2)), Error);
  CHECK_THROWS_AS(film.merge(Film(2, 1, 3)), Error);
  Film other(2, 1, 2);
  other.add(0, "A", 1, std::vector<float>{1, 2}, 1);
  other.add(0, "a", 3, std::vector<float>{1, 2, 3, 4, 5, 6}, 1);
  CHECK_THROWS_AS(film.merge(other), Error);
  CHECK(film.names() == std::vector<std::string>{"a"});
  CHECK(film.mean("a") == std::vector<double>{1, 2});
}
