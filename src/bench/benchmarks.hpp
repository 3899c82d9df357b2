#pragma once
// The benchmarks, one file each; benchmark.cpp lists them.

#include "bench/benchmark.hpp"

namespace vitrum {

BenchResult bench_photons(const BenchContext& context);
BenchResult bench_camera(const BenchContext& context);
BenchResult bench_traversal(const BenchContext& context);
BenchResult bench_gather(const BenchContext& context);
BenchResult bench_scaling(const BenchContext& context);
BenchResult bench_limits(const BenchContext& context);
BenchResult bench_startup(const BenchContext& context);

}  // namespace vitrum
