#pragma once
// Pictures whose radiance is known pixel by pixel: how they are made, and held against it.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "film/false_colour.hpp"
#include "render/render.hpp"
#include "verify/check.hpp"
#include "verify/closed_forms.hpp"
#include "verify/scenes.hpp"

namespace vitrum {

/// A picture of size x size pixels without lights; each sample the pixel's centre. Deep enough for a bound of 1e-5
/// where media absorb.
inline Scene truth_picture(const glm::dvec3& eye, const glm::dvec3& look_at, double vertical_fov, int size) {
  Scene scene;
  scene.camera = {CameraType::pinhole, eye, look_at, {0, 1, 0}, vertical_fov};
  scene.film.width = scene.film.height = size;
  scene.background = Spectrum(1.0);
  scene.render.samples = 1;
  scene.render.caustics = scene.render.lights = false;
  scene.render.max_depth = 31;
  scene.render.min_weight = 1e-8;
  return scene;
}

/// Unit direction of the ray through the centre of pixel `i`, as src/device/scene_data.cpp has the camera.
inline glm::dvec3 direction_of(const Scene& scene, size_t i) {
  const Camera& camera = scene.camera;
  const glm::dvec3 forward = glm::normalize(camera.look_at - camera.eye);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, camera.up)), up = glm::cross(right, forward);
  const double half = std::tan(0.5 * camera.vertical_fov * std::numbers::pi / 180), size = scene.film.height;
  const double x = static_cast<double>(i % static_cast<size_t>(scene.film.width)) + 0.5;
  const double y = static_cast<double>(i / static_cast<size_t>(scene.film.width)) + 0.5;
  return glm::normalize(forward + half * (2 * x / size - 1) * right + half * (1 - 2 * y / size) * up);
}

/// Looks down at what will lie in air between light from above and from below, channel by channel: from above alone,
/// from below alone, from both sides. It has one material, the ground's. The middle column of pixels (`size` is made
/// odd) lies over the diagonals of the layers' faces, where a ray meets two triangles of each.
inline Scene lit_from_both_sides(int size) {
  Scene scene = truth_picture({0, 2, 0}, {1, 0, 1}, 60, size | 1);
  scene.background = {1, 0, 1};
  scene.materials.push_back(surface(Surface::opaque));
  scene.materials[0].emission = {0, 1, 1};
  add(scene, Plane{{0, -5, 0}, {0, 1, 0}, {}, {}}, 0);
  return scene;
}

/// A layer, far wider than the picture sees.
inline Mesh layer(double top, double bottom, uint32_t medium) { return box({-40, bottom, -40}, {40, top, 40}, medium); }

/// A picture as it was rendered: red, green and blue of each pixel, and what the limits cut away there.
struct Rendered {
  int width = 0, height = 0;
  std::vector<double> radiance, cut;

  Rendered(const CheckContext& context, const Scene& scene) : width(scene.film.width), height(scene.film.height) {
    RenderOptions options;
    options.kernels = context.kernels;
    const RenderResult result = render(scene, context.device, options);
    radiance = result.film.mean("radiance");
    cut = result.film.mean("cut");
  }

  /// For the reports: itself, and beside it `errors`, one of each pixel, in colours up to `scale`.
  std::vector<CheckPicture> pictures(const std::string& what, const std::vector<float>& errors, double scale) const {
    Picture picture{width, height, {}};
    for (size_t i = 0; i < errors.size(); ++i)
      picture.pixels.emplace_back(radiance[3 * i], radiance[3 * i + 1], radiance[3 * i + 2]);
    return {{what, std::move(picture)},
            {what + printed(": error, in the worst channel; white: %.2g and more", scale),
             false_colour_picture(errors, width, height, scale)}};
  }
};

/// A row of pictures each pixel of which is to be within 1e-5 of its truth.
class PictureRow {
 public:
  /// Renders the scene and holds pixels against `truth(direction)`, a Range. What the limits cut away, times the
  /// radiance of the surround (1) and the square of the eye's index, may be missing.
  template <typename Truth>
  void add(const CheckContext& context, const Scene& scene, const Truth& truth, const std::string& what) {
    const Rendered rendered(context, scene);
    Worst worst;
    std::vector<float> errors(rendered.cut.size(), 0.0f);
    for (size_t i = 0; i < errors.size(); ++i) {
      const Range range = truth(direction_of(scene, i));
      for (int c = 0; c < 3; ++c) {
        const size_t value = 3 * i + static_cast<size_t>(c);
        const double found = rendered.radiance[value];
        const double error = std::max({found - range.high[c], range.low[c] - (found + rendered.cut[i]), 0.0});
        worst.add(std::isfinite(found) ? error : NAN, value);
        errors[i] = std::max(errors[i], static_cast<float>(error));
      }
    }
    if (worst.error > worst_.error) {
      const size_t pixel = worst.at / 3, width = static_cast<size_t>(rendered.width);
      where_ = what + printed(": pixel (%zu, %zu) of %zu, channel %zu", pixel % width, pixel / width, width,
                              static_cast<size_t>(worst.at % 3));
      // Where nothing is off, or much, the bound is the scale.
      pictures_ = rendered.pictures(what, errors, std::min(false_colour_scale(errors), bound));
    }
    worst_.merge(worst);
  }

  CheckResult result(const char* name, const char* truth) const {
    return {name, worst_.cases, worst_.error, bound, "radiance", truth, where_, {}, pictures_};
  }

 private:
  static constexpr double bound = 1e-5;
  Worst worst_;
  std::string where_;
  std::vector<CheckPicture> pictures_;
};

}  // namespace vitrum
