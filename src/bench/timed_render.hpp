#pragma once
// Renders of a benchmark: their processor time, and their error against a long run.

#include <vector>

#include "bench/benchmark.hpp"
#include "render/render.hpp"

namespace vitrum {

/// Renders the scene's `view` until its processor time is the least of three runs (one, if it takes more than a second),
/// after one that is not counted, in which the driver compiles; the result's seconds are of that run.
RenderResult timed_render(const BenchContext& context, const Scene& scene, View view);

/// What the long run of a user's scene is: `truth_factor` times the photons, or samples, of the longest that is measured.
constexpr uint64_t truth_factor = 16;

/// Processor time of photons and camera rays together, without what comes before the first pass [s].
double compute_seconds(const RenderResult& result);

}  // namespace vitrum
