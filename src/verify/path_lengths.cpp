#include "verify/path_lengths.hpp"

#include <algorithm>
#include <cmath>

#include "verify/truth_pictures.hpp"

namespace vitrum {
namespace {

using glm::dvec3;

/// Bodies that are small beside their coordinates: an offset of rays that goes by those would show. Lengths in metres
/// for a scene of size 1; all have index 1, so that light goes straight on and nothing is reflected.
constexpr double thickness = 1e-3, radius = 1e-3;  // of each of two plates, of the ball
const dvec3 ball_centre(0.3, 0.2, -0.1);
// Of absorption along a plate's thickness or the ball's radius, by channel. Grazing rays have a longer way.
const dvec3 depth(0.5, 1.0, 2.0);
constexpr double grazing_share = 0.02;

/// The plates lie under y = 0, the ball above them.
Scene bodies(double size, const dvec3& eye, const dvec3& look_at, double vertical_fov, int pixels, double share) {
  Scene scene = truth_picture(size * eye, size * look_at, vertical_fov, pixels);
  scene.camera.up = {0, 0, 1};
  for (int k = 0; k < 3; ++k) {
    scene.materials.push_back(glass(1.0));
    scene.materials.back().absorption = share * depth / (size * thickness) * (k == 1 ? 0.5 : 1.0);
  }
  add(scene, box(size * dvec3(-10, -thickness, -10), size * dvec3(10, 0, 10), 0));
  add(scene, box(size * dvec3(-10, -2 * thickness, -10), size * dvec3(10, -thickness, 10), 1));
  add(scene, Sphere{size * ball_centre, size * radius}, 2);
  return scene;
}

}  // namespace

CheckResult check_path_lengths(const CheckContext& context) {
  // As kernels/surface.h says of places on surfaces, of the largest coordinate.
  constexpr double rounding = 1.4e-6;
  const int pixels = context.full ? 256 : 32;
  Worst worst;
  std::string where;
  const auto found_error = [&](double error, double size, const char* what, size_t pixel) {
    if (!(error <= worst.error)) where = what + printed(" in a scene of %g m, pixel %zu", size, pixel);
    worst.add(error, worst.cases);
  };
  for (const double size : {1e-3, 1.0, 1e3}) {
    // From above, and at cosines of .03 to .1, where borders in contact are far apart along the ray.
    for (const bool grazing : {false, true}) {
      const double share = grazing ? grazing_share : 1.0;
      const Scene plates = grazing ? bodies(size, {0.5, 0.033, 0.1}, {0, 0, 0.2}, 4, pixels, share)
                                   : bodies(size, {0.2, 0.7, 0.1}, {-0.3, 0, 0.2}, 40, pixels, share);
      const Rendered seen(context, plates);
      for (size_t i = 0; i < seen.cut.size(); ++i) {
        const double cosine = -direction_of(plates, i).y;
        for (int c = 0; c < 3; ++c) {
          // Half as much in the second plate.
          const double depth_found = -std::log(seen.radiance[3 * i + static_cast<size_t>(c)]);
          const double thick = depth_found / (1.5 * share * depth[c]) * thickness * cosine;
          found_error(std::abs(thick - thickness), size, grazing ? "plates, grazing" : "plates", i);
        }
      }
    }
    const Scene ball = bodies(size, ball_centre + dvec3(0.002, 0.003, 0.001), ball_centre, 40, pixels, 1.0);
    const Rendered through(context, ball);
    for (size_t i = 0; i < through.cut.size(); ++i) {
      const dvec3 direction = direction_of(ball, i), to_centre = ball_centre - ball.camera.eye / size;
      const double across = glm::length(glm::cross(to_centre, direction));
      if (across > 0.999 * radius) continue;  // there the ray may miss it
      const double cosine = std::max(-direction.y, 1e-3);
      for (int c = 0; c < 3; ++c) {
        // The plates lie behind it.
        const double behind = 1.5 * depth[c] / cosine;
        const double half = 0.5 * (-std::log(through.radiance[3 * i + static_cast<size_t>(c)]) - behind) / depth[c] * thickness;
        // A ray that misses its place by e misses the length by as much in the middle, and by far more at the rim, where
        // the place that it tells is the better measure.
        const double place = leg(radius, std::min(half, radius));
        found_error(std::min(std::abs(half - leg(radius, across)), std::abs(place - across)), size, "ball", i);
      }
    }
  }
  return {"geometry/path lengths", worst.cases, worst.error, rounding, "of the scene", "exp(-sigma_a s) along straight lines: s",
          where, {}, {}, "stages/camera.cl: camera"};
}

}  // namespace vitrum
