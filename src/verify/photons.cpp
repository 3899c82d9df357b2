// Photons by themselves: what becomes of their power, and where it lands, against integrals over the ball.

#include <cmath>
#include <limits>
#include <numbers>

#include "film/statistics.hpp"
#include "reference/ball_caustic.hpp"
#include "verify/groups.hpp"
#include "verify/photon_run.hpp"
#include "verify/scenes.hpp"

namespace vitrum {
namespace {

constexpr double pi = std::numbers::pi;
constexpr uint32_t replicates = 32;         // random shifts of the low-discrepancy points; their spread is the error
constexpr double false_alarm = 1e-4;        // of each row, over all its estimates
// Powers and positions are floats: what cannot be told from the truth, of the whole.
constexpr double rounding = 2e-6;

/// Hemispherical reflectance of index n from outside: the share of a parallel beam that a ball reflects at once.
/// Dunkle's closed form of 2 int R(theta) sin theta cos theta dtheta, as in Duntley 1942.
double hemispherical_reflectance(double n) {
  const double n2 = n * n, n4 = n2 * n2;
  return 0.5 + (n - 1) * (3 * n + 1) / (6 * (n + 1) * (n + 1)) +
         n2 * (n2 - 1) * (n2 - 1) / ((n2 + 1) * (n2 + 1) * (n2 + 1)) * std::log((n - 1) / (n + 1)) -
         2 * n2 * n * (n2 + 2 * n - 1) / ((n2 + 1) * (n4 - 1)) +
         8 * n4 * (n4 + 1) / ((n2 + 1) * (n4 - 1) * (n4 - 1)) * std::log(n);
}

/// Several estimates by all replicates, each with its truth, tested together.
class Estimates {
 public:
  /// `values`: one of each replicate.
  void add(const std::vector<double>& values, double truth, const std::string& what) {
    double sum = 0.0, squares = 0.0;
    for (const double value : values) sum += value;
    const double mean = sum / replicates;
    for (const double value : values) squares += (value - mean) * (value - mean);
    const double error = std::sqrt(squares / (replicates - 1) / replicates);
    const double beyond = std::max(std::abs(mean - truth) - rounding, std::isnan(mean) ? NAN : 0.0);
    const double t = beyond == 0.0 ? 0.0 : beyond / error;
    if (t > worst_.error || worst_.cases == 0)
      where_ = what + printed(": found %.9f +- %.1e, truth %.9f", mean, error, truth);
    worst_.add(t, worst_.cases);
    largest_error_ = std::max(largest_error_, std::isnan(error) ? std::numeric_limits<double>::infinity() : error);
  }

  /// A row that tests significance, and one that shows how small a fault the test could see: the error is at most that
  /// of as many independent photons that are stored or not by the toss of a coin.
  void rows(const std::string& name, const char* truth, uint64_t photons, std::vector<CheckResult>& rows) const {
    rows.push_back({name, worst_.cases, worst_.error,
                    student_limit(sidak_level(false_alarm, worst_.cases), replicates - 1), "standard errors", truth, where_});
    rows.push_back({name + ": error", worst_.cases, largest_error_, 0.5 / std::sqrt(static_cast<double>(photons)),
                    "of the whole", "standard error of independent photons", ""});
  }

 private:
  Worst worst_;
  std::string where_;
  double largest_error_ = 0.0;
};

/// A ball of radius 1 around the origin above a black plane at y = -2. Its light has a power of 1 W.
Scene ball_over_plane(double index, const Spectrum& sigma_a, double light_distance) {
  Scene scene = {};
  scene.film.width = scene.film.height = 4;
  scene.camera = {CameraType::pinhole, {0, 3, 8}, {0, 0, 0}, {0, 1, 0}, 45.0};
  scene.materials.push_back(glass(index));
  scene.materials[0].absorption = sigma_a;
  scene.materials.push_back(surface(Surface::opaque, 0.5));
  add(scene, Sphere{{0, 0, 0}, 1.0}, 0);
  add(scene, Plane{{0, -2, 0}, {0, 1, 0}, {}, {}}, 1);
  if (std::isinf(light_distance))
    scene.lights.push_back({"sun", {}, DirectionalLight{{0, -1, 0}, Spectrum(1 / pi)}});
  else
    scene.lights.push_back({"lamp", {}, PointLight{{0, light_distance, 0}, Spectrum(1 / (4 * pi))}});
  scene.photons.estimate = PhotonEstimate::fixed_radius;
  scene.photons.radius = 0.05;
  scene.photons.max_depth = 31;
  return scene;
}

/// Everything that one kind of light is checked for.
class PhotonChecks {
 public:
  PhotonChecks(const CheckContext& context, uint64_t count) : context_(context), count_(count) {}

