// Photons by themselves: what becomes of their power, and where it lands, against integrals over the ball, over shells
// that touch, over the lamp's directions above a pool, and over an emissive mesh.

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <numbers>

#include "reference/ball_caustic.hpp"
#include "reference/pool.hpp"
#include "reference/quadrature.hpp"
#include "verify/caustic_picture.hpp"
#include "verify/estimates.hpp"
#include "verify/groups.hpp"
#include "verify/photon_run.hpp"
#include "verify/scenes.hpp"
#include "verify/shells.hpp"

namespace vitrum {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr uint32_t replicates = 32;         // random shifts of the low-discrepancy points; their spread is the error
// Powers and positions are floats: what cannot be told from the truth, of the whole.
constexpr double rounding = 2e-6;

// An emissive mesh above the ball of air; all that it sends to the middle of the plane goes through the ball.
const glm::dvec3 panel_corner(-0.5, 1.2, -0.375), panel_u(1, 0, 0), panel_v(0, 0, 0.75);

/// Hemispherical reflectance of index n from outside: the share of a parallel beam that a ball reflects at once.
/// Dunkle's closed form of 2 int R(theta) sin theta cos theta dtheta, as in Duntley 1942.
double hemispherical_reflectance(double n) {
  const double n2 = n * n, n4 = n2 * n2;
  return 0.5 + (n - 1) * (3 * n + 1) / (6 * (n + 1) * (n + 1)) +
         n2 * (n2 - 1) * (n2 - 1) / ((n2 + 1) * (n2 + 1) * (n2 + 1)) * std::log((n - 1) / (n + 1)) -
         2 * n2 * n * (n2 + 2 * n - 1) / ((n2 + 1) * (n4 - 1)) +
         8 * n4 * (n4 + 1) / ((n2 + 1) * (n4 - 1) * (n4 - 1)) * std::log(n);
}

/// What shells absorb of the light of ball_over_plane [W], in channel `c`: all that they do not send back, since who sees
/// them in a white surround would look along the way of the light.
double absorbed_by_shells(const std::vector<Shell>& shells, double light_distance, int c) {
  // p = sin u is a ray's distance from the centre; beyond a critical angle, or beside the next shell, its way is another.
  std::vector<double> ends = {0.0, pi / 2};
  double outside = 1.0;
  for (const Shell& shell : shells) {
    for (const double p : {outside * shell.radius, shell.index * shell.radius})
      if (p < 1.0) ends.push_back(std::asin(p));
    outside = shell.index;
  }
  std::sort(ends.begin(), ends.end());
  const auto absorbed = [&](double u) {
    const double p = std::sin(u), share = (1.0 - shells_radiance(shells, p)[c]) * p * std::cos(u);
    if (std::isinf(light_distance)) return 2 * share;
    return share / (2 * light_distance * leg(light_distance, p));
  };
  double sum = 0.0;
  for (size_t k = 1; k < ends.size(); ++k) sum += reference::integral(absorbed, ends[k - 1], ends[k], 1e-11);
  return sum;
}

/// Power [W] by replicate, red, green and blue.
using Powers = std::array<std::vector<double>, 3>;

/// What became of the photons.
struct Landed {
  Powers absorbed, stored;
  std::vector<Powers> within;   ///< stored within each of some radii around the axis
};

/// What many facets tend to: the mesh's deviation falls with the square of their size, and half the size is known too.
std::vector<double> extrapolated(const std::vector<double>& coarse, const std::vector<double>& fine) {
  std::vector<double> values;
  for (size_t k = 0; k < fine.size(); ++k) values.push_back((4 * fine[k] - coarse[k]) / 3);
  return values;
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Turns the poles of meshes away from the axis of the light: or else a circle around that axis would meet all facets of
/// a ring alike.
const glm::quat askew = glm::angleAxis(1.0f, glm::normalize(glm::vec3(1, 2, 3)));

/// The ball as a mesh of 4 rings (rings - 1) facets with the ball's normals, askew.
Scene mesh_ball_over_plane(double index, const Spectrum& sigma_a, double light_distance, int rings) {
  Scene scene = ball_over_plane(index, sigma_a, light_distance);
  scene.shapes[0].geometry = turned(mesh_ball({0, 0, 0}, 1.0, rings, 2 * rings, true, 0), askew);
  scene.shapes[0].material = none;
  // An emissive mesh far aside, as good as dark: so the same kernels serve the panel.
  add_panel(scene, panel_corner + glm::dvec3(20, 0, 0), panel_u, panel_v, 1, 1e-30);
  return scene;
}

/// Everything that photons are checked for.
class PhotonChecks {
 public:
  /// `count`: photons of a replicate; `mesh_count`: where there are meshes.
  PhotonChecks(const CheckContext& context, uint64_t count, uint64_t mesh_count)
      : context_(context), count_(count), mesh_count_(mesh_count), fine_rings_(context.full ? 256 : 64) {}

  void ball(double index, const Spectrum& sigma_a, double light_distance) {
    const std::string what = printed("n = %g, light at %g m", index, light_distance);
    const Landed landed = shoot(ball_over_plane(index, sigma_a, light_distance), count_, all_radii(), what);
    for (int c = 0; c < 3; ++c) {
      const reference::BallOnAxis truth{1.0, index, sigma_a[c], 2.0, light_distance};
      const std::string channel = what + printed(", sigma_a = %g", sigma_a[c]);
      // Where it is opaque, all that is not reflected is absorbed: closed form.
      if (sigma_a[c] > 1e3 && std::isinf(light_distance))
        reflected_.add(landed.absorbed[c], 1 - hemispherical_reflectance(index), rounding, channel);
      else
        absorbed_.add(landed.absorbed[c], reference::absorbed_flux(truth), rounding, channel);
      for (size_t k = 0; k < radii.size(); ++k)
        encircled_.add(landed.within[k][c], reference::encircled_flux(truth, radii[k], reference::Orders::all), rounding,
                       channel + printed(", r < %g m", radii[k]));
      encircled_.add(landed.stored[c], reference::encircled_flux(truth, infinity, reference::Orders::all), rounding,
                     channel + ", all of the plane");
    }
  }

  /// The ball as two meshes, of half the size of facets and the other.
  void mesh(double index, const Spectrum& sigma_a, double light_distance) {
    const std::string what = printed("mesh, n = %g, light at %g m", index, light_distance);
    // Both in the same random numbers.
    const uint64_t seed = runs_;
    const auto landed = [&](int rings) {
      runs_ = seed;
      return shoot(mesh_ball_over_plane(index, sigma_a, light_distance, rings), mesh_count_, all_radii(), what);
    };
    const Landed coarse = landed(fine_rings_ / 2), fine = landed(fine_rings_);
    if (std::isinf(light_distance)) add_deviation(fine_rings_ / 2, coarse, index, sigma_a);
    for (int c = 0; c < 3; ++c) {
      const reference::BallOnAxis truth{1.0, index, sigma_a[c], 2.0, light_distance};
      const std::string channel = what + printed(", sigma_a = %g", sigma_a[c]);
      mesh_.add(extrapolated(coarse.absorbed[c], fine.absorbed[c]), reference::absorbed_flux(truth), rounding,
                channel + ", absorbed");
      for (size_t k = 0; k < radii.size(); ++k)
        mesh_.add(extrapolated(coarse.within[k][c], fine.within[k][c]),
                  reference::encircled_flux(truth, radii[k], reference::Orders::all), rounding,
                  channel + printed(", r < %g m", radii[k]));
      mesh_.add(extrapolated(coarse.stored[c], fine.stored[c]),
                reference::encircled_flux(truth, infinity, reference::Orders::all), rounding, channel + ", all of the plane");
    }
  }

  /// Glass with a liquid of index `n` in it, and ice in that, as spheres and as meshes of two sizes that touch.
  void shells(double n, double light_distance) {
    const std::vector<Shell> bodies = glass_liquid_ice(n);
    const std::string what = printed("n = 1.5 around %g, around 1.31, light at %g m", n, light_distance);
    const auto scene = [&] {
      Scene empty = ball_over_plane(1.0, Spectrum(0.0), light_distance);
      empty.shapes.erase(empty.shapes.begin());
      return empty;
    };
    Scene spheres = scene();
    for (const Shell& shell : bodies)
      add(spheres, Sphere{{0, 0, 0}, shell.radius}, add_medium(spheres, shell.index, shell.sigma_a));
    const Landed exact = shoot(spheres, count_, {}, what);
    const uint64_t seed = runs_;
    const auto landed = [&](int rings) {
      runs_ = seed;
      Scene meshes = scene();
      add_mesh_shells(meshes, bodies, rings, askew);
      return shoot(meshes, mesh_count_, {}, what + ", meshes");
    };
    const Landed coarse = landed(fine_rings_ / 2), fine = landed(fine_rings_);
    // Of the light that meets them.
    const double lit = std::isinf(light_distance) ? 1.0 : 0.5 * (1 - leg(1.0, 1 / light_distance));
    for (int c = 0; c < 3; ++c) {
      const double truth = absorbed_by_shells(bodies, light_distance, c);
      shells_.add(exact.absorbed[c], truth, rounding, what + printed(", channel %d", c));
      mesh_shells_.add(extrapolated(coarse.absorbed[c], fine.absorbed[c]), truth,
                       rounding + lit * facets_bound(fine_rings_, bodies), what + printed(", meshes, channel %d", c));
    }
  }

  /// Coarser meshes in a beam: how far what they absorb is off the ball's.
  void facets(double index, const Spectrum& sigma_a, const std::vector<int>& rings_of_meshes) {
    const uint64_t count = std::min<uint64_t>(mesh_count_, 400'000);  // is enough for deviations so large
    for (const int rings : rings_of_meshes) {
      const Scene scene = mesh_ball_over_plane(index, sigma_a, infinity, rings);
      add_deviation(rings, shoot(scene, count, {}, printed("mesh of %d rings", rings)), index, sigma_a);
    }
  }

  void pool(double height) {
    const reference::Pool water{1.333, 0.0, height, 1.0};
    const Spectrum sigma_a(0.0, 0.5, 2.0);
    // The last two: for the irradiance on the axis.
    const std::vector<double> pool_radii = {0.2, 0.5, 1.0, 3.0, axis_radius, 2 * axis_radius};
    Scene scene = ball_over_plane(water.index, sigma_a, 1.0 + height);
    scene.shapes[0].geometry = Plane{{0, 1, 0}, {0, 1, 0}, {}, {}};
    scene.shapes[1].geometry = Plane{{0, 1 - water.depth, 0}, {0, 1, 0}, {}, {}};
    const std::string what = printed("light %g m above the water", height);
    const Landed landed = shoot(scene, count_, pool_radii, what);
    for (int c = 0; c < 3; ++c) {
      reference::Pool truth = water;
      truth.sigma_a = sigma_a[c];
      const std::string channel = what + printed(", sigma_a = %g", sigma_a[c]);
      for (size_t k = 0; k < 4; ++k)
        pool_.add(landed.within[k][c], reference::encircled_flux(truth, pool_radii[k]), rounding,
                  channel + printed(", r < %g m", pool_radii[k]));
      pool_.add(landed.stored[c], reference::encircled_flux(truth, infinity), rounding, channel + ", all of the bottom");
      // Flux within r and 2 r tells that of an even irradiance as on the axis, up to r^6.
      std::vector<double> on_axis;
      for (uint32_t k = 0; k < replicates; ++k)
        on_axis.push_back((16 * landed.within[4][c][k] - landed.within[5][c][k]) / 12);
      pool_.add(on_axis, reference::irradiance_on_axis(truth) * axis_radius * axis_radius / 4, rounding,
                channel + ", on the axis");
    }
  }

  /// How the error of an encircled flux falls with the number of photons: a plot.
  void convergence() {
    const reference::BallOnAxis truth{1.0, 1.5, 0.0, 2.0, infinity};
    constexpr double radius = 0.5;
    const double flux = reference::encircled_flux(truth, radius, reference::Orders::all);
    PlotLine sequence{"vitrum, low-discrepancy", {}}, independent{"vitrum, independent", {}}, chance{"independent, in theory", {}};
    for (const uint64_t count : {1u << 10, 1u << 12, 1u << 14, 1u << 16, 1u << 18, 1u << 20}) {
      for (PlotLine* line : {&sequence, &independent}) {
        Scene scene = ball_over_plane(1.5, Spectrum(0.0), infinity);
        if (line == &independent) scene.photons.sampling = Sampling::independent;
        double squares = 0.0;
        const Landed landed = shoot(scene, count, {radius}, "convergence");
        for (const double found : landed.within[0][0])
          squares += (found / flux - 1) * (found / flux - 1) / replicates;
        line->points.emplace_back(count, std::sqrt(squares));
      }
      // All shots have the same power; what is reflected inside weighs less, but that is little.
      chance.points.emplace_back(count, std::sqrt((1 - flux) / flux / static_cast<double>(count)));
    }
    convergence_ = {printed("Flux of a ball's caustic within half its radius, beam, n = 1.5: exponents %.2f and %.2f",
                            fitted_exponent(sequence.points), fitted_exponent(independent.points)),
                    "photons", "error (RMS of 32 runs), relative", {sequence, independent, chance}, true, true};
  }

  /// Photons of an emissive mesh of 1 W, through a ball of air in its way.
  void panel() {
    const std::vector<double> panel_radii = {0.2, 0.35, 0.5};
    const double radiance = 1 / (pi * glm::length(panel_u) * glm::length(panel_v));
    Scene scene = ball_over_plane(1.0, {0.0, 0.5, 2.0}, 3.0);
    add_panel(scene, panel_corner, panel_u, panel_v, 8, radiance);
    for (Light& light : scene.lights)
      if (auto* lamp = std::get_if<PointLight>(&light.emitter)) lamp->intensity = Spectrum(0.0);
    const Landed landed = shoot(scene, mesh_count_, panel_radii, "emissive mesh");
    for (size_t k = 0; k < panel_radii.size(); ++k) {
      const auto ring = [&](double r) {
        double sum = 0.0;
        constexpr int directions = 16;  // of a smooth periodic function: exact to 1e-12
        for (int d = 0; d < directions; ++d) {
          const double phi = 2 * pi * d / directions;
          sum += panel_irradiance(panel_corner, panel_u, panel_v, {r * std::cos(phi), -2, r * std::sin(phi)});
        }
        return radiance * 2 * pi * r * sum / directions;
      };
      panel_.add(landed.within[k][0], reference::integral(ring, 0.0, panel_radii[k], 1e-12), rounding,
                 printed("r < %g m", panel_radii[k]));
    }
    // All that is sent to the ball, pi (R/d)^2 cos from each place of the panel: pi times the panel's solid angle as seen
    // from the ball's centre.
    const double a = 0.5 * panel_u.x, b = 0.5 * panel_v.z, h = panel_corner.y;
    const double solid_angle = 4 * std::atan(a * b / (h * std::sqrt(a * a + b * b + h * h)));
    panel_.add(landed.stored[0], radiance * pi * solid_angle, rounding, "all of the plane");
  }

  std::vector<CheckResult> rows() const {
    std::vector<CheckResult> rows;
    rows.push_back({"photons/conservation", balance_.cases, balance_.error, 1e-6, "relative",
                    "shot + split = stored + absorbed + direct + lost + cut", where_});
    branching_.rows("photons/branching", "photons that branch off: as often as their share of the light says",
                    0.5 / std::sqrt(static_cast<double>(replicates * std::min(count_, mesh_count_))), "of the whole",
                    "standard error of independent photons", rows);
    // The error is at most that of as many independent photons that are stored or not by the toss of a coin.
    const auto add = [&](const Estimates& estimates, const char* name, const char* truth, uint64_t count) {
      estimates.rows(name, truth, 0.5 / std::sqrt(static_cast<double>(replicates * count)), "of the whole",
                     "standard error of independent photons", rows);
    };
    add(absorbed_, "photons/absorbed in a ball", "2 int T(1-tau)/(1-R tau) sin cos dtheta, quadrature", count_);
    add(reflected_, "photons/reflected by a ball", "hemispherical reflectance, closed form", count_);
    add(encircled_, "photons/encircled flux", "the ball's caustic by quadrature, all orders", count_);
    if (!convergence_.lines.empty()) rows[rows.size() - 2].plots.push_back(convergence_);
    add(pool_, "photons/pool", "r = h tan + t tan theta_t by quadrature; I T tau / (h + t/n)^2", count_);
    add(mesh_, "photons/mesh ball", "the ball's: facets of two sizes, extrapolated by 1/n^2", mesh_count_);
    add(shells_, "photons/shells", "1 - radiance of shells in a white surround, over the light's rays", count_);
    add(mesh_shells_, "photons/mesh shells", "the shells': facets of two sizes, extrapolated by 1/n^2", mesh_count_);
    add(panel_, "photons/emissive mesh", "Lambert's polygon by quadrature; pi times the solid angle", mesh_count_);
    // The next term is of 1/n^3: it takes .2 off the order between 8 and 32 rings, and .03 between 32 and 128.
    const double order = -fitted_exponent(facets_);
    rows.push_back({"photons/mesh ball: facets", facets_.size(), std::abs(order - 2), context_.full ? 0.1 : 0.25,
                    "of the order", "absorbed: the ball's, off by ~ 1/n^2 for n rings", printed("order %.3f", order),
                    {{"Facets: absorption of a ball as a mesh, off the ball's", "rings of facets", "deviation, of the light",
                      {{"vitrum", facets_}}, true, true}}});
    return rows;
  }

 private:
  static constexpr std::array<double, 4> radii = {0.1, 0.2, 0.5, 1.0};
  static std::vector<double> all_radii() { return {radii.begin(), radii.end()}; }
  static constexpr double axis_radius = 0.15;
  static constexpr double all_shots = 34;     // calls of shoot() by check_photons in full

  /// Shoots all replicates and checks their balance, and that of all of them together.
  Landed shoot(Scene scene, uint64_t count, const std::vector<double>& within, const std::string& what) {
    scene.render.seed = runs_++;
    PhotonRun run(scene, context_.device, context_.kernels);
    Landed landed;
    landed.within.resize(within.size());
    PhotonBalance before;
    std::vector<double> split;
    for (uint32_t replicate = 0; replicate < replicates; ++replicate) {
      const std::vector<cl_float8> photons = run.shoot(replicate, count);
      const PhotonBalance after = run.balance();
      std::vector<Spectrum> sums(within.size(), Spectrum(0.0));
      for (const cl_float8& p : photons) {
        const double r = std::hypot(p.s[0], p.s[2]);
        for (size_t k = 0; k < within.size(); ++k)
          if (r <= within[k]) sums[k] += Spectrum(p.s[4], p.s[5], p.s[6]);
      }
      for (int c = 0; c < 3; ++c) {
        landed.absorbed[c].push_back(after.absorbed[c] - before.absorbed[c]);
        landed.stored[c].push_back(after.stored[c] - before.stored[c]);
        for (size_t k = 0; k < within.size(); ++k) landed.within[k][c].push_back(sums[k][c]);
      }
      check_balance(before, after, what + printed(", replicate %u", replicate));
      split.push_back((after.split.x - before.split.x) / (after.shot.x - before.shot.x));
      before = after;
    }
    check_balance({}, before, what + ", all replicates");
    // In balls of air there is nothing to branch off; shots of few photons would make the row blunt.
    const bool branches = std::any_of(split.begin(), split.end(), [](double share) { return share != 0; });
    if (branches && count >= std::min(count_, mesh_count_)) branching_.add(split, 0.0, 0.0, what);
    context_.progress(static_cast<double>(++shots_) / all_shots);
    return landed;
  }

  void add_deviation(int rings, const Landed& landed, double index, const Spectrum& sigma_a) {
    const double truth = reference::absorbed_flux({1.0, index, sigma_a[2], 2.0, infinity});
    facets_.emplace_back(rings, std::abs(mean(landed.absorbed[2]) - truth));
  }

  /// Of the photons that were shot in between.
  void check_balance(const PhotonBalance& before, const PhotonBalance& after, const std::string& what) {
    for (int c = 0; c < 3; ++c) {
      const auto power = [&](Spectrum PhotonBalance::*term) { return (after.*term)[c] - (before.*term)[c]; };
      const double ends = power(&PhotonBalance::stored) + power(&PhotonBalance::absorbed) + power(&PhotonBalance::direct) +
                          power(&PhotonBalance::lost) + power(&PhotonBalance::cut);
      const double begun = power(&PhotonBalance::shot) + power(&PhotonBalance::split);
      const double error = std::abs(ends / begun - 1);
      if (!(error <= balance_.error)) where_ = what + printed(", channel %d", c);
      balance_.add(error, balance_.cases);
    }
  }

  const CheckContext& context_;
  uint64_t count_, mesh_count_, runs_ = 0;  ///< runs_: seeds used
  int shots_ = 0;
  int fine_rings_;
  Worst balance_;
  std::string where_;
  Estimates branching_, absorbed_, reflected_, encircled_, mesh_, pool_, shells_, mesh_shells_, panel_;
  std::vector<std::pair<double, double>> facets_;
  Plot convergence_;
};

}  // namespace

std::vector<CheckResult> check_photons(const CheckContext& context) {
  // In full 10^8 to each exact body, in all replicates together. Meshes take ten times as long: a third of that.
  PhotonChecks checks(context, context.full ? 3'200'000 : 32'000, context.full ? 1'000'000 : 8'000);
  checks.ball(1.333, {0.1, 1.0, 1e6}, infinity);
  checks.ball(1.5, {0.0, 0.5, 1e6}, infinity);
  checks.ball(2.4, {0.1, 2.0, 1e6}, infinity);
  checks.ball(1.5, {0.0, 0.5, 2.0}, 1.5);
  checks.ball(1.333, {0.0, 0.5, 2.0}, 3.0);
  checks.ball(2.4, {0.1, 0.5, 2.0}, 10.0);
  for (const double height : {0.5, 1.0, 2.0}) checks.pool(height);
  checks.facets(1.5, {0.0, 0.5, 2.0}, context.full ? std::vector<int>{32, 64} : std::vector<int>{8, 16});
  checks.mesh(1.5, {0.0, 0.5, 2.0}, infinity);
  checks.mesh(1.5, {0.0, 0.5, 2.0}, 3.0);
  checks.shells(1.333, infinity);
  checks.shells(1.7, 1.5);
  checks.panel();
  if (!context.full) return checks.rows();
  checks.convergence();
  std::vector<CheckResult> rows = checks.rows();
  rows.push_back(check_caustic_picture(context));
  return rows;
}

}  // namespace vitrum
