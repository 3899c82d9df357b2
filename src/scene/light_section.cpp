// [light.NAME]

#include <algorithm>

#include "core/printed.hpp"
#include "scene/sections.hpp"

namespace vitrum {
namespace {

enum class LightType { point, directional, quad, disc, sphere };

decltype(Light::emitter) read_emitter(const TomlTable& table, double metres_per_unit) {
  const auto type = table.type<LightType>({{"point", LightType::point},
                                           {"directional", LightType::directional},
                                           {"quad", LightType::quad},
                                           {"disc", LightType::disc},
                                           {"sphere", LightType::sphere}});
  const auto point = [&](std::string_view key, glm::dvec3& p) {
    table.vector(key, p, coordinate);
    p *= metres_per_unit;
  };
  switch (type) {
    case LightType::point: {
      table.check_keys({"type", "position", "intensity"}, {});
      PointLight light;
      point("position", light.position);
      table.colour("intensity", light.intensity, radiometric);
      return light;
    }
    case LightType::directional: {
      table.check_keys({"type", "direction", "irradiance"}, {});
      DirectionalLight light;
      table.direction("direction", light.direction);
      table.colour("irradiance", light.irradiance, radiometric);
      return light;
    }
    case LightType::quad: {
      table.check_keys({"type", "corner", "edge_u", "edge_v", "radiance"}, {});
      QuadLight light;
      point("corner", light.corner);
      point("edge_u", light.edge_u);
      point("edge_v", light.edge_v);
      table.colour("radiance", light.radiance, radiometric);
      const double longest = std::max(glm::length(light.edge_u), glm::length(light.edge_v));
      if (!(glm::length(glm::cross(light.edge_u, light.edge_v)) > 1e-9 * longest * longest))
        table.fail("edge_v", "and edge_u enclose no area", "give two edges that are not parallel");
      return light;
    }
    case LightType::disc: {
      table.check_keys({"type", "centre", "normal", "radius", "radiance"}, {});
      DiscLight light;
      point("centre", light.centre);
      table.direction("normal", light.normal);
      table.length("radius", light.radius, positive_length, metres_per_unit);
      table.colour("radiance", light.radiance, radiometric);
      return light;
    }
    case LightType::sphere: break;
  }
  table.check_keys({"type", "centre", "radius", "radiance"}, {});
  SphereLight light;
  point("centre", light.centre);
  table.length("radius", light.radius, positive_length, metres_per_unit);
  table.colour("radiance", light.radiance, radiometric);
  return light;
}

std::string text_of(const glm::dvec3& v) { return printed("(%.6g, %.6g, %.6g)", v.x, v.y, v.z); }

/// What `vitrum info` says of a light.
struct LightText {
  std::string operator()(const PointLight& l) const {
    return "point at " + text_of(l.position) + " m, intensity " + text_of(l.intensity) + " W/sr";
  }
  std::string operator()(const DirectionalLight& l) const {
    return "directional along " + text_of(l.direction) + ", irradiance " + text_of(l.irradiance) + " W/m2";
  }
  std::string operator()(const QuadLight& l) const { return area("quad at " + text_of(l.corner), l.radiance); }
  std::string operator()(const DiscLight& l) const { return area("disc around " + text_of(l.centre), l.radiance); }
  std::string operator()(const SphereLight& l) const { return area("sphere around " + text_of(l.centre), l.radiance); }
  std::string operator()(const MeshLight&) const { return "emissive faces of the mesh"; }

  static std::string area(const std::string& place, const Spectrum& radiance) {
    return place + " m, radiance " + text_of(radiance) + " W/(m2 sr)";
  }
};

}  // namespace

std::string light_text(const Light& light) { return std::visit(LightText{}, light.emitter); }

std::vector<Light> read_lights(const TomlTable& root, const FileContext& context) {
  std::vector<Light> lights;
  const auto tables = root.named_tables("light");
  check_overridden_names(tables, "light");
  for (const auto& [name, table] : tables)
    lights.push_back({name, table.where(), read_emitter(table, context.metres_per_unit)});
  return lights;
}

}  // namespace vitrum
