// Pictures of meshes whose radiance has a closed form: facets around which all is white, facets that tend to a ball,
// and media that touch, in layers and in shells.

#include "verify/mesh_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "verify/estimates.hpp"
#include "verify/shells.hpp"
#include "verify/truth_pictures.hpp"

namespace vitrum {
namespace {

using glm::dvec3;

constexpr double infinity = std::numeric_limits<double>::infinity();

const dvec3 eye(0.2, 0.3, 4);
/// On the rim of the ball of radius 1, seen from there; where the rim begins [m], as the rays' distance from the centre.
const dvec3 rim_place = 0.99 * glm::normalize(glm::cross(eye, dvec3(1, 0.2, 0.1)));
constexpr double rim_begins = 0.9;

const Spectrum absorption(0.1, 0.5, 2.0);

/// A white surround, seen from outside of what will stand around the origin. Behind the eye two boxes of air touch,
/// which absorb as good as nothing: so the same kernels serve all pictures of meshes.
Scene surround(int size) {
  Scene scene = truth_picture(eye, {0, 0, 0}, 32, size);
  const uint32_t air = add_medium(scene, 1.0, Spectrum(1e-30));
  add(scene, box({-0.1f, -0.1f, 9.8f}, {0.1f, 0.1f, 9.9f}, air));
  add(scene, box({-0.1f, -0.1f, 9.9f}, {0.1f, 0.1f, 10.0f}, air));
  return scene;
}

/// How errors fall with the number of rings, of several bodies.
class Orders {
 public:
  /// `line`: the error by the number of rings. True if its order is the farthest one off 2 up to now.
  bool add(PlotLine line) {
    const double order = -fitted_exponent(line.points), off = std::abs(order - 2);
    const bool is_worst = !(off <= worst_.error);
    if (is_worst) where_ = line.name + printed(": order %.3f", order);
    worst_.add(off, worst_.cases);
    lines_.push_back(std::move(line));
    return is_worst;
  }

  /// Errors that fall as 1/n or 1/n^3, or not at all, are off by 1 and more; rays that bunch up, by .1.
  CheckResult row(const std::string& name, const char* truth, const char* plot) const {
    return {name, worst_.cases, worst_.error, 0.25, "of the order", truth, where_,
            {{plot, "rings of facets", "mean |pixel - truth|", lines_, true, true}}, {}};
  }

 private:
  Worst worst_;
  std::string where_;
  std::vector<PlotLine> lines_;
};

/// Pictures of bodies by ever finer meshes with the bodies' normals, held against the bodies: shells around the origin.
///
/// The normal at a place of a facet points away from the centre, as a ball's does: so the distance of a path from the
/// centre, times the index, is what it is at the ball, and radiance is off by ~ 1/n^2 for n rings (facets_bound). Not so at
/// the rim, where facets hide each other and normals point away from the eye. There only the width of the ring where that
/// is so falls as 1/n^2; so it is looked at by itself, in a picture of a piece of the rim.
class FacetRows {
 public:
  FacetRows(const CheckContext& context, int size)
      : context_(context), size_(size), fine_rings_(context.full ? 128 : 64) {}

  void add(const std::string& what, const std::vector<Shell>& shells) {
    PlotLine line{what, {}}, rim_line{what, {}};
    Means coarse, fine, rim;
    for (int rings = 16; rings <= fine_rings_; rings *= 2) {
      Scene scene = surround(size_);
      // So little is cut that it stays below the error of the finest facets, which it could make good.
      scene.render.min_weight = context_.full ? 1e-7 : 1e-5;
      add_mesh_shells(scene, shells, rings);
      coarse = fine;
      fine = means(scene, shells, 0.0, rim_begins);
      line.points.emplace_back(rings, fine.deviation);
      scene.camera.look_at = rim_place;
      scene.camera.vertical_fov = 4;
      rim = means(scene, shells, rim_begins, infinity);
      rim_line.points.emplace_back(rings, rim.deviation);
    }
    bound_ = std::max(bound_, facets_bound(fine_rings_, shells));
    order_.add(std::move(line));
    if (rim_order_.add(std::move(rim_line)))
      rim_pictures_ = rim.rendered->pictures(what + printed(", %d rings, the rim", fine_rings_), rim.errors, rim.scale);
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
    std::vector<CheckResult> rows;
    rows.push_back({name, mean_.cases, mean_.error, bound_, "mean radiance", truth, mean_where_, {},
                    pictures_});
    const char* order_truth = "mean |pixel - truth| ~ 1/n^2 for n rings";
    rows.push_back(order_.row(name + ": facets", order_truth, "Facets: pictures of balls as meshes, off the balls'"));
    rows.push_back(rim_order_.row(name + ": rim", order_truth, "Facets: pictures of the rim of balls as meshes, off the balls'"));
    rows.back().pictures = rim_pictures_;
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

  /// Of the rays whose distance from the centre is in [least, most].
  Means means(const Scene& scene, const std::vector<Shell>& shells, double least, double most) const {
    Means sums;
    sums.rendered.emplace(context_, scene);
    double pixels = 0.0;
    std::vector<float> counting;
    for (size_t i = 0; i < sums.rendered->cut.size(); ++i) {
      const double p = glm::length(glm::cross(eye, direction_of(scene, i))), cut = sums.rendered->cut[i];
      float worst = 0.0f;
      const bool counts = p >= least && p <= most;
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
  double bound_ = 0.0;
  int fine_rings_;
  Worst mean_;
  Orders order_, rim_order_;
  std::string mean_where_;
  std::vector<CheckPicture> pictures_, rim_pictures_;
};

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
  FacetRows rows(context, size);
  for (const double n : context.full ? std::vector<double>{1.333, 1.5, 2.4} : std::vector<double>{1.5, 2.4})
    rows.add(printed("n = %g, sigma_a = .1, .5, 2", n), {{1.0, n, absorption}});
  return rows.rows("slab-and-ball/mesh ball", "the ball's: facets of two sizes, extrapolated by 1/n^2");
}

std::vector<CheckResult> check_mesh_shells(const CheckContext& context, int size) {
  FacetRows rows(context, size);
  for (const double n : context.full ? std::vector<double>{1.333, 1.7} : std::vector<double>{1.333})
    rows.add(printed("n = 1.5 around %g, around 1.31", n), glass_liquid_ice(n));
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
