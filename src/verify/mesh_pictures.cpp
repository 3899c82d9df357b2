// Pictures of meshes whose radiance has a closed form: facets around which all is white, facets that tend to a ball,
// and media that touch, in layers and in shells.

#include "verify/mesh_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <utility>

#include "verify/estimates.hpp"
#include "verify/truth_pictures.hpp"

namespace vitrum {
namespace {

using glm::dvec3;

const dvec3 eye(0.2, 0.3, 4);
const Spectrum absorption(0.1, 0.5, 2.0);

uint32_t add_medium(Scene& scene, double index, const Spectrum& sigma_a, int priority = 0) {
  scene.materials.push_back(glass(index, 0, priority));
  scene.materials.back().absorption = sigma_a;
  return static_cast<uint32_t>(scene.materials.size() - 1);
}

/// A white surround, seen from outside of what will stand around the origin. Behind the eye two boxes of air touch,
/// which absorb as good as nothing: so the same kernels serve all pictures of meshes.
Scene surround(int size) {
  Scene scene = truth_picture(eye, {0, 0, 0}, 32, size);
  const uint32_t air = add_medium(scene, 1.0, Spectrum(1e-30));
  add(scene, box({-0.1f, -0.1f, 9.8f}, {0.1f, 0.1f, 9.9f}, air));
  add(scene, box({-0.1f, -0.1f, 9.9f}, {0.1f, 0.1f, 10.0f}, air));
  return scene;
}

/// Pictures of bodies by ever finer meshes with the bodies' normals, held against the bodies: shells around the origin.
///
/// The normal at a place of a facet points away from the centre, as a ball's does: so the distance of a path from the
/// centre, times the index, is what it is at the ball. Facets lie up to h^2/4 under a ball of radius 1, h^2/6 on
/// average, for h = pi/n with n rings: radiance is off by ~ 1/n^2. Not so at the rim, where facets hide each other and
/// normals point away from the eye: only rays that pass within .9 of the outer radius count.
class FacetRows {
 public:
  /// `borders`: radii of the borders that a ray meets after the first, summed.
  FacetRows(const CheckContext& context, int size, double borders)
      : context_(context), size_(size), borders_(borders), fine_rings_(context.full ? 128 : 64) {}

  /// `add_bodies(scene, rings)` makes meshes of `shells`.
  void add(const std::string& what, const std::vector<Shell>& shells,
           const std::function<void(Scene&, int)>& add_bodies) {
    PlotLine line{what, {}};
    Means coarse, fine;
    for (int rings = 16; rings <= fine_rings_; rings *= 2) {
      Scene scene = surround(size_);
      // So little is cut that it stays below the error of the finest facets, which it could make good.
      scene.render.min_weight = context_.full ? 1e-7 : 1e-5;
      add_bodies(scene, rings);
      coarse = fine;
      fine = means(scene, shells);
      line.points.emplace_back(rings, fine.deviation);
    }
    const double order = -fitted_exponent(line.points), off = std::abs(order - 2);
    if (!(off <= order_.error)) order_where_ = what + printed(": order %.3f", order);
    order_.add(off, order_.cases);
    lines_.push_back(std::move(line));
    for (int c = 0; c < 3; ++c) {
      const auto extrapolated = [c, &coarse, &fine](Spectrum Means::*mean) {
        return (4 * (fine.*mean)[c] - (coarse.*mean)[c]) / 3;
      };
      const double found = extrapolated(&Means::found), truth = fine.truth[c];
      const double error = std::max({found - truth, truth - found - extrapolated(&Means::cut), 0.0});
      if (!(error <= mean_.error)) {
        mean_where_ = what + printed(", channel %d: found %.9g, truth %.9g", c, found, truth);
        pictures_ = fine.rendered->pictures(what + printed(", %d rings", fine_rings_), fine.errors, fine.scale);
      }
      mean_.add(std::isfinite(found) ? error : NAN, mean_.cases);
    }
  }

  std::vector<CheckResult> rows(const std::string& name, const char* truth) const {
    // Rays that bunch up on few facets behind the first border may meet their middles alone, or their corners: then
    // the mean depth of facets is off by up to h^2/6, and what is extrapolated by (4 h^2 + (2 h)^2)/18 = 4 h^2/9. With
    // the length of a path radiance changes by at most sigma exp(-2 sigma c)/c <= 1/(2 e c^2), c = cos theta_t: .25/m
    // on average over the pixels that count, for an index of 1.333 and more. The next term, of 1/n^4, is far smaller.
    const double h = std::numbers::pi / fine_rings_, bound = 4 * h * h / 9 * 0.25 * borders_;
    std::vector<CheckResult> rows;
    rows.push_back({name, mean_.cases, mean_.error, bound, "mean radiance", truth, mean_where_, {}, pictures_});
    // Errors that fall as 1/n or 1/n^3, or not at all, are off by 1 and more; rays that bunch up, by .1.
    rows.push_back({name + ": facets", order_.cases, order_.error, 0.25, "of the order",
                    "mean |pixel - truth| ~ 1/n^2 for n rings", order_where_,
                    {{"Facets: pictures of balls as meshes, off the balls'", "rings of facets", "mean |pixel - truth|", lines_, true, true}}, {}});
    return rows;
  }

