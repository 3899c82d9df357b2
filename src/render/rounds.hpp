#pragma once
// Rendering until a picture's estimated error is small enough, or time is up.

#include <chrono>
#include <cstdint>
#include <vector>

#include "core/progress.hpp"
#include "film/film.hpp"
#include "render/kernel_context.hpp"
#include "render/passes.hpp"

namespace vitrum {

/// Photons of a pass, at most: more go to further passes.
inline constexpr uint64_t photons_in_memory = 1u << 22;

/// Root mean squared error of a picture's radiance over all its values, relative to their mean, as far as it is known: the
/// noise, by the scatter of the replicates, and the bias of the photons' estimate. What depth and weight limits cut and what
/// all photons have in common otherwise is not in it.
struct RelativeError {
  double value = 0.0;           ///< root of noise^2 + bias^2
  double low = 0.0, high = 0.0; ///< the true one lies between them in `confidence` of all cases
  double noise = 0.0, bias = 0.0;
  bool bias_known = true;       ///< false: one round of photons tells none
};

struct RoundsResult {
  static constexpr double confidence = 0.95;
  /// What ended the rounds; footprints: there is no room for so many that their bias would be small enough.
  enum class End { target, time, footprints } end = End::target;
  RelativeError error;
  int rounds = 0, passes = 0;
  double samples = 0.0;         ///< of a pixel, mean
  uint64_t rejected_values = 0; ///< as Film::add counts them
};

/// Adds passes to `film` until RenderSettings::target_error or time_limit, counted from `start`, is met; at least one round.
///
/// A round is a pass of each replicate, or more; the next is about twice as dear. Each shoots as many photons and traces as
/// many camera rays as the rounds before say is best, and deals the rays out to pixels by their variance
/// (sample_allocation.hpp). So that the picture's mean is unbiased though its samples hang on what earlier ones found, all
/// pixels of a round have the same weight, which follows from what it cost alone: its square, since the bias of photons,
/// which falls with their number, is worst in the first rounds. The bias is told by how far pictures of few and of many
/// photons are apart beyond their noise.
RoundsResult run_rounds(const KernelContext& context, Passes& passes, Film& film,
                        std::chrono::steady_clock::time_point start, Progress& progress);

}  // namespace vitrum
