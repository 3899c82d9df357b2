// From the start of the program to the first pixel, with the driver's cache of kernels warm and cold.

#include <fcntl.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "bench/benchmarks.hpp"
#include "bench/side_by_side.hpp"
#include "core/error.hpp"

extern char** environ;

namespace vitrum {
namespace {

namespace fs = std::filesystem;

/// The default scene without its textures.
constexpr const char* ball_over_lawn = R"(vitrum = 1
camera = {eye = [2, 1.5, 2], look_at = [0, 0.5, 0], vertical_fov = 53}
background = {radiance = [0.1, 0.3, 0.6]}
light.lamp = {type = "point", position = [0, 1, 0], intensity = [3, 3, 3]}
shape.lawn = {type = "plane", point = [0, 0, 0], normal = [0, 1, 0], material = "green"}
shape.ball = {type = "sphere", centre = [0, 0.5, 0], radius = 0.3, material = "glass"}
shape.cardboard = {type = "triangle", a = [-0.2, 0.1, 0.9], b = [0.2, 0.1, 0.9], c = [-0.2, 0.1, -0.1], material = "green"}
material.green = {illum = 1, Kd = [0.1, 0.5, 0.1]}
material.glass = {illum = 12, Ni = 1.5, Kd = [0.6, 0.9, 0.7]}
photons = {count = 1000}
mtl = "worksheet"
)";

/// A folder that is removed with all that is in it.
class Folder {
 public:
  Folder() {
    std::string pattern = (fs::temp_directory_path() / "vitrum-bench-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr)
      throw Error({pattern}, std::string("no folder can be made here: ") + std::strerror(errno), "let TMPDIR name a place for it");
    path_ = pattern;
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string path() const { return path_.string(); }
  std::string operator/(const char* name) const { return (path_ / name).string(); }

 private:
  fs::path path_;
};

/// What a run of the program took [s].
struct Run {
  double first_pixel, process, cpu;  ///< the first by its own clock, from the start of its work
};

/// This program's `render`, in a process of its own; `cache`: the driver's folder for kernels, "": the usual one.
Run timed_run(const BenchContext& context, const Folder& folder, const std::string& scene, const std::string& cache) {
  const std::string report = folder / "report.json";
  std::vector<std::string> words = {"vitrum", "render", scene, "-o", folder / "picture.exr", "--report", report, "--quiet",
                                    "--size", "16x16", "--samples", "1", "--threads", std::to_string(context.threads)};
  if (!context.device_choice.empty()) words.insert(words.end(), {"--device", context.device_choice});
  if (!context.kernels.folder.empty()) words.insert(words.end(), {"--kernels", context.kernels.folder});
  std::vector<std::string> settings;
  for (char** setting = environ; *setting != nullptr; ++setting)
    if (cache.empty() || std::strncmp(*setting, "POCL_CACHE_DIR=", 15) != 0) settings.push_back(*setting);
  if (!cache.empty()) settings.push_back("POCL_CACHE_DIR=" + cache);
  std::vector<char*> arguments, environment;
  for (std::string& word : words) arguments.push_back(word.data());
  for (std::string& setting : settings) environment.push_back(setting.data());
  arguments.push_back(nullptr);
  environment.push_back(nullptr);

  pid_t process;
  int status;
  rusage usage;
  const auto start = std::chrono::steady_clock::now();
  const int fault = ::posix_spawn(&process, "/proc/self/exe", nullptr, nullptr, arguments.data(), environment.data());
  if (fault != 0)
    throw Error({}, std::string("vitrum does not start: ") + std::strerror(fault), "end other programs, or free memory");
  while (::wait4(process, &status, 0, &usage) < 0) {}
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (status != 0) throw Error({scene}, "`vitrum render` failed", "render it by hand with --size 16x16 --samples 1");
  double cpu = 0.0;
  for (const timeval& time : {usage.ru_utime, usage.ru_stime})
    cpu += static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  std::ifstream in(report);
  return {nlohmann::json::parse(in)["seconds"]["first pixels"], seconds, cpu};
}

BenchRow row_of(const char* what, const std::vector<Run>& runs) {
  const auto values = [&](double Run::*figure) {
    std::vector<double> all;
    for (const Run& run : runs) all.push_back(run.*figure);
    return all;
  };
  return {what, {{"first pixel s", median(values(&Run::first_pixel))},
                 {"least s", std::ranges::min(values(&Run::first_pixel))},
                 {"process s", median(values(&Run::process))},
                 {"CPU s", median(values(&Run::cpu))}}};
}

}  // namespace

BenchResult bench_startup(const BenchContext& context) {
  const int rounds = context.quick ? 1 : 5;
  const Folder folder;
  std::string scene = context.scene ? context.scene->file : folder / "scene.toml";
  if (!context.scene) std::ofstream(scene) << ball_over_lawn;
  timed_run(context, folder, scene, "");  // fills the cache
  // Where other drivers keep their kernels, they know.
  const bool has_cold = context.device.info().platform == "Portable Computing Language";
  std::vector<Run> warm, cold;
  for (int round = 0; round < rounds; ++round) {
    warm.push_back(timed_run(context, folder, scene, ""));
    if (has_cold) {
      const Folder empty;
      cold.push_back(timed_run(context, folder, scene, empty.path()));
    }
    context.progress((round + 1.0) / rounds);
  }
  BenchResult result;
  result.rows.push_back(row_of("warm", warm));
  if (has_cold) result.rows.push_back(row_of("cold", cold));
  return result;
}

}  // namespace vitrum