 private:
  /// Over the pixels that count.
  struct Means {
    Spectrum found{0.0}, cut{0.0}, truth{0.0};
    double deviation = 0.0;
    std::optional<Rendered> rendered;
    std::vector<float> errors;  ///< of all pixels, in the worst channel
    double scale = 1.0;         ///< of the errors' colours: the rim's are beyond it
  };

  Means means(const Scene& scene, const std::vector<Shell>& shells) const {
    Means sums;
    sums.rendered.emplace(context_, scene);
    double pixels = 0.0;
    std::vector<float> counting;
    for (size_t i = 0; i < sums.rendered->cut.size(); ++i) {
      const double p = glm::length(glm::cross(eye, direction_of(scene, i))), cut = sums.rendered->cut[i];
      float worst = 0.0f;
      const bool counts = p <= 0.9;
      pixels += counts;
      const Spectrum exact = shells_radiance(shells, p);
      for (int c = 0; c < 3; ++c) {
        const double truth = exact[c], found = sums.rendered->radiance[3 * i + static_cast<size_t>(c)];
        const double error = std::max({found - truth, truth - found - cut, 0.0});
        worst = std::max(worst, static_cast<float>(error));
        if (!counts) continue;
        sums.found[c] += found;
        sums.cut[c] += cut;
        sums.truth[c] += truth;
        sums.deviation += error / 3;
      }
      sums.errors.push_back(worst);
      if (counts) counting.push_back(worst);
    }
    sums.scale = false_colour_scale(counting);
    for (Spectrum Means::*sum : {&Means::found, &Means::cut, &Means::truth}) sums.*sum /= pixels;
    sums.deviation /= pixels;
    return sums;
  }

