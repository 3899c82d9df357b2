#pragma once
// How far one picture is from another. Pure functions, in double.

#include <cstdint>
#include <span>
#include <vector>

#include "film/images.hpp"

namespace vitrum {

/// The difference of a picture from the truth, over all pixels and channels, each value v against its truth t.
/// Where v and t are equal, infinities included, the difference is 0; where they differ and one of them is NaN or
/// infinite, it is infinite, and so are all the errors below.
struct PictureError {
  double bias = 0.0;           ///< mean of v - t (NaN if there are values that are not finite)
  double mse = 0.0;            ///< mean of (v - t)^2
  double rmse = 0.0;           ///< square root of mse
  double relative_mse = 0.0;   ///< mean of (v - t)^2 / (t^2 + epsilon)
  double relative_rmse = 0.0;  ///< square root of relative_mse
  double maximum = 0.0;        ///< largest |v - t| of any channel
  int maximum_x = 0, maximum_y = 0;  ///< the first pixel that has it, from the top left
  int maximum_channel = 0;           ///< and its first channel that does
  uint64_t not_finite = 0;     ///< values that differ while one of the two is NaN or infinite
  uint64_t differing_pixels = 0;     ///< with a channel whose bits differ, as those of 0 and -0 do
  std::vector<double> channel_means, truth_channel_means;  ///< of the values where v and t are finite, by channel
  double mean = 0.0, truth_mean = 0.0;                     ///< means of those, over the channels
};

constexpr double default_epsilon = 0.01;

/// Compares `width` x `height` pixels of `channels` interleaved values with as many. `epsilon` > 0, in units of t^2,
/// keeps black pixels from deciding the relative error; .01 as in Rousselle, Knaus and Zwicker, "Adaptive sampling and
/// reconstruction using greedy error minimization" (2011), section 4.
PictureError values_error(std::span<const float> values, std::span<const float> truth, int width, int height,
                          int channels, double epsilon = default_epsilon);

/// values_error of two pictures. Throws Error if their sizes differ.
PictureError picture_error(const Picture& picture, const Picture& truth, double epsilon = default_epsilon);

/// Root of the mean squared difference over all values, relative to the mean of `truth`, of as many. Not relative_rmse,
/// which is relative value by value.
double error_over_mean(std::span<const double> values, std::span<const double> truth);

/// The largest |v - t| of each pixel's channels, as values_error takes it.
std::vector<float> pixel_differences(std::span<const float> values, std::span<const float> truth, int channels);

/// Pixels with a channel that is NaN or infinite.
uint64_t pixels_not_finite(std::span<const float> values, int channels);

/// Values with their standard errors, interleaved alike.
struct Estimate {
  std::span<const float> values, errors;
};

/// What the z-test of two independent estimates of the same picture found. For each channel of each pixel
/// z = (a - b) / sqrt(s_a^2 + s_b^2 + r^2), with the standard errors s, and r = 2^-23 max(|a|, |b|), a float's spacing,
/// so that what rounding alone makes of equal values is no evidence against them.
struct ZTest {
  uint64_t tested_pixels = 0;  ///< with a value that was tested
  uint64_t tested = 0;         ///< values; not those that are equal and have no error at all: they say nothing
  uint64_t not_testable = 0;   ///< values that are not finite, or whose error is not, or is below 0
  double largest = 0.0;        ///< the z that is farthest from 0, with its sign
  int largest_x = 0, largest_y = 0;  ///< the first pixel that has it
  int largest_channel = 0;           ///< and its first channel that does
  double mean_square = 0.0;    ///< of z: about 1 where the errors are known, more where they are themselves estimated
  double limit = 0.0;          ///< |z| at which an alarm begins; 0 if nothing was tested
  double p_value = 1.0;        ///< chance of a |z| this large anywhere, if both show the same: sidak() over the tested
};

/// The test of a picture's every value. `degrees` of freedom are those of a picture's errors: replicates - 1 where the
/// scatter of so many told them. Then the chance of an alarm (p_value < alpha) is at most `alpha` if the estimates are
/// normal and have the same mean, whatever their true errors are: the distribution of z lies between Student's of
/// `degrees` and of 2 * degrees degrees of freedom; Mickey and Brown, "Bounds on the distribution functions of the
/// Behrens-Fisher statistic", Annals of Mathematical Statistics 37 (1966). Where both true errors are equal, it is the
/// latter.
ZTest z_test(const Estimate& a, const Estimate& b, int width, int channels, double degrees, double alpha);

}  // namespace vitrum
