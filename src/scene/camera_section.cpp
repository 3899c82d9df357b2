// [camera], [film] and [background].

#include "scene/sections.hpp"

namespace vitrum {

Camera read_camera(const TomlTable& table, const FileContext& context) {
  table.check_keys({"eye", "look_at"}, {"type", "up", "vertical_fov"});
  Camera camera;
  table.choice("type", camera.type, {{"pinhole", CameraType::pinhole}});
  table.vector("eye", camera.eye, coordinate);
  table.vector("look_at", camera.look_at, coordinate);
  table.direction("up", camera.up);
  table.number("vertical_fov", camera.vertical_fov, {0.001, 179});

  const glm::dvec3 view = camera.look_at - camera.eye;
  const double distance = glm::length(view);
  if (!(distance > 1e-9 * (1.0 + glm::length(camera.eye))))
    table.fail("look_at", "is where the eye is", "let the camera look at another point");
  if (!(glm::length(glm::cross(view / distance, camera.up)) > 1e-6))
    table.fail("up", "is parallel to the view, so the picture has no upright", "give an up across the view");
  camera.eye *= context.metres_per_unit;
  camera.look_at *= context.metres_per_unit;
  return camera;
}

FilmSettings read_film(const TomlTable& table) {
  table.check_keys({}, {"size", "filter", "display", "gamma", "exposure"});
  constexpr int longest_side = 65536;
  constexpr double most_pixels = 1 << 28;
  FilmSettings film;
  table.integers("size", {&film.width, &film.height}, 1, longest_side);
  if (double{1} * film.width * film.height > most_pixels)
    table.fail("size", "asks for more than 2^28 pixels", "give a smaller size");
  table.choice("filter", film.filter, {{"box", FilmFilter::box}});
  table.choice("display", film.display, {{"srgb", DisplayTransform::srgb}, {"gamma", DisplayTransform::gamma}});
  table.number("gamma", film.gamma, {0.1, 10});
  table.number("exposure", film.exposure, {-100, 100});
  return film;
}

Spectrum read_background(const TomlTable& table) {
  table.check_keys({}, {"radiance"});
  Spectrum radiance(0.0);
  table.colour("radiance", radiance, radiometric);
  return radiance;
}

}  // namespace vitrum
