#pragma once
// What `vitrum bench` measures: error against processor time, rates beside those of a library that does the same, and
// start-up. A new benchmark is a file beside this one, declared in benchmarks.hpp and listed in benchmark.cpp.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/plot.hpp"
#include "core/printed.hpp"
#include "device/kernels.hpp"
#include "device/opencl.hpp"
#include "film/images.hpp"
#include "scene/scene.hpp"

namespace vitrum {

/// A number of a row, with its name and unit.
struct Figure {
  std::string name;             ///< "error", "CPU s", ...: the same in each row of a table
  double value = 0.0;
};

/// One run, or one pair of them side by side.
struct BenchRow {
  std::string what;             ///< "exact ball, 16384 photons"
  std::vector<Figure> figures;
};

struct BenchResult {
  std::vector<BenchRow> rows;
  std::vector<std::string> findings;  ///< a sentence each: fitted slopes, ratios
  Plot plot;                  
  PictureLayer truth;           ///< the picture that errors are from
  int width = 0, height = 0;    ///< its size [pixels]
};

/// What a benchmark works with.
struct BenchContext {
  Device& device;
  std::string device_choice;    ///< as --device says it, for a process of its own
  unsigned threads;             ///< of a CPU device, and of a library beside it
  KernelFiles kernels;
  const Scene* scene = nullptr; ///< the user's; none: the benchmark's own
  bool quick = false;           ///< seconds instead of minutes, with figures that say little
  std::function<void(double)> progress;  ///< told how much is done, 0 to 1
};

struct Benchmark {
  const char* name;             ///< as on the command line
  const char* what;             ///< for --help
  bool takes_scene;
  bool has_plot;
  BenchResult (*run)(const BenchContext&);  ///< throws Error as the device and its kernels do
};

/// All of them.
const std::vector<Benchmark>& benchmarks();

}  // namespace vitrum
