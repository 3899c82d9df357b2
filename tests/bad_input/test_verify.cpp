// `vitrum verify`: passes, fails with kernels in which a formula is wrong and names the check, refuses what it does not know.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "broken_kernels.hpp"
#include "command_line.hpp"

using namespace vitrum;

namespace {

/// Each of `checks` fails; they are of `groups`.
void check_caught(const BrokenKernels& kernels, const std::vector<std::string>& groups,
                  const std::vector<std::string>& checks) {
  std::vector<std::string> arguments = {"verify", "--kernels", kernels.folder.path()};
  for (const std::string& group : groups) arguments.insert(arguments.end(), {"--only", group});
  const Ended run = vitrum_run(arguments);
  CAPTURE(run.out);
  CAPTURE(run.err);
  CHECK(run.code == 1);
  for (const std::string& check : checks) {
    CAPTURE(check);
    CHECK(contains(run.out, "FAIL " + check + ": "));
    CHECK(contains(run.out, "; kernels/"));
  }
}

}  // namespace

TEST_CASE("verify passes, and its report holds what the table has") {
  const TemporaryFolder folder;
  const std::string json = folder / "v.json", html = folder / "v.html", markdown = folder / "v.md";
  const Ended run = vitrum_run({"verify", "--only", "interface", "--only", "absorption", "--only", "slab-and-ball", "--report",
                                json, "--report-html", html, "--report-markdown", markdown});
  CHECK_MESSAGE(run.code == 0, run.out);
  CHECK(contains(run.out, " 0 failed"));
  const auto report = nlohmann::json::parse(file_bytes(json));
  CHECK(report["mode"] == "quick");
  CHECK(report["checks"].size() == 30);
  for (const auto& check : report["checks"]) CHECK(check["passed"] == true);
  for (const auto& check : report["checks"]) CHECK_FALSE(check["kernel"].get<std::string>().empty());
  CHECK(contains(file_bytes(html), "<svg"));
  CHECK(contains(file_bytes(markdown), "checks, all hold"));
  CHECK(contains(file_bytes(markdown), "](v/interface-reflectance-plot1.svg)"));
  CHECK(contains(file_bytes(folder / "v/interface-reflectance-plot1.svg"), ">Cook and Torrance's g</text>"));
}

TEST_CASE("verify catches a wrong formula and names the check") {
  check_caught({"fresnel.cl", "0.5f * (r * r) * fma(b, b, 1.0f)", "0.5f * (r * r) * fma(b, b, 1.0001f)"}, {"interface"},
               {"interface/reflectance"});
  check_caught({"fresnel.cl", "-x)) - lost;", "-x));"}, {"absorption"}, {"absorption/transmittance"});
  check_caught({"media.h", "top_medium(stack)].sigma_a;", "0].sigma_a;"}, {"slab-and-ball"}, {"slab-and-ball/absorbing ball"});
  // Surfaces in contact are met one by one, and facets show their own normals.
  check_caught({"trace_mesh.h", "SET_LANE(surface->contacts, uint, lane, contacts);",
                "SET_LANE(surface->contacts, uint, lane, 0);"},
               {"slab-and-ball", "photons"},
               {"slab-and-ball/touching layers", "slab-and-ball/mesh shells", "slab-and-ball/mesh shells: facets",
                "photons/mesh shells"});
  check_caught({"trace_mesh.h", "shading = select3(is_smooth, normalize_any3(n), geometric);", ""},
               {"slab-and-ball"}, {"slab-and-ball/mesh ball", "slab-and-ball/mesh ball: rim", "slab-and-ball/mesh shells: facets"});
}

TEST_CASE("every row that is a matter of chance sees 1 %") {
  // Of a photon's power, of the irradiance that is gathered, and of that by a lamp.
  check_caught({"stages/photons.cl", "scale3(share * weight, emission.power)", "scale3(1.01f * share * weight, emission.power)"},
               {"photons", "density"},
               {"photons/absorbed in a ball", "photons/reflected by a ball", "photons/encircled flux", "photons/pool",
                "photons/mesh ball", "photons/shells", "photons/mesh shells", "photons/emissive mesh", "density/unbiased",
                "density/bias with radius", "density/noise with count", "density/progressive: bias",
                "density/patches: smooth light", "density/patches: flux"});
  check_caught({"gather_within.h", "(2.0f * 0.318309886183790672f * inverse_r2)", "(1.98f * 0.318309886183790672f * inverse_r2)"},
               {"density"},
               {"density/unbiased", "density/bias with radius", "density/noise with count", "density/progressive: bias"});
  check_caught({"direct_light.h", "scale3(lit ? cos_theta : 0.0f,", "scale3(lit ? 1.01f * cos_theta : 0.0f,"}, {"lights"},
               {"lights/disc, sphere, quad", "lights/emissive meshes"});
}

TEST_CASE("verify refuses what it does not know") {
  check_refused({"verify", "--only", "interfaces"}, "--only interfaces", "there is no such group", "did you mean 'interface'?");
  check_refused({"verify", "--kernels", "/nowhere"}, "--kernels /nowhere", "there is no such folder", "name the folder");
  CHECK(vitrum_run({"verify", "--quick", "--full"}).code == 2);
}
