#include "bench/benchmark.hpp"

#include "bench/benchmarks.hpp"

namespace vitrum {

const std::vector<Benchmark>& benchmarks() {
  static const std::vector<Benchmark> all = {
      {"photons", "error of a caustic by number of photons, against the exact one, or a scene's against a long run", true,
       bench_photons},
      {"camera", "error of a picture by samples a pixel, photons left out, against a long run", true, bench_camera},
  };
  return all;
}

}  // namespace vitrum
