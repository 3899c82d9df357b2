#include "scene/materials.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <set>
#include <string_view>

#include "core/log.hpp"

namespace vitrum {
namespace {

/// What each shader takes from the keywords.
struct Shader {
  const char* name;
  Surface surface;
  bool has_diffuse;   ///< Kd and map_Kd answer to light
  bool has_specular;  ///< Ks and Ns make a highlight
  bool kd_absorbs;    ///< Kd is the medium's rho_d
};

constexpr Shader reflectance{"reflectance", Surface::unlit, true, false, false};
constexpr Shader lambertian{"lambertian", Surface::opaque, true, false, false};
constexpr Shader phong{"phong", Surface::opaque, true, true, false};
constexpr Shader glossy{"glossy", Surface::dielectric, true, true, false};
constexpr Shader mirror{"mirror", Surface::mirror, false, false, false};
constexpr Shader transparent{"transparent", Surface::dielectric, false, false, false};
constexpr Shader volume{"volume", Surface::dielectric, false, false, true};
constexpr Shader glossy_volume{"glossy volume", Surface::dielectric, false, true, true};
constexpr std::array shaders{reflectance, lambertian, phong, glossy, mirror, transparent, volume, glossy_volume};

constexpr double default_diffuse = 0.8;     // of opaque surfaces; the implicit material of the worksheet's framework
constexpr double default_index = 1.5;       // crown glass
constexpr double default_shininess = 10;    // where Ks is given without Ns
constexpr double min_index = 0.001, max_index = 10;  // the range of Ni in the MTL format

std::string text_of(double value, const char* format = "%.6g") {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}
std::string text_of(const Spectrum& value, const char* format = "%.6g") {
  return text_of(value.r, format) + ' ' + text_of(value.g, format) + ' ' + text_of(value.b, format);
}

/// "file:line" without folders; the place of a --set is no path and stays whole.
std::string short_place(SourceLocation where) {
  if (where.line > 0) where.file = std::filesystem::path(where.file).filename().string();
  where.column = 0;
  return to_string(where);
}

const char* name_of(ColourSpace space) { return space == ColourSpace::linear ? "linear" : "srgb"; }
const char* name_of(TextureFilter filter) { return filter == TextureFilter::nearest ? "nearest" : "bilinear"; }

bool any_positive(const Spectrum& value) { return value.r > 0 || value.g > 0 || value.b > 0; }
bool all_within(const Spectrum& value, double low, double high) {
  // Written so that NaN is within nothing.
  return value.r >= low && value.g >= low && value.b >= low && value.r <= high && value.g <= high && value.b <= high;
}
constexpr double infinity = std::numeric_limits<double>::infinity();

class Interpreter {
 public:
  Interpreter(const MtlMaterial& said, MtlReading reading) : said_(said), reading_(reading) {}

  InterpretedMaterial run() {
    material_.name = said_.name;
    shader_ = chosen_shader();
    material_.shader = shader_.name;
    material_.surface = shader_.surface;
    take_diffuse();
    take_texture();
    take_specular();
    take_emission();
    take_index();
    take_absorption();
    take_priority();
    list_unused();
    return std::move(result_);
  }

 private:
  bool is_worksheet() const { return reading_ == MtlReading::worksheet; }
  bool is_dielectric() const { return shader_.surface == Surface::dielectric; }

  /// Books `keyword` as used and reports what it became.
  void took(const std::string& text, const char* keyword, const SourceLocation& where, const char* how = "") {
    used_.insert(keyword);
    material_.provenance.push_back(text + " (" + keyword + how + ", " + short_place(where) + ")");
  }
  void took_default(const std::string& text) { material_.provenance.push_back(text + " (default)"); }

  [[noreturn]] void refuse(const SourceLocation& where, const std::string& problem, const std::string& mend) const {
    throw Error(where, "material '" + said_.name + "': " + problem, mend);
  }
  void caution(const SourceLocation& where, const std::string& text) const {
    warn(where, "material '" + said_.name + "': " + text);
  }

  Shader chosen_shader();
  Shader shader_without_illum() const;
  Shader shader_of_illum(const Said<int>& illum) const;
  Spectrum reflectance_of(const Said<Spectrum>& colour, const char* keyword) const;
  void take_diffuse();
  void take_texture();
  void take_specular();
  void take_emission();
  void take_index();
  void take_absorption();
  void take_priority();
  void list_unused();
  void list_unused(const char* keyword, const std::string& value, const SourceLocation& where);

