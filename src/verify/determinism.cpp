// The same scene and seed give the same bits, however often and with whatever group size.

#include <bit>
#include <memory>

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
  scene.render.samples = 4;
  scene.render.passes = 2;
  scene.photons.count = static_cast<uint64_t>(size) * 2000;
  scene.materials.push_back(glass(1.5));
  scene.materials[0].absorption = {0.1, 0.5, 2.0};
  scene.materials.push_back(surface(Surface::opaque, 0.7));
  add(scene, Sphere{{0, 0.5, 0}, 0.3}, 0);
  add(scene, Plane{{0, 0, 0}, {0, 1, 0}, {}, {}}, 1);
  scene.lights.push_back({"lamp", {}, DiscLight{{0.1, 1.3, 0.2}, {0, -1, 0}, 0.05, Spectrum(100.0)}});
  return scene;
}

}  // namespace

std::vector<CheckResult> check_determinism(const CheckContext& context) {
  const Scene scene = small_scene(context.full ? 320 : 64);
  RenderOptions options;
  options.kernels = context.kernels;
  options.views = {View::beauty, View::caustics, View::depth};
  const RenderResult first = render(scene, context.device, options);
  uint64_t cases = 0, differing = 0;
  std::string where;
  const auto compare = [&](const RenderResult& other, const std::string& what) {
    for (const std::string& name : first.film.names()) {
      const std::vector<double> a = first.film.mean(name), b = other.film.mean(name);
      for (size_t i = 0; i < a.size(); ++i) {
        ++cases;
        if (std::bit_cast<uint64_t>(a[i]) == std::bit_cast<uint64_t>(b[i])) continue;
        if (differing++ == 0) where = what + ", plane " + name + printed(", value %zu: %.17g and %.17g", i, a[i], b[i]);
      }
    }
    for (const Spectrum PhotonBalance::*power : {&PhotonBalance::shot, &PhotonBalance::stored, &PhotonBalance::absorbed,
                                                 &PhotonBalance::direct, &PhotonBalance::lost, &PhotonBalance::cut}) {
      ++cases;
      if (first.photons.*power == other.photons.*power) continue;
      if (differing++ == 0) where = what + ", power of photons";
    }
  };
  compare(render(scene, context.device, options), "run again");
  for (const unsigned group_size : {1u, 16u, 64u, 256u}) {
    Device device(context.device_choice, group_size);
    compare(render(scene, device, options), printed("groups of %u", group_size));
  }
  return {{"determinism/same bits", cases, static_cast<double>(differing), 0, "values",
           "the first run: again, and in groups of 1, 16, 64, 256", where}};
}

}  // namespace vitrum
