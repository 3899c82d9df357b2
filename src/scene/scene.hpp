#pragma once
// What is to be rendered: a plain description, in metres, with units stated at every value and nothing of OpenCL.
//
// A Scene is made by load_scene (scene_file.hpp) and load_textures (textures.hpp), read by everything after them, and
// never changed again.
// Everything here is in world space: transforms are applied when a shape is loaded.

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/error.hpp"

namespace vitrum {

/// A quantity per wavelength: three channels today (red, green, blue), through this one type.
using Spectrum = glm::dvec3;

inline constexpr uint32_t none = std::numeric_limits<uint32_t>::max();

/// Version of the scene file's format, the key `vitrum` at its top.
inline constexpr int schema_version = 1;

// ---------------------------------------------------------------------------------------------- textures

enum class ColourSpace { linear, srgb };
enum class TextureFilter { nearest, bilinear };

/// A picture on a surface. A texel is looked up at (u, v) = scale * (u0, v0) + offset, v upwards from the bottom row.
struct Texture {
  std::string path;                         ///< the picture's file
  SourceLocation where;                     ///< who asked for it
  ColourSpace colour_space = ColourSpace::srgb;
  TextureFilter filter = TextureFilter::bilinear;
  bool clamp = false;                       ///< false: repeats
  glm::dvec2 offset{0.0};
  glm::dvec2 scale{1.0};
  // These come by load_textures.
  int width = 0, height = 0;                ///< texels
  std::vector<glm::vec3> texels;            ///< linear reflectance, row 0 at the top, width * height of them
};

// ---------------------------------------------------------------------------------------------- materials

/// What a surface does to light that meets it; a material's other terms are added to it.
enum class Surface {
  unlit,       ///< shows diffuse + emission whatever the light (illum 0)
  opaque,      ///< Lambertian, with a Phong highlight where `specular` is not 0; ends caustic paths
  mirror,      ///< reflects all light
  dielectric,  ///< reflects R and refracts 1 - R; the border of a medium
};

/// The index of refraction against vacuum, a function of the channel. Constant today: dispersion goes here.
struct IndexOfRefraction {
  double value = 1.0;
  double at(int /*channel*/) const { return value; }
};

/// What a material means to the renderer, whatever it was said in (scene/materials.hpp makes it from MTL).
struct Material {
  std::string name;
  std::string shader;                       ///< the worksheet's name: "lambertian", "glossy volume", ...
  Surface surface = Surface::opaque;
  Spectrum emission{0.0};                   ///< radiance that it shows by itself [W/(m2 sr)]
  bool emission_is_light = false;           ///< faces of a mesh with this material are area lights
  Spectrum diffuse{0.0};                    ///< rho_d in [0,1]; on a dielectric it only answers to direct light
  uint32_t diffuse_texture = none;          ///< index into Scene::textures
  bool texture_replaces_diffuse = true;     ///< true: rho_d = texel; false: rho_d = texel * diffuse
  Spectrum specular{0.0};                   ///< Phong rho_s
  double shininess = 0.0;                   ///< Phong exponent s
  IndexOfRefraction index;                  ///< dielectric only
  Spectrum absorption{0.0};                 ///< sigma_a of the medium inside [1/m]; +infinity is opaque
  int priority = 0;                         ///< where media overlap, the highest one fills the place
  std::vector<std::string> provenance;      ///< one line per property for `vitrum info`: value, keyword, file:line
};

// ---------------------------------------------------------------------------------------------- shapes

/// Exact sphere. The outside is outside.
struct Sphere {
  glm::dvec3 centre{0.0};                   ///< [m]
  double radius = 1.0;                      ///< [m], > 0
};

/// Exact infinite plane through `point`; a dielectric's inside is behind the normal.
/// Texture coordinates u0 = dot(p - point, texture_u), v0 likewise.
struct Plane {
  glm::dvec3 point{0.0};                    ///< [m]
  glm::dvec3 normal{0, 1, 0};               ///< unit length
  glm::dvec3 texture_u{0.0}, texture_v{0.0};  ///< [1/m]
};

/// One triangle, normal along cross(b - a, c - a).
struct Triangle {
  glm::dvec3 a{0.0}, b{0.0}, c{0.0};        ///< [m]
  glm::dvec2 uv_a{0.0}, uv_b{1, 0}, uv_c{0, 1};
};

/// Triangles with their own material each. The front of a face is where its corners run counter-clockwise.
struct Mesh {
  std::vector<glm::vec3> positions;         ///< [m]
  std::vector<glm::vec3> normals;           ///< unit length; empty if none are used
  std::vector<glm::vec2> texcoords;         ///< empty if none are used
  std::vector<glm::uvec3> triangles;        ///< indices into positions
  std::vector<glm::uvec3> normal_indices;   ///< per triangle, or empty; `none` in .x: flat
  std::vector<glm::uvec3> texcoord_indices; ///< per triangle, or empty; `none` in .x: no coordinates
  std::vector<uint32_t> materials;          ///< per triangle, index into Scene::materials
};

struct Shape {
  std::string name;
  SourceLocation where;
  uint32_t material = none;                 ///< index into Scene::materials; `none` for a mesh, whose faces know
  std::variant<Sphere, Plane, Triangle, Mesh> geometry;
};

// ---------------------------------------------------------------------------------------------- lights

struct PointLight {
  glm::dvec3 position{0.0};                 ///< [m]
  Spectrum intensity{0.0};                  ///< [W/sr]
};
struct DirectionalLight {
  glm::dvec3 direction{0, -1, 0};           ///< the way the light travels, unit length
  Spectrum irradiance{0.0};                 ///< on a surface across it [W/m2]
};
/// Parallelogram corner + s edge_u + t edge_v; shines to the side of cross(edge_u, edge_v).
struct QuadLight {
  glm::dvec3 corner{0.0}, edge_u{1, 0, 0}, edge_v{0, 0, 1};  ///< [m]
  Spectrum radiance{0.0};                   ///< [W/(m2 sr)]
};
/// Shines to the side of its normal.
struct DiscLight {
  glm::dvec3 centre{0.0}, normal{0, -1, 0};
  double radius = 1.0;                      ///< [m]
  Spectrum radiance{0.0};                   ///< [W/(m2 sr)]
};
/// Shines outwards.
struct SphereLight {
  glm::dvec3 centre{0.0};
  double radius = 1.0;                      ///< [m]
  Spectrum radiance{0.0};                   ///< [W/(m2 sr)]
};
/// The faces of shape `shape` whose material has `emission_is_light`; each shines to its front.
struct MeshLight {
  uint32_t shape = none;
};

struct Light {
  std::string name;
  SourceLocation where;
  std::variant<PointLight, DirectionalLight, QuadLight, DiscLight, SphereLight, MeshLight> emitter;
};
/// Kind, place and emission in a line, for `vitrum info`.
std::string light_text(const Light& light);

// ---------------------------------------------------------------------------------------------- camera, film

enum class CameraType { pinhole };

struct Camera {
  CameraType type = CameraType::pinhole;
  glm::dvec3 eye{0, 0, 1}, look_at{0.0}, up{0, 1, 0};  ///< [m]
  double vertical_fov = 45.0;               ///< full angle over the picture's height [degrees]
};

enum class FilmFilter { box };
enum class DisplayTransform { gamma, srgb };

struct FilmSettings {
  int width = 512, height = 512;            ///< pixels
  FilmFilter filter = FilmFilter::box;
  DisplayTransform display = DisplayTransform::srgb;
  double gamma = 1.8;                       ///< for DisplayTransform::gamma
  double exposure = 0.0;                    ///< stops, before the transform
};

// ---------------------------------------------------------------------------------------------- settings

enum class Sampling { independent, low_discrepancy };
enum class PhotonEstimate { automatic, automatic_radius, fixed_radius, nearest, footprints };

struct RenderSettings {
  int samples = 16;                         ///< per pixel; 1 is the pixel's centre
  uint64_t seed = 0;
  int passes = 1;                           ///< each with its share of samples and photons
  std::optional<double> constant_reflectance;  ///< R at every angle; none: Fresnel
  bool caustics = true;                     ///< photon pass and gather
  bool lights = true;                       ///< direct light and highlights
  bool textures = true;
  int max_depth = 20;                       ///< surfaces that a camera path may meet
  double min_weight = 1e-4;                 ///< a branch of less than this weight is cut
  Sampling sampling = Sampling::low_discrepancy;
  bool adaptive = false;                    ///< samples are dealt out to pixels by their variance; `samples` is their mean
  double target_error = 0.0;                ///< relative error of the picture at which to stop; 0: none
  double time_limit = 0.0;                  ///< [s] after which to stop; 0: none. With either, samples, passes and photons.count
                                            ///< are chosen on the way

