#include "verify/caustic_picture.hpp"

#include <cmath>

#include "core/fit.hpp"
#include "film/false_colour.hpp"
#include "verify/caustic_plate.hpp"

namespace vitrum {
namespace {

constexpr int size = CausticPlate::size;

Picture grey(const std::vector<double>& values, double scale) {
  Picture picture{size, size, {}};
  for (const double value : values) picture.pixels.emplace_back(static_cast<float>(value / scale));
  return picture;
}

}  // namespace

CheckResult check_caustic_picture(const CheckContext& context) {
  CausticPlate plate;
  const std::vector<uint64_t> counts = {1u << 12, 1u << 14, 1u << 16, 1u << 18, 1u << 20, 1u << 22};
  CheckResult row{"photons/caustic picture", 0, 0.0, 0, "steps that are worse", "the ball's irradiance by quadrature", ""};
  PlotLine automatic{"vitrum, automatic radius", {}}, nearest{"50 nearest (Jensen 1996)", {}};
  PlotLine drawn{"vitrum, drawn by area", {}};
  for (PlotLine* line : {&automatic, &nearest, &drawn}) {
    for (const uint64_t count : counts) {
      Scene scene = plate.scene;
      scene.photons.count = count;
      // The caustic is finer than pixels; what is drawn is the mean over each.
      scene.render.samples = line == &drawn ? 1 : 256;
      scene.photons.estimate = line == &drawn ? PhotonEstimate::automatic : PhotonEstimate::automatic_radius;
      if (line == &nearest) {
        scene.photons.estimate = PhotonEstimate::nearest;
        scene.photons.max_radius = 0.1;
      }
      RenderOptions options;
      options.kernels = context.kernels;
      options.views = {View::caustics};
      const RenderResult result = render(scene, context.device, options);
      line->points.emplace_back(static_cast<double>(count), plate.error(result));
      if (line != &automatic || count != counts.back()) continue;
      const std::vector<double> picture = CausticPlate::irradiance(result);
      std::vector<float> errors;
      for (size_t i = 0; i < picture.size(); ++i)
        errors.push_back(static_cast<float>(std::abs(picture[i] - plate.truth()[i])));
      // A tenth of the light comes to the square.
      constexpr double half_width = CausticPlate::half_width;
      const double mean = CausticPlate::power / 10 / (4 * half_width * half_width), scale = false_colour_scale(errors);
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
  row.plots.push_back({printed("Irradiance of the default scene's caustic, %d x %d pixels: exponents %.2f, %.2f and %.2f", size, size,
                               fitted_exponent(automatic.points), fitted_exponent(nearest.points), fitted_exponent(drawn.points)),
                       "photons", "relative RMSE", {automatic, nearest, drawn}, true, true});
  return row;
}

}  // namespace vitrum