  void run(double index, const Spectrum& sigma_a, double light_distance) {
    Scene scene = ball_over_plane(index, sigma_a, light_distance);
    scene.render.seed = runs_++;
    const std::string what = printed("n = %g, light at %g m", index, light_distance);
    PhotonRun photon_run(scene, context_.device, count_, context_.kernels);
    PhotonBalance before;
    constexpr double radii[] = {0.1, 0.2, 0.5, 1.0};
    std::vector<double> absorbed[3], stored[3], within[4][3];
    for (uint32_t replicate = 0; replicate < replicates; ++replicate) {
      const std::vector<cl_float8> photons = photon_run.shoot(replicate, count_);
      const PhotonBalance after = photon_run.balance();
      double sums[4][3] = {};
      for (const cl_float8& p : photons)
        for (int k = 3; k >= 0 && std::hypot(p.s[0], p.s[2]) <= radii[k]; --k)
          for (int c = 0; c < 3; ++c) sums[k][c] += p.s[4 + c];
      for (int c = 0; c < 3; ++c) {
        const auto power = [&](Spectrum PhotonBalance::*term) { return (after.*term)[c] - (before.*term)[c]; };
        absorbed[c].push_back(power(&PhotonBalance::absorbed));
        stored[c].push_back(power(&PhotonBalance::stored));
        for (int k = 0; k < 4; ++k) within[k][c].push_back(sums[k][c]);
        const double shot = power(&PhotonBalance::shot);
        const double ends = power(&PhotonBalance::stored) + power(&PhotonBalance::absorbed) + power(&PhotonBalance::direct) +
                            power(&PhotonBalance::lost) + power(&PhotonBalance::cut);
        const double error = std::abs(ends / shot - 1);
        if (error > balance_.error) where_ = what + printed(", channel %d, replicate %u", c, replicate);
        balance_.add(error, balance_.cases);
      }
      before = after;
    }
    for (int c = 0; c < 3; ++c) {
      const reference::BallOnAxis ball{1.0, index, sigma_a[c], 2.0, light_distance};
      const std::string channel = what + printed(", sigma_a = %g", sigma_a[c]);
      // Where it is opaque, all that is not reflected is absorbed: closed form.
      if (sigma_a[c] > 1e3 && std::isinf(light_distance))
        reflected_.add(absorbed[c], 1 - hemispherical_reflectance(index), channel);
      else
        absorbed_.add(absorbed[c], reference::absorbed_flux(ball), channel);
      for (int k = 0; k < 4; ++k)
        encircled_.add(within[k][c], reference::encircled_flux(ball, radii[k], reference::Orders::all),
                       channel + printed(", r < %g m", radii[k]));
      encircled_.add(stored[c],
                     reference::encircled_flux(ball, std::numeric_limits<double>::infinity(), reference::Orders::all),
                     channel + ", all of the plane");
    }
  }

  std::vector<CheckResult> rows() const {
    std::vector<CheckResult> rows;
    rows.push_back({"photons/conservation", balance_.cases, balance_.error, 1e-6, "relative",
                    "shot = stored + absorbed + direct + lost + cut", where_});
    const uint64_t photons = replicates * count_;
    absorbed_.rows("photons/absorbed in a ball", "2 int T(1-tau)/(1-R tau) sin cos dtheta, quadrature", photons, rows);
    reflected_.rows("photons/reflected by a ball", "hemispherical reflectance, closed form", photons, rows);
    encircled_.rows("photons/encircled flux", "the ball's caustic by quadrature, all orders", photons, rows);
    return rows;
  }

 private:
  const CheckContext& context_;
  uint64_t count_, runs_ = 0;
  Worst balance_;
  std::string where_;
  Estimates absorbed_, reflected_, encircled_;
};

}  // namespace

std::vector<CheckResult> check_photons(const CheckContext& context) {
  PhotonChecks checks(context, context.full ? 2'000'000 : 50'000);
  constexpr double beam = std::numeric_limits<double>::infinity();
  for (const double index : {1.333, 1.5, 2.4}) {
    checks.run(index, {0.1, 1.0, 1e6}, beam);
    checks.run(index, {0.0, 0.5, 2.0}, beam);
    checks.run(index, {0.0, 0.5, 2.0}, 3.0);
  }
  return checks.rows();
}

}  // namespace vitrum