  /// Whether passes go on until an error or a time is met.
  bool by_rounds() const { return target_error > 0.0 || time_limit > 0.0; }
};

/// The most photons that PhotonEstimate::nearest can search for.
inline constexpr int most_nearest_photons = 64;

struct PhotonSettings {
  uint64_t count = 1'000'000;               ///< emitted towards casters, all passes together
  Sampling sampling = Sampling::low_discrepancy;
  PhotonEstimate estimate = PhotonEstimate::automatic;
  double radius = 0.01;                     ///< for fixed_radius [m]
  int nearest = 50;                         ///< k for nearest, at most most_nearest_photons; photons aimed at per estimate for
                                            ///< automatic radii; for footprints, within a cell of their map
  double max_radius = 1.0;                  ///< for nearest [m]
  bool progressive = false;                 ///< the radius shrinks from pass to pass; for automatic and fixed radii
  int max_depth = 20;                       ///< surfaces that a photon may meet
};

// ---------------------------------------------------------------------------------------------- scene

struct Scene {
  std::string file;                         ///< scene file it was read from
  double metres_per_unit = 1.0;             ///< of the file; everything here is in metres already
  Camera camera;
  FilmSettings film;
  Spectrum background{0.0};                 ///< radiance of directions that meet nothing [W/(m2 sr)]
  std::vector<Light> lights;                ///< by name
  std::vector<Shape> shapes;                ///< by name
  std::vector<Material> materials;
  std::vector<Texture> textures;
  RenderSettings render;
  PhotonSettings photons;
};

}  // namespace vitrum
