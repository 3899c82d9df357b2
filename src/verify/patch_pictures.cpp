#include "verify/patch_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/fit.hpp"
#include "verify/caustic_plate.hpp"

namespace vitrum {
namespace {

constexpr double pi = std::numbers::pi;

/// A render of the caustics, drawn by area.
RenderResult drawn(const CheckContext& context, Scene scene, uint64_t photons) {
  scene.photons.estimate = PhotonEstimate::automatic;
  scene.photons.count = photons;
  scene.render.samples = 1;
  RenderOptions options;
  options.kernels = context.kernels;
  options.views = {View::caustics};
  return render(scene, context.device, options);
}

/// The light of a lamp through a ball of air, which is as if there were none: each pixel.
CheckResult check_smooth_light(const CheckContext& context) {
  constexpr double lamp_distance = 1.25, height = lamp_distance + 2.0;  // of the lamp above the ball's centre, the plane [m]
  constexpr double cone = 2 * pi * (1.0 - 0.6);                         // of the directions that meet the ball [sr]
  constexpr double eye_height = 0.9, half_width = 0.5;                  // under the ball; of the square it sees [m]
  constexpr int size = 32;
  const uint64_t photons = context.full ? 1u << 22 : 1u << 18;
  Scene scene = ball_over_plane(1.0, {0.0, 0.5, 2.0}, lamp_distance);
  const double fov = 2 * std::atan(half_width / eye_height) * 180 / pi;
  scene.camera = {CameraType::pinhole, {0, -2 + eye_height, 0}, {0, -2, 0}, {0, 0, 1}, fov};
  scene.film.width = scene.film.height = size;
  const std::vector<double> radiance = drawn(context, scene, photons).film.mean("caustics");
  // A triangle's light is even, and in sum what the truth has there: so it is off by what the truth changes by across.
  const double r = half_width * std::numbers::sqrt2, s = std::sqrt(height * height + r * r);
  const double cell = std::sqrt(cone / static_cast<double>(photons) * s * s * s / height);
  const double bound = 3 * r / (s * s) * 2 * std::numbers::sqrt2 * cell;
  Worst worst;
  std::string where;
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column) {
      constexpr int finer = 8;
      double truth = 0.0;
      const auto at = [](int k) { return half_width * (2 * (k + 0.5) / (size * finer) - 1); };
      for (int y = row * finer; y < (row + 1) * finer; ++y)
        for (int x = column * finer; x < (column + 1) * finer; ++x)
          truth += height / (4 * pi) * std::pow(height * height + at(x) * at(x) + at(y) * at(y), -1.5) / (finer * finer);
      const size_t pixel = static_cast<size_t>(row * size + column);
      const double found = radiance[3 * pixel] * pi / 0.5, error = std::abs(found / truth - 1);
      if (!(error <= worst.error)) where = printed("pixel (%d, %d): found %.9g, truth %.9g", column, row, found, truth);
      worst.add(error, pixel);
    }
  return {"density/patches: smooth light", worst.cases, worst.error, bound, "relative", "I h/d^3, each pixel", where};
}

/// What grazes the default scene's ball and lands around its shadow: of all that lands there the outermost points of the
/// lattice tell.
CheckResult check_grazing_light(const CheckContext& context) {
  constexpr double shadow = 0.75, outer = 1.0;  // radii of a ring [m]
  CausticPlate plate;
  const double eye_height = plate.scene.camera.eye.y;
  plate.scene.camera.vertical_fov = 2 * std::atan(outer / eye_height) * 180 / pi;
  const std::vector<double> truth =
      reference::irradiance_picture(reference::default_scene_ball(), CausticPlate::power, outer, CausticPlate::size, CausticPlate::size);
  const std::vector<double> found = CausticPlate::irradiance(drawn(context, plate.scene, context.full ? 1u << 20 : 1u << 18));
  const auto within = [](double r) { return reference::disc_mask(outer, CausticPlate::size, CausticPlate::size, r); };
  const std::vector<bool> inner = within(shadow), all = within(outer);
  double sum = 0.0, sum_of_truth = 0.0;
  uint64_t pixels = 0;
  for (size_t i = 0; i < truth.size(); ++i) {
    if (inner[i] || !all[i]) continue;
    sum += found[i];
    sum_of_truth += truth[i];
    ++pixels;
  }
  return {"density/patches: grazing light", pixels, std::abs(sum / sum_of_truth - 1), 0.05, "relative", "quadrature: flux around the ball's shadow",
          printed("%.6g of the flux", sum / sum_of_truth)};
}

}  // namespace

std::vector<CheckResult> check_patches(const CheckContext& context) {
  std::vector<CheckResult> rows = {check_smooth_light(context), check_grazing_light(context)};
  Worst flux;
  std::string flux_where;
  CheckResult order{"density/patches: error", 0, -INFINITY, -0.55, "exponent", "the ball's irradiance by quadrature: photons^-.55 at least", ""};
  Plot plot{"Irradiance of the default scene's caustic, drawn by area, one sample a pixel", "photons", "relative RMSE", {}, true, true};
  for (const bool is_mesh : {false, true}) {
    if (is_mesh && !context.full) continue;
    const CausticPlate plate = is_mesh ? CausticPlate(360) : CausticPlate();
    PlotLine line{is_mesh ? "ball of 516,960 triangles" : "exact ball", {}};
    for (uint64_t photons = 1u << 12; photons <= (context.full ? 1u << 20 : 1u << 16); photons *= 4) {
      const RenderResult result = drawn(context, plate.scene, photons);
      line.points.emplace_back(static_cast<double>(photons), plate.error(result));
      const std::vector<double> irradiance = CausticPlate::irradiance(result);
      double found = 0.0, truth = 0.0;
      for (size_t i = 0; i < irradiance.size(); ++i) found += irradiance[i], truth += plate.truth()[i];
      // The ring of half a step around a disc of `photons` steps squared.
      const double error = std::abs(found / truth - 1) / std::sqrt(pi / static_cast<double>(photons));
      if (!(error <= flux.error)) flux_where = line.name + printed(", %llu photons: %.6g of the flux", static_cast<unsigned long long>(photons), found / truth);
      flux.add(error, flux.cases);
    }
    ++order.cases;
    const double fitted = fitted_exponent(line.points), exponent = std::isnan(fitted) ? INFINITY : fitted;
    if (exponent > order.worst) {
      order.worst = exponent;
      order.worst_input = line.name;
    }
    plot.lines.push_back(line);
  }
  order.plots.push_back(plot);
  rows.push_back({"density/patches: flux", flux.cases, flux.error, 1.0, "of the border",
                  "quadrature; half a step at the lattice's border is left out", flux_where});
  rows.push_back(order);
  for (CheckResult& row : rows)
    row.kernel = "stages/photons.cl: photons, stages/patches.cl: project_patches, stages/patch_drawing.cl: draw_patches";
  return rows;
}

}  // namespace vitrum