  const MtlMaterial& said_;
  MtlReading reading_;
  Shader shader_ = lambertian;
  InterpretedMaterial result_;
  Material& material_ = result_.material;
  std::set<std::string_view> used_;
};

/// The format has no default. An index is said of glass only, and a highlight wants a shader that shows it.
Shader Interpreter::shader_without_illum() const {
  if (is_worksheet() && said_.Ni) return glossy;
  return said_.Ks && any_positive(said_.Ks->value) ? phong : lambertian;
}

/// The nearest meaning of each illumination model; a warning where it isn't the same.
Shader Interpreter::shader_of_illum(const Said<int>& illum) const {
  const std::string number = "illum " + std::to_string(illum.value);
  switch (illum.value) {
    case 0: return reflectance;
    case 1: return lambertian;
    case 2: return is_worksheet() ? glossy : phong;
    case 3: return mirror;
    case 8: return mirror;       // as 3, "ray tracing off"
    case 4: return transparent;
    case 7: return transparent;  // refraction with Fresnel reflection: what every glass here does
    case 9: return transparent;  // as 4, "ray tracing off"
    case 5:
      caution(illum.where, number + " (a mirror by Fresnel) is read as 3: a mirror that reflects all");
      return mirror;
    case 6:
      caution(illum.where, number + " (refraction without Fresnel) is read as 4: glass that reflects by Fresnel");
      return transparent;
    case 10:
      caution(illum.where, number + " (a catcher of shadows) is read as 1: Lambertian");
      return lambertian;
    case 11: return volume;
    case 12: return glossy_volume;
    default: break;
  }
  if (illum.value < 0) refuse(illum.where, "illum is negative", "write a number from 0 to 12");
  const Shader nearest = shader_without_illum();
  caution(illum.where, number + " has no meaning; read as if it were missing: " + nearest.name);
  return nearest;
}

Shader Interpreter::chosen_shader() {
  if (said_.shader) {
    const Said<std::string>& name = *said_.shader;
    const auto found = std::find_if(shaders.begin(), shaders.end(),
                                    [&](const Shader& candidate) { return name.value == candidate.name; });
    if (found == shaders.end()) {
      std::string names;
      for (const Shader& s : shaders) names += (names.empty() ? "" : ", ") + std::string(s.name);
      refuse(name.where, "there is no shader '" + name.value + "'", "write one of: " + names);
    }
    took("shader " + name.value, "shader", name.where);
    return *found;
  }
  const Shader shader = said_.illum ? shader_of_illum(*said_.illum) : shader_without_illum();
  // Blender writes glass as an opaque material with a transmission weight in Tf, and only among its PBR keywords;
  // Tf by itself is found in many opaque files.
  const bool has_pbr = said_.Pr || said_.Pm;
  if (!is_worksheet() && shader.surface == Surface::opaque && has_pbr && said_.Tf && any_positive(said_.Tf->value)) {
    used_.insert(said_.Pr ? "Pr" : "Pm");
    took("shader transparent", "Tf", said_.Tf->where, said_.Pr ? " beside Pr" : " beside Pm");
    return transparent;
  }
  if (said_.illum) {
    std::string number = ' ' + std::to_string(said_.illum->value);
    // The one number with two meanings.
    if (said_.illum->value == 2) number += is_worksheet() ? " by mtl = worksheet" : " by mtl = common";
    took(std::string("shader ") + shader.name, "illum", said_.illum->where, number.c_str());
  } else {
    material_.provenance.push_back(std::string("shader ") + shader.name + " (default: no illum)");
  }
  return shader;
}

Spectrum Interpreter::reflectance_of(const Said<Spectrum>& colour, const char* keyword) const {
  if (!all_within(colour.value, 0, std::numeric_limits<double>::max())) {
    refuse(colour.where, std::string(keyword) + " " + text_of(colour.value) + " is negative or not finite",
           "write numbers from 0 to 1");
  }
  if (!all_within(colour.value, 0, 1)) {
    caution(colour.where, std::string(keyword) + " is above 1: the surface gives more light than it gets");
  }
  return colour.value;
}

void Interpreter::take_diffuse() {
  if (!shader_.has_diffuse) return;
  if (said_.Kd) {
    material_.diffuse = reflectance_of(*said_.Kd, "Kd");
    took("diffuse " + text_of(material_.diffuse), "Kd", said_.Kd->where);
    return;
  }
  // Glass is clear unless told otherwise, and a texture shows as it is.
  material_.diffuse = Spectrum(is_dielectric() ? 0.0 : said_.map_Kd ? 1.0 : default_diffuse);
  took_default("diffuse " + text_of(material_.diffuse));
}

void Interpreter::take_texture() {
  if (!said_.map_Kd) return;
  const Said<TextureReference>& map = *said_.map_Kd;
  if (!shader_.has_diffuse) {
    caution(map.where, std::string("map_Kd has no effect on the shader ") + shader_.name);
    return;
  }
  Texture texture;
  texture.path = map.value.path;
  texture.where = map.where;
  texture.clamp = map.value.clamp;
  texture.offset = map.value.offset;
  texture.scale = map.value.scale;
  texture.colour_space = is_worksheet() ? ColourSpace::linear : ColourSpace::srgb;
  material_.texture_replaces_diffuse = is_worksheet();
  took(std::string("texture ") + texture.path + (is_worksheet() ? " in place of" : " times") + " diffuse", "map_Kd",
       map.where);
  if (said_.texture_colour_space) {
    texture.colour_space = said_.texture_colour_space->value;
    took(std::string("texture's colour space ") + name_of(texture.colour_space), "texture_colour_space",
         said_.texture_colour_space->where);
  } else {
    took_default(std::string("texture's colour space ") + name_of(texture.colour_space));
  }
  if (said_.texture_filter) {
    texture.filter = said_.texture_filter->value;
    took(std::string("texture's filter ") + name_of(texture.filter), "texture_filter", said_.texture_filter->where);
  } else {
    took_default(std::string("texture's filter ") + name_of(texture.filter));
  }
  result_.texture = std::move(texture);
}

void Interpreter::take_specular() {
  if (!shader_.has_specular) return;
  if (said_.Ks) {
    material_.specular = reflectance_of(*said_.Ks, "Ks");
    took("specular " + text_of(material_.specular), "Ks", said_.Ks->where);
  }
  if (said_.Ns) {
    if (!(said_.Ns->value >= 0) || said_.Ns->value == infinity) {
      refuse(said_.Ns->where, "Ns " + text_of(said_.Ns->value) + " is negative or not finite",
             "write an exponent from 0 to 1000");
    }
    material_.shininess = said_.Ns->value;
    took("shininess " + text_of(material_.shininess), "Ns", said_.Ns->where);
  } else if (any_positive(material_.specular)) {
    material_.shininess = default_shininess;
    took_default("shininess " + text_of(material_.shininess));
  }
}

/// The worksheet's shaders add Ka on diffuse surfaces only.
void Interpreter::take_emission() {
  const std::optional<Said<Spectrum>>& said = is_worksheet() ? said_.Ka : said_.Ke;
  if (is_worksheet() && said_.Ke && any_positive(said_.Ke->value)) {
    caution(said_.Ke->where, "Ke has no effect in the worksheet's reading, where Ka is the emission");
  }
  const bool adds_Ka = shader_.surface == Surface::unlit || shader_.surface == Surface::opaque;
  if (!said || (is_worksheet() && !adds_Ka)) return;
  if (!all_within(said->value, 0, std::numeric_limits<double>::max())) {
    refuse(said->where, "the emission " + text_of(said->value) + " is negative or not finite",
           "write numbers from 0 on");
  }
  material_.emission = said->value;
  material_.emission_is_light = any_positive(said->value);
  took("emission " + text_of(material_.emission) + " W/(m2 sr)", is_worksheet() ? "Ka" : "Ke", said->where);
}

void Interpreter::take_index() {
  if (!is_dielectric()) {
    if (said_.Ni && !(said_.Ni->value >= min_index && said_.Ni->value <= max_index)) {
      caution(said_.Ni->where, "Ni " + text_of(said_.Ni->value) + " is ignored: the surface is no glass");
    }
    return;
  }
  if (!said_.Ni) {
    material_.index.value = default_index;
    return took_default("index " + text_of(default_index));
  }
  const double index = said_.Ni->value;
  if (!(index >= min_index && index <= max_index)) {
    refuse(said_.Ni->where, "Ni " + text_of(index) + " is no index of refraction",
           "write one from 0.001 to 10, such as 1.5 for glass or 1.33 for water");
  }
  material_.index.value = index;
  took("index " + text_of(index), "Ni", said_.Ni->where);
}

void Interpreter::take_absorption() {
  const auto &absorption = said_.absorption, &colour = said_.absorption_colour;
  const auto& distance = said_.absorption_distance;
  if (!is_dielectric()) {
    if (absorption || colour) {
      caution((absorption ? absorption : colour)->where, "absorption has no effect on the shader " +
                                                             std::string(shader_.name));
    }
    return;
  }
  if (absorption && colour) refuse(colour->where, "absorption is given twice", "keep absorption or absorption_colour");
  if (colour && !distance) {
    refuse(colour->where, "absorption_colour is given without absorption_distance",
           "add the distance over which the light takes that colour");
  }
  if (distance && !colour) {
    refuse(distance->where, "absorption_distance is given without absorption_colour", "add the colour, or remove it");
  }
  const auto report = [&](const char* keyword, const SourceLocation& where, const char* how) {
    const bool is_blocked = !all_within(material_.absorption, 0, std::numeric_limits<double>::max());
    const bool is_black = material_.absorption == Spectrum(infinity);
    took("absorption " + text_of(material_.absorption, "%.3g") + " 1/m" +
             (is_black ? ": opaque, black glass" : is_blocked ? ": opaque in the channels of inf" : ""),
         keyword, where, how);
  };
  if (absorption) {
    if (!all_within(absorption->value, 0, infinity)) {
      refuse(absorption->where, "absorption " + text_of(absorption->value) + " is negative or no number",
             "write numbers from 0 on");
    }
    material_.absorption = absorption->value;
    return report("absorption", absorption->where, "");
  }
  if (colour) {
    if (!all_within(colour->value, 0, 1)) {
      refuse(colour->where, "absorption_colour " + text_of(colour->value) + " is out of range",
             "write numbers from 0 to 1");
    }
    if (!(distance->value > 0) || distance->value == infinity) {
      refuse(distance->where, "absorption_distance " + text_of(distance->value) + " is no distance",
             "write a number above 0");
    }
    // Bouguer: T = exp(-sigma_a d). Adding 0 turns the -0 of a clear channel into 0.
    material_.absorption = -glm::log(colour->value) / distance->value + 0.0;
    used_.insert("absorption_distance");
    return report("absorption_colour", colour->where, " by -ln(T) / distance");
  }
  if (!shader_.kd_absorbs || !said_.Kd) return took_default("absorption 0 0 0 1/m");
  if (!all_within(said_.Kd->value, 0, 1)) {
    refuse(said_.Kd->where, "Kd " + text_of(said_.Kd->value) + " of an absorbing glass is out of range",
           "write numbers from 0 (opaque) to 1 (clear)");
  }
  for (int channel = 0; channel < 3; ++channel) {
    // sigma_a = 1 / rho_d - 1 without cancellation near 1; its limit at 0 is infinite.
    const double rho_d = said_.Kd->value[channel];
    material_.absorption[channel] = rho_d > 0 ? (1 - rho_d) / rho_d : infinity;
  }
  report("Kd", said_.Kd->where, " by 1/rho_d - 1");
}

void Interpreter::take_priority() {
  if (!is_dielectric() || !said_.priority) return;
  material_.priority = said_.priority->value;
  took("priority " + std::to_string(material_.priority), "priority", said_.priority->where);
}

void Interpreter::list_unused(const char* keyword, const std::string& value, const SourceLocation& where) {
  if (used_.contains(keyword)) return;
  material_.provenance.push_back(std::string("unused: ") + keyword + ' ' + value + " (" + short_place(where) + ")");
}

void Interpreter::list_unused() {
  if (!is_dielectric() && said_.d && said_.d->value < 1) {
    caution(said_.d->where, "d " + text_of(said_.d->value) + " (coverage) has no effect: the surface is opaque; "
                            "for glass give it illum 4");
  }
  const auto list = [&](const char* keyword, const auto& property) {
    if (property) list_unused(keyword, text_of(property->value), property->where);
  };
  list("Ka", said_.Ka);
  list("Kd", said_.Kd);
  list("Ks", said_.Ks);
  list("Ke", said_.Ke);
  list("Tf", said_.Tf);
  list("Ns", said_.Ns);
  list("Ni", said_.Ni);
  list("d", said_.d);
  list("illum", said_.illum);
  list("Pr", said_.Pr);
  list("Pm", said_.Pm);
  list("absorption", said_.absorption);
  list("absorption_colour", said_.absorption_colour);
  list("absorption_distance", said_.absorption_distance);
  list("priority", said_.priority);
  if (said_.map_Kd) list_unused("map_Kd", said_.map_Kd->value.path, said_.map_Kd->where);
  if (said_.texture_filter) {
    list_unused("texture_filter", name_of(said_.texture_filter->value), said_.texture_filter->where);
  }
  if (said_.texture_colour_space) {
    list_unused("texture_colour_space", name_of(said_.texture_colour_space->value),
                said_.texture_colour_space->where);
  }
  for (const Said<std::string>& unused : said_.unused) {
    material_.provenance.push_back("unused: " + unused.value + " (" + short_place(unused.where) + ")");
  }
}

}  // namespace

InterpretedMaterial interpret(const MtlMaterial& said, MtlReading reading) { return Interpreter(said, reading).run(); }

}  // namespace vitrum
