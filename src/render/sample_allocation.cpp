#include "render/sample_allocation.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace vitrum {
namespace {

constexpr double least_share = 0.125;
constexpr double most_share = 64.0;
constexpr double most_samples = 1 << 16;  // of a pixel

}  // namespace

std::vector<uint32_t> allot_samples(std::span<const double> variance, int width, double mean) {
  const int height = static_cast<int>(variance.size()) / width;
  std::vector<double> deviation(variance.size());
  double sum = 0.0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      double around = 0.0;
      int pixels = 0;
      for (int v = std::max(y - 1, 0); v <= std::min(y + 1, height - 1); ++v)
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width - 1); ++u, ++pixels)
          around += variance[static_cast<size_t>(v * width + u)];
      sum += deviation[static_cast<size_t>(y * width + x)] = std::sqrt(around / pixels);
    }
  const double count = static_cast<double>(variance.size());
  std::vector<uint32_t> samples(variance.size());
  const auto allot = [&](double scale) {
    double total = 0.0;
    for (size_t i = 0; i < samples.size(); ++i) {
      const double share = sum > 0.0 ? deviation[i] / sum * count : 1.0;
      const double wanted = std::clamp(scale * std::clamp(share, least_share, most_share), 1.0, most_samples);
      // To the nearer power of two.
      samples[i] = std::bit_floor(static_cast<uint32_t>(wanted * std::sqrt(2.0)));
      total += samples[i];
    }
    return total;
  };
  // The floor and the rounding take their part, so the scale is searched for.
  double low = 0.0, high = 2.0 * mean;
  for (int i = 0; i < 20; ++i) {
    const double middle = 0.5 * (low + high);
    (allot(middle) > mean * count ? high : low) = middle;
  }
  allot(low);
  return samples;
}

Growth best_growth(const Spending& spent, double factor) {
  const double all = factor * (spent.photon_cost + spent.camera_cost);
  if (!(spent.photon_cost > 0.0)) return {1.0, factor};
  // P / x + C / y with x p + y c = all is least where x / y = sqrt(P c / (C p)).
  const double towards_photons = std::sqrt(spent.photon_error * spent.camera_cost);
  const double towards_camera = std::sqrt(spent.camera_error * spent.photon_cost);
  const double least = std::min(0.5, factor), most = 4.0;
  const double both = towards_photons * spent.photon_cost + towards_camera * spent.camera_cost;
  double photons = both > 0.0 ? towards_photons * all / both : factor;
  photons = std::clamp(photons, least, std::min(most, (all - least * spent.camera_cost) / spent.photon_cost));
  const double samples = std::clamp((all - photons * spent.photon_cost) / spent.camera_cost, least, most);
  return {photons, samples};
}

}  // namespace vitrum
