#pragma once
// Where samples go: to pixels by what their samples scatter, and to photons or camera rays by what each would gain.

#include <cstdint>
#include <span>
#include <vector>

namespace vitrum {

/// Samples of each pixel, `mean` > 0 of them on average or somewhat fewer (each a power of two, at least 1), where one sample of a pixel
/// has the variance `variance`, estimated from few. The sum of squared errors is least where a pixel's share goes as the root
/// of its variance (Neyman 1934). Variance is taken as the mean of a pixel and its 8 neighbours, and no pixel gets less
/// than a share of 1/8, since what few samples have missed shows no variance, nor more than 64, since what few samples have
/// met by chance seems all there is.
std::vector<uint32_t> allot_samples(std::span<const double> variance, int width, double mean);

/// What a round of passes costs and what error it left, and of the next round, by how much more of each to take.
struct Spending {
  double photon_cost = 0.0, camera_cost = 0.0;    ///< in equal units
  double photon_error = 0.0, camera_error = 0.0;  ///< squares: each falls as one over what is spent on it
};
struct Growth { double photons = 1.0, samples = 1.0; };

/// How to spend `factor` times as much in all, so that the sum of the errors is least: neither shrinks by more than half nor
/// grows by more than 4.
Growth best_growth(const Spending& spent, double factor);

}  // namespace vitrum
