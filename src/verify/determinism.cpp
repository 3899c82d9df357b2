// The same scene and seed give the same bits: again, in groups of other sizes, by other numbers of threads and launches.

#include <bit>
#include <set>
#include <utility>

#include "render/render.hpp"
#include "verify/groups.hpp"
#include "verify/scenes.hpp"

namespace vitrum {
namespace {

/// A ball with a caustic over a plane, under a lamp with an area.
Scene small_scene(int size) {
  Scene scene;
  scene.camera = {CameraType::pinhole, {2, 1.5, 2}, {0, 0.4, 0}, {0, 1, 0}, 40};
  scene.film.width = size;
  scene.film.height = size * 3 / 4;
  scene.background = {0.1, 0.3, 0.6};
  scene.render.samples = 8;
  scene.render.passes = 2;
  scene.photons.count = static_cast<uint64_t>(size) * 4000;
  scene.materials.push_back(glass(1.5));
  scene.materials[0].absorption = {0.1, 0.5, 2.0};
  scene.materials.push_back(surface(Surface::opaque, 0.7));
  add(scene, Sphere{{0, 0.32, 0}, 0.3}, 0);
  add(scene, Plane{{0, 0, 0}, {0, 1, 0}, {}, {}}, 1);
  scene.lights.push_back({"lamp", {}, DiscLight{{0.1, 1.3, 0.2}, {0, -1, 0}, 0.05, Spectrum(100.0)}});
  return scene;
}

/// A picture and what became of the photons' power, held against others.
class FirstRun {
 public:
  explicit FirstRun(RenderResult run) : first_(std::move(run)) {}

  void compare(const RenderResult& other, const std::string& what) {
    for (const std::string& name : first_.film.names()) {
      const std::vector<double> a = first_.film.mean(name), b = other.film.mean(name);
      for (size_t i = 0; i < a.size(); ++i) {
        ++cases_;
        if (std::bit_cast<uint64_t>(a[i]) == std::bit_cast<uint64_t>(b[i])) continue;
        if (differing_++ == 0)
          where_ = what + ", plane " + name + printed(", value %zu: %.17g and %.17g", i, a[i], b[i]);
      }
    }
    for (const Spectrum PhotonBalance::*power : {&PhotonBalance::shot, &PhotonBalance::stored, &PhotonBalance::absorbed,
                                                 &PhotonBalance::direct, &PhotonBalance::lost, &PhotonBalance::cut}) {
      ++cases_;
      if (first_.photons.*power == other.photons.*power) continue;
      if (differing_++ == 0) where_ = what + ", power of photons";
    }
  }

  /// What was compared since the last row.
  CheckResult row(const char* name, const std::string& truth) {
    return {std::string("determinism/") + name, std::exchange(cases_, 0),
            static_cast<double>(std::exchange(differing_, 0)), 0, "values", truth, std::exchange(where_, "")};
  }

 private:
  RenderResult first_;
  uint64_t cases_ = 0, differing_ = 0;
  std::string where_;
};

}  // namespace

std::vector<CheckResult> check_determinism(const CheckContext& context) {
  const Scene scene = small_scene(context.full ? 320 : 64);
  RenderOptions options;
  options.kernels = context.kernels;
  options.views = {View::beauty, View::caustics, View::depth};
  FirstRun first(render(scene, context.device, options));
  std::vector<CheckResult> rows;

  first.compare(render(scene, context.device, options), "run again");
  // Each size is compiled by itself, which is most of a quick run with a cold cache.
  for (const unsigned group_size : context.full ? std::vector{1u, 16u, 64u, 256u} : std::vector{1u, 64u}) {
    Device device(context.device_choice, group_size);
    first.compare(render(scene, device, options), printed("groups of %u", group_size));
  }
  rows.push_back(first.row("same bits", "the first run: again, and in groups of other sizes"));

  const unsigned all = context.device.info().compute_units;
  std::string tried;
  if (context.device.info().can_be_split)
    for (const unsigned some : std::set<unsigned>{1, std::min(2u, all - 1), all - 1}) {
      Device device(context.device_choice, 32, 0, some);
      first.compare(render(scene, device, options), printed("%u of %u compute units", some, all));
      tried += (tried.empty() ? "" : ", ") + std::to_string(some);
    }
  rows.push_back(first.row("threads", tried.empty() ? "not tried: this device cannot be split"
                                                    : "the first run: by " + tried + printed(" of %u compute units", all)));

  for (const Launches& launches : {Launches{1u << 12, 1u << 10, 1, false}, Launches{3u << 10, 208, 2, true},
                                   Launches{1u << 17, 1u << 17, 64, false}}) {
    options.launches = launches;
    first.compare(render(scene, context.device, options),
                  printed("launches of %u photons, %u pixels%s, %u samples", launches.photons, launches.pixels,
                          launches.last_pixels_first ? " from the last on" : "", launches.samples));
  }
  rows.push_back(first.row("launches", "the first run: in launches of other sizes, and the last pixels first"));
  return rows;
}

}  // namespace vitrum
