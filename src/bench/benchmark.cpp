#include "bench/benchmark.hpp"

#include "bench/benchmarks.hpp"

namespace vitrum {

const std::vector<Benchmark>& benchmarks() {
  static const std::vector<Benchmark> all = {
      {"photons", "error of a caustic by number of photons, against the exact one, or a scene's against a long run", true,
       true, bench_photons},
      {"camera", "error of a picture by samples a pixel, photons left out, against a long run", true, true, bench_camera},
      {"traversal", "rays a second by kind of ray and size of mesh, and memory of the mesh, beside Embree", false, true,
       bench_traversal},
      {"gather", "queries a second of both ways to gather photons, beside nanoflann", false, true, bench_gather},
      {"scaling", "cost of a photon by their number, from 10^6 to 10^9, with the memory, and by threads", false, true, bench_scaling},
      {"limits", "what the device can do at best: arithmetic, memory read and copied", false, false, bench_limits},
      {"startup", "from the start to the first pixel, with the driver's cache of kernels warm and cold", true, false,
       bench_startup},
  };
  return all;
}

}  // namespace vitrum
