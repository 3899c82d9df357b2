#pragma once
// The benchmarks, one file each; benchmark.cpp lists them.

#include "bench/benchmark.hpp"

namespace vitrum {

BenchResult bench_photons(const BenchContext& context);
BenchResult bench_camera(const BenchContext& context);

}  // namespace vitrum