  const CheckContext& context_;
  int size_;
  double borders_;
  int fine_rings_;
  Worst mean_, order_;
  std::string mean_where_, order_where_;
  std::vector<PlotLine> lines_;
  std::vector<CheckPicture> pictures_;
};

/// A ball with a hole: the faces of `hole` turned inside out. Both with normals.
Mesh hollowed(Mesh ball, const Mesh& hole) {
  const auto positions = static_cast<uint32_t>(ball.positions.size());
  const auto normals = static_cast<uint32_t>(ball.normals.size());
  ball.positions.insert(ball.positions.end(), hole.positions.begin(), hole.positions.end());
  for (const glm::vec3& normal : hole.normals) ball.normals.push_back(-normal);
  for (size_t k = 0; k < hole.triangles.size(); ++k) {
    const glm::uvec3 corners = hole.triangles[k], n = hole.normal_indices[k];
    ball.triangles.push_back(positions + glm::uvec3(corners.x, corners.z, corners.y));
    ball.normal_indices.push_back(normals + glm::uvec3(n.x, n.z, n.y));
  }
  ball.materials.insert(ball.materials.end(), hole.materials.begin(), hole.materials.end());
  return ball;
}

}  // namespace

std::vector<CheckResult> check_mesh_furnace(const CheckContext& context, int size) {
  PictureRow row;
  for (const double n : context.full ? std::vector<double>{1.00028, 1.333, 1.5, 2.4} : std::vector<double>{1.5, 2.4})
    for (const bool smooth : {false, true}) {
      Scene scene = surround(size);
      // As the exact ball's furnace.
      scene.render.max_depth = 20;
      scene.render.min_weight = 1e-4;
      add(scene, mesh_ball({0, 0, 0}, 1.0, 16, 32, smooth, add_medium(scene, n, Spectrum(0.0))));
      row.add(context, scene, [](const dvec3&) { return Range{dvec3(1), dvec3(1)}; },
              printed("n = %g, %s normals", n, smooth ? "the ball's" : "the facets'"));
    }
  return {row.result("slab-and-ball/mesh ball: furnace", "radiance 1 all around gives 1, whatever the facets")};
}

std::vector<CheckResult> check_mesh_ball(const CheckContext& context, int size) {
  FacetRows rows(context, size, 1.0);
  for (const double n : context.full ? std::vector<double>{1.333, 1.5, 2.4} : std::vector<double>{1.5, 2.4})
    rows.add(printed("n = %g, sigma_a = .1, .5, 2", n), {{1.0, n, absorption}}, [n](Scene& scene, int rings) {
      add(scene, mesh_ball({0, 0, 0}, 1.0, rings, 2 * rings, true, add_medium(scene, n, absorption)));
    });
  return rows.rows("slab-and-ball/mesh ball", "the ball's: facets of two sizes, extrapolated by 1/n^2");
}

std::vector<CheckResult> check_mesh_shells(const CheckContext& context, int size) {
  // A ball of glass, in its hole a liquid up to the very corners of the wall, and ice in that.
  FacetRows rows(context, size, 2 * 0.8 + 2 * 0.4 + 1.0);
  for (const double n : context.full ? std::vector<double>{1.333, 1.7} : std::vector<double>{1.333}) {
    const std::vector<Shell> shells = {
        {1.0, 1.5, absorption}, {0.8, n, {0.5, 0.3, 0.1}}, {0.4, 1.31, {0.5, 1.0, 0.2}}};
    rows.add(printed("n = 1.5 around %g, around 1.31", n), shells, [&shells](Scene& scene, int rings) {
      std::vector<Mesh> balls;
      for (const auto& [radius, index, sigma_a] : shells)
        balls.push_back(mesh_ball({0, 0, 0}, radius, rings, 2 * rings, true, add_medium(scene, index, sigma_a)));
      Mesh hole = balls[1];
      hole.materials = balls[0].materials;
      add(scene, hollowed(balls[0], hole));
      add(scene, balls[1]);
      add(scene, balls[2]);
    });
  }
  return rows.rows("slab-and-ball/mesh shells", "balls that touch: facets of two sizes, extrapolated by 1/n^2");
}

std::vector<CheckResult> check_touching_layers(const CheckContext& context, int size) {
  enum Medium : uint32_t { wall = 1, liquid, ice };  // materials
  struct Body {
    Medium medium;
    double top, bottom;
  };
  struct Case {
    const char* what;
    std::vector<Body> bodies, layers;  // as they are listed, and what the media's priorities make of them
  };
  const std::vector<Body> on_liquid = {{wall, 0, -0.3}, {liquid, -0.3, -0.8}};
  const std::vector<Body> ice_at_wall = {{wall, 0, -0.3}, {ice, -0.3, -0.6}, {liquid, -0.6, -0.8}};
  const Case cases[] = {
      {"liquid at the glass", on_liquid, on_liquid},
      {"liquid reaching into the glass", {{liquid, -0.25, -0.8}, {wall, 0, -0.3}}, on_liquid},
      {"ice in the liquid",
       {{wall, 0, -0.3}, {liquid, -0.3, -0.8}, {ice, -0.45, -0.6}},
       {{wall, 0, -0.3}, {liquid, -0.3, -0.45}, {ice, -0.45, -0.6}, {liquid, -0.6, -0.8}}},
      {"ice and liquid at the glass", {{ice, -0.3, -0.6}, {wall, 0, -0.3}, {liquid, -0.3, -0.8}}, ice_at_wall},
      {"ice at the glass, liquid reaching into it",
       {{ice, -0.3, -0.6}, {wall, 0, -0.3}, {liquid, -0.25, -0.8}},
       ice_at_wall},
  };
  const Spectrum sigma_a[] = {{}, {0.7, 0.3, 0.0}, {0.2, 0.5, 0.4}, {0.1, 0.3, 1.0}};
  PictureRow row;
  for (const double liquid_index : context.full ? std::vector<double>{1.333, 1.7} : std::vector<double>{1.333}) {
    const double indices[] = {1.0, 1.5, liquid_index, 1.31};
    for (const Case& k : cases) {
      Scene scene = lit_from_both_sides(size);
      scene.render.min_weight = 1e-6;  // 4e-5 is cut at most
      for (const auto& [medium, priority] : {std::pair(wall, 2), {liquid, 0}, {ice, 1}})
        add_medium(scene, indices[medium], sigma_a[medium], priority);
      for (const Body& body : k.bodies) add(scene, layer(body.top, body.bottom, body.medium));
      std::vector<Layer> layers;
      for (const auto& [medium, top, bottom] : k.layers)
        layers.push_back({indices[medium], top - bottom, sigma_a[medium]});
      row.add(context, scene, [&layers](const dvec3& direction) { return layers_seen(layers, direction); },
              printed("%s, n = %g", k.what, liquid_index));
    }
  }
  return {row.result("slab-and-ball/touching layers", "the adding method; Schmidt and Budge 2002")};
}

}  // namespace vitrum
