// What a photon costs by their number, from one pass to a thousand, and by the number of threads.

#include <sys/resource.h>

#include <algorithm>
#include <cmath>

#include "bench/benchmarks.hpp"
#include "bench/side_by_side.hpp"
#include "verify/caustic_plate.hpp"

namespace vitrum {
namespace {

/// Photons of the run whose time is what a render takes for itself.
constexpr uint64_t next_to_none = 1024;

/// Photons through the exact ball, aimed, followed, stored and sorted: all that a pass does but for a few camera rays.
Scene photons_alone(uint64_t photons, int passes) {
  Scene scene = CausticPlate().scene;
  scene.film.width = scene.film.height = 16;
  scene.render.samples = scene.render.passes = passes;
  scene.photons.count = photons;
  scene.photons.estimate = PhotonEstimate::automatic_radius;
  scene.photons.progressive = passes > 1;
  return scene;
}

double photon_cpu_seconds(const BenchContext& context, Device& device, const Scene& scene) {
  RenderOptions options;
  options.kernels = context.kernels;
  return render(scene, device, options).cpu_seconds.at("photon");
}

/// The same, less what a render takes that has next to no photons: kernels are loaded, and a few photons choose the grid.
double seconds_of_photons(const BenchContext& context, Device& device, const Scene& scene) {
  const double all = photon_cpu_seconds(context, device, scene);
  return all - photon_cpu_seconds(context, device, photons_alone(next_to_none, 1));
}

/// The most memory that the process has had [MB].
double process_memory() {
  rusage usage;
  ::getrusage(RUSAGE_SELF, &usage);
  return 1.024e-3 * static_cast<double>(usage.ru_maxrss);
}

}  // namespace

BenchResult bench_scaling(const BenchContext& context) {
  BenchResult result;
  const uint64_t a_pass = context.quick ? 10'000 : 1'000'000;
  const int most_passes = context.quick ? 10 : 1000;
  result.plot = {"A photon's cost by the number of photons, in passes of " + printed("%.0g", static_cast<double>(a_pass)), "photons",
                 "processor time a photon [ns]", {{"exact ball", {}}}, true, true};
  std::vector<double> cost, memory;
  for (int passes = 1; passes <= most_passes; passes *= 10) {
    const uint64_t photons = a_pass * static_cast<uint64_t>(passes);
    const Scene scene = photons_alone(photons, passes);
    if (passes == 1) photon_cpu_seconds(context, context.device, scene);  // in which the driver compiles
    std::vector<double> seconds;
    for (int round = 0; round < (passes < 100 ? 5 : 1); ++round) seconds.push_back(seconds_of_photons(context, context.device, scene));
    cost.push_back(1e9 * median(seconds) / static_cast<double>(photons));
    memory.push_back(process_memory());
    result.rows.push_back({"passes", {{"photons", static_cast<double>(photons)}, {"passes", static_cast<double>(passes)},
                                      {"photon CPU s", median(seconds)}, {"ns a photon", cost.back()},
                                      {"process MB", memory.back()}}});
    result.plot.lines[0].points.emplace_back(static_cast<double>(photons), cost.back());
    context.progress(0.8 * passes / most_passes);
  }
  result.findings.push_back(printed("from %.0e to %.0e photons, a photon costs %.2f times as much, at most; the process has %.2f times the memory",
                                    static_cast<double>(a_pass), static_cast<double>(a_pass) * most_passes,
                                    *std::ranges::max_element(cost) / cost.front(), memory.back() / memory.front()));

  // Numbers of threads in turns, so that what else runs disturbs them alike.
  std::vector<unsigned> threads;
  if (context.device.info().can_be_split)
    for (unsigned n = 1; n < context.threads; n *= 2) threads.push_back(n);
  threads.push_back(context.threads);
  const Scene scene = photons_alone(context.quick ? 40'000 : 4'000'000, 1);
  std::vector<std::vector<double>> seconds(threads.size());
  const int rounds = context.quick ? 1 : 7;
  for (int round = -1; round < rounds; ++round)
    for (size_t k = 0; k < threads.size(); ++k) {
      Device device(context.device_choice, 32, 0, threads[k] == context.threads ? 0 : threads[k]);
      const double one = seconds_of_photons(context, device, scene);
      if (round >= 0) seconds[k].push_back(one);
      context.progress(0.8 + 0.2 * (round + 1.0) / (rounds + 1.0));
    }
  const double photons = static_cast<double>(scene.photons.count);
  for (size_t k = 0; k < threads.size(); ++k) {
    std::vector<double> ratios;
    for (int round = 0; round < rounds; ++round)
      ratios.push_back(seconds[k][static_cast<size_t>(round)] / seconds[0][static_cast<size_t>(round)]);
    result.rows.push_back({"threads", {{"photons", photons}, {"threads", static_cast<double>(threads[k])},
                                       {"photon CPU s", median(seconds[k])}, {"ns a photon", 1e9 * median(seconds[k]) / photons},
                                       {"times that of one", median(ratios)}}});
  }
  const double rate = 1e-6 * photons / median(seconds.back()) * threads.back();
  result.findings.push_back(printed("exact ball, aimed, followed, stored and sorted: %.3g M photons/s on %u threads, by processor time", rate,
                                    threads.back()));
  return result;
}

}  // namespace vitrum
