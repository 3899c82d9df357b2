#include "verify/caustic_picture.hpp"

#include <cmath>
#include <numbers>

#include "film/false_colour.hpp"
#include "reference/ball_caustic.hpp"
#include "render/render.hpp"
#include "verify/estimates.hpp"
#include "verify/scenes.hpp"

namespace vitrum {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double power = 4 * pi;            // of the lamp's 1 W/sr [W]
constexpr double reflectance = 0.5;
constexpr double half_width = 0.2;          // of the square that is seen [m]
constexpr int size = 128;

/// The default scene's ball and lamp above a plane, seen from right below the ball, which ends at a height of .2 m.
Scene caustic_scene() {
  Scene scene;
  scene.camera = {CameraType::pinhole, {0, 0.19, 0}, {0, 0, 0}, {0, 0, 1}, 2 * std::atan(half_width / 0.19) * 180 / pi};
  scene.film.width = scene.film.height = size;
  scene.materials = {glass(1.5), surface(Surface::opaque, reflectance)};
  add(scene, Sphere{{0, 0.5, 0}, 0.3}, 0);
  add(scene, Plane{{0, 0, 0}, {0, 1, 0}, {}, {}}, 1);
  scene.lights.push_back({"lamp", {}, PointLight{{0, 1, 0}, Spectrum(1.0)}});
  scene.render.samples = 256;               // the caustic is finer than pixels
  return scene;
}

/// Irradiance [W/m2] of each pixel.
std::vector<double> irradiance(const CheckContext& context, const Scene& scene) {
  RenderOptions options;
  options.kernels = context.kernels;
  options.views = {View::caustics};
  const std::vector<double> radiance = render(scene, context.device, options).film.mean("caustics");
  std::vector<double> red;
  for (size_t i = 0; i < radiance.size(); i += 3) red.push_back(radiance[i] * pi / reflectance);
  return red;
}

Picture grey(const std::vector<double>& values, double scale) {
  Picture picture{size, size, {}};
  for (const double value : values) picture.pixels.emplace_back(static_cast<float>(value / scale));
  return picture;
}

}  // namespace

CheckResult check_caustic_picture(const CheckContext& context) {
  const std::vector<double> truth =
      reference::irradiance_picture(reference::default_scene_ball(), power, half_width, size, size);
  const std::vector<bool> mask = reference::disc_mask(half_width, size, size, half_width);
  const std::vector<uint64_t> counts = {1u << 12, 1u << 14, 1u << 16, 1u << 18, 1u << 20, 1u << 22};
  CheckResult row{"photons/caustic picture", 0, 0.0, 0, "steps that are worse", "the ball's irradiance by quadrature", ""};
  PlotLine automatic{"automatic radius", {}}, nearest{"50 nearest (Jensen 1996)", {}};
  for (PlotLine* line : {&automatic, &nearest}) {
    for (const uint64_t count : counts) {
      Scene scene = caustic_scene();
      scene.photons.count = count;
      if (line == &nearest) {
        scene.photons.estimate = PhotonEstimate::nearest;
        scene.photons.max_radius = 0.1;
      }
      const std::vector<double> picture = irradiance(context, scene);
      line->points.emplace_back(static_cast<double>(count), reference::relative_rmse(picture, truth, mask));
      if (line != &automatic || count != counts.back()) continue;
      std::vector<float> errors;
      for (size_t i = 0; i < truth.size(); ++i) errors.push_back(static_cast<float>(std::abs(picture[i] - truth[i])));
      const double mean = power / 10 / (4 * half_width * half_width), scale = false_colour_scale(errors);
      row.pictures.push_back({printed("caustic of the default scene's ball, r < %g m, %.1e photons; white is %g W/m2", half_width,
                                      static_cast<double>(count), 4 * mean), grey(picture, 4 * mean)});
      row.pictures.push_back({printed("its error, from 0 to %g W/m2", scale), false_colour_picture(errors, size, size, scale)});
    }
  }
  for (size_t k = 1; k < counts.size(); ++k) {
    ++row.cases;
    if (automatic.points[k].second < automatic.points[k - 1].second) continue;
    row.worst += 1;
    row.worst_input = printed("%llu photons", static_cast<unsigned long long>(counts[k]));
  }
  row.plots.push_back({printed("Irradiance of the default scene's caustic, %d x %d pixels: exponents %.2f and %.2f", size, size,
                               fitted_exponent(automatic.points), fitted_exponent(nearest.points)),
                       "photons", "relative RMSE", {automatic, nearest}, true, true});
  return row;
}

}  // namespace vitrum
