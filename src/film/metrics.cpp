#include "film/metrics.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

#include "film/statistics.hpp"

namespace vitrum {
namespace {

std::string size_text(const Picture& picture) {
  return std::to_string(picture.width) + " x " + std::to_string(picture.height);
}

std::span<const float> values_of(const Picture& picture) {
  return {picture.pixels.empty() ? nullptr : &picture.pixels.front().x, 3 * picture.pixels.size()};
}

/// v - t; 0 if they are equal, infinities included, and infinite if they differ while one is NaN or infinite.
double value_difference(float v, float t) {
  if (v == t) return 0.0;
  const double difference = double(v) - double(t);
  return std::isfinite(difference) ? difference : std::numeric_limits<double>::infinity();
}

/// Means by channel, and over them.
class Means {
 public:
  explicit Means(int channels) : sums_(size_t(channels)), counts_(size_t(channels)) {}

  void add(size_t channel, double value) {
    sums_[channel] += value;
    counts_[channel] += 1.0;
  }
  /// 0 for a channel without values.
  std::vector<double> by_channel() const {
    std::vector<double> means;
    for (size_t c = 0; c < sums_.size(); ++c) means.push_back(sums_[c] / std::max(1.0, counts_[c]));
    return means;
  }
  double overall() const {
    double mean = 0.0;
    for (const double channel : by_channel()) mean += channel / double(sums_.size());
    return mean;
  }

 private:
  std::vector<double> sums_, counts_;
};

}  // namespace

PictureError values_error(std::span<const float> values, std::span<const float> truth, int width, int height,
                          int channels, double epsilon) {
  const size_t depth = size_t(channels), pixels = size_t(width) * size_t(height);
  assert(values.size() == pixels * depth && truth.size() == pixels * depth);
  PictureError error;
  Means means(channels), truth_means(channels);
  for (size_t i = 0; i < pixels; ++i) {
    bool has_other_bits = false;
    for (size_t c = 0; c < depth; ++c) {
      const float v = values[i * depth + c], t = truth[i * depth + c];
      has_other_bits = has_other_bits || std::bit_cast<uint32_t>(v) != std::bit_cast<uint32_t>(t);
      if (std::isfinite(v) && std::isfinite(t)) {
        means.add(c, v);
        truth_means.add(c, t);
      }
      const double difference = value_difference(v, t), square = difference * difference;
      error.not_finite += std::isinf(difference);
      error.bias += difference;
      error.mse += square;
      error.relative_mse += std::isinf(square) ? square : square / (double(t) * double(t) + epsilon);
      if (std::abs(difference) > error.maximum) {
        error.maximum = std::abs(difference);
        error.maximum_x = int(i % size_t(width));
        error.maximum_y = int(i / size_t(width));
        error.maximum_channel = int(c);
      }
    }
    error.differing_pixels += has_other_bits;
  }
  const double count = double(depth) * double(pixels);
  if (count > 0) {
    error.bias /= count;
    error.mse /= count;
    error.relative_mse /= count;
  }
  if (error.not_finite > 0) error.bias = std::numeric_limits<double>::quiet_NaN();
  error.rmse = std::sqrt(error.mse);
  error.relative_rmse = std::sqrt(error.relative_mse);
  error.channel_means = means.by_channel();
  error.truth_channel_means = truth_means.by_channel();
  error.mean = means.overall();
  error.truth_mean = truth_means.overall();
  return error;
}

PictureError picture_error(const Picture& picture, const Picture& truth, double epsilon) {
  if (picture.width != truth.width || picture.height != truth.height) {
    throw Error({}, "pictures of " + size_text(picture) + " and " + size_text(truth) + " pixels cannot be compared",
                "give two pictures of the same size");
  }
  return values_error(values_of(picture), values_of(truth), picture.width, picture.height, 3, epsilon);
}

double error_over_mean(std::span<const double> values, std::span<const double> truth) {
  double squares = 0.0, sum = 0.0;
  for (size_t i = 0; i < truth.size(); ++i) {
    squares += (values[i] - truth[i]) * (values[i] - truth[i]);
    sum += truth[i];
  }
  const double n = static_cast<double>(truth.size());
  return std::sqrt(squares / n) / (sum / n);
}

std::vector<float> pixel_differences(std::span<const float> values, std::span<const float> truth, int channels) {
  assert(values.size() == truth.size());
  std::vector<float> differences(values.size() / size_t(channels), 0.0f);
  for (size_t i = 0; i < values.size(); ++i) {
    float& largest = differences[i / size_t(channels)];
    largest = std::max(largest, float(std::abs(value_difference(values[i], truth[i]))));
  }
  return differences;
}

uint64_t pixels_not_finite(std::span<const float> values, int channels) {
  uint64_t count = 0;
  for (size_t i = 0; i < values.size(); i += size_t(channels)) {
    const auto pixel = values.subspan(i, size_t(channels));
    count += std::any_of(pixel.begin(), pixel.end(), [](float value) { return !std::isfinite(value); });
  }
  return count;
}

ZTest z_test(const Estimate& a, const Estimate& b, int width, int channels, double degrees, double alpha) {
  assert(a.values.size() == b.values.size() && a.values.size() == a.errors.size());
  assert(b.values.size() == b.errors.size());
  const size_t depth = size_t(channels), pixels = a.values.size() / depth;
  ZTest test;
  for (size_t i = 0; i < pixels; ++i) {
    bool is_tested = false;
    for (size_t c = 0; c < depth; ++c) {
      const size_t at = i * depth + c;
      const double value_a = a.values[at], value_b = b.values[at], error_a = a.errors[at], error_b = b.errors[at];
      const double difference = value_a - value_b, variance = error_a * error_a + error_b * error_b;
      if (!std::isfinite(difference) || !std::isfinite(variance) || error_a < 0.0 || error_b < 0.0) {
        ++test.not_testable;
        continue;
      }
      if (difference == 0.0 && variance == 0.0) continue;
      const double rounding = 0x1p-23 * std::max(std::abs(value_a), std::abs(value_b));
      const double z = difference / std::sqrt(variance + rounding * rounding);
      is_tested = true;
      ++test.tested;
      test.mean_square += z * z;
      if (std::abs(z) > std::abs(test.largest)) {
        test.largest = z;
        test.largest_x = int(i % size_t(width));
        test.largest_y = int(i / size_t(width));
        test.largest_channel = int(c);
      }
    }
    test.tested_pixels += is_tested;
  }
  if (test.tested > 0) {
    test.mean_square /= double(test.tested);
    test.limit = student_limit(sidak_level(alpha, test.tested), degrees);
    test.p_value = sidak(student_two_sided(test.largest, degrees), test.tested);
  }
  return test;
}

}  // namespace vitrum
