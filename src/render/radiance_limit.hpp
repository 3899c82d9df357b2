#pragma once
// How much radiance the paths that were cut may have missed.

#include "film/film.hpp"
#include "scene/scene.hpp"

namespace vitrum {

/// What is missing in a pixel is at most, channel by channel, the weight that was cut there times `radiance`.
struct RadianceLimit {
  Spectrum radiance{0.0};       ///< as the eye sees it [W/(m2 sr)]
  /// No path can bring more. Else `radiance` is the greatest that is emitted or that a pixel shows: an estimate.
  bool is_bound = true;
};

/// The limit for a scene seen from a medium of index `eye_index` in `film`, whose plane "radiance" has what was rendered.
///
/// Radiance over the square of the index does not grow along a ray, whatever the ray meets of clear or absorbing glass and
/// of mirrors (Nicodemus 1963). Where all light has a radiance, that of the background, of area lights and of emitting
/// surfaces, its greatest value L bounds what such rays bring: an opaque surface gives its own emission and of L the share
/// rho_d + rho_s (s + 2) / (s + 1), since the irradiance is at most pi L, and Phong's term integrates to less than that.
/// Point and directional lights have no radiance, and glass with an emission, a diffuse or a specular term of its own adds
/// at each encounter; then there is no bound.
RadianceLimit radiance_limit(const Scene& scene, double eye_index, const Film& film);

/// Radiance cut in each pixel, interleaved, 3 channels: the mean of the film's plane "cut" times the limit.
std::vector<double> cut_radiance(const Film& film, const RadianceLimit& limit);

}  // namespace vitrum
