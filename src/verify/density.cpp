// The density estimate: irradiance from the photons around a place. Its mean, its bias with the radius, its noise with
// the number of photons, and a radius that shrinks from pass to pass, with independent photons against theory.

#include <cmath>
#include <numbers>
#include <numeric>

#include "verify/estimates.hpp"
#include "verify/gatherer.hpp"
#include "verify/groups.hpp"
#include "verify/patch_pictures.hpp"
#include "verify/photon_run.hpp"
#include "verify/scenes.hpp"

namespace vitrum {
namespace {

constexpr double pi = std::numbers::pi;
// What floats may take a sum of photons off the truth, relative.
constexpr double rounding = 2e-6;

// A lamp over a ball of air: photons spread evenly over a cone of directions, in which the plane has the lamp's
// irradiance.
constexpr double lamp_distance = 1.25;            // from the ball's centre [m]
constexpr double height = lamp_distance + 2.0;    // of the lamp above the plane [m]
constexpr double cone_power = 0.5 * (1.0 - 0.6);  // of the lamp's 1 W: the ball fills a cone of cosine .6
constexpr double reach = 0.95 * height;           // places are so far from the axis; the cone ends at 4/3 of the height

Scene lamp_over_plane(double radius) {
  // The other channels only give it the features of the group `photons`, so that kernels are compiled once for both.
  Scene scene = ball_over_plane(1.0, {0.0, 0.5, 2.0}, lamp_distance);
  scene.photons.sampling = Sampling::independent;
  scene.photons.radius = radius;
  return scene;
}

/// Irradiance [W/m2] of the plane at a distance from the axis, its Laplacian, and the Laplacian of that.
struct Irradiance {
  double value, laplacian, bilaplacian;

  explicit Irradiance(double distance) {
    // I h s^(-3/2) with s = h^2 + r^2. In the plane, s^-k has the Laplacian 4 k^2 s^(-k-1) - 4 k (k + 1) h^2 s^(-k-2).
    constexpr double h2 = height * height;
    const double s = h2 + distance * distance, scale = height / (4.0 * pi);
    const auto laplacian_of = [&](double k) {
      return 4 * k * k * std::pow(s, -k - 1) - 4 * k * (k + 1) * h2 * std::pow(s, -k - 2);
    };
    value = scale * std::pow(s, -1.5);
    laplacian = scale * laplacian_of(1.5);
    bilaplacian = scale * (9 * laplacian_of(2.5) - 15 * h2 * laplacian_of(3.5));
  }

  /// Convolved with Epanechnikov's kernel 2 / (pi r^2) (1 - d^2 / r^2), by its moments: what is left out is of order
  /// r^6, 1.4e-5 of the value at a fifth of the height.
  double convolved(double radius) const {
    const double r2 = radius * radius;
    return value + r2 / 12 * laplacian + r2 * r2 / 384 * bilaplacian;
  }

  /// Variance of an estimate by `count` independent photons of the same power: that times the convolution with the
  /// kernel's square, by its moments, less the square of the mean over the count.
  double variance(double radius, double count) const {
    const double r2 = radius * radius, mean = convolved(radius);
    return cone_power / count * 4 / (3 * pi * r2) * (value + r2 / 16 * laplacian) - mean * mean / count;
  }
};

/// Photons on the plane, and what is gathered from them at places that lie evenly around the axis.
class Gathering {
 public:
  std::vector<Irradiance> truth;  ///< at each place

  Gathering(const CheckContext& context, const Scene& scene, uint32_t places, uint64_t count)
      : device_(context.device),
        shot_(with_fixed_radius(scene)),
        run_(shot_, context.device, context.kernels),
        kernel_(gather_kernel(device_, context.kernels, scene_features(scene))),
        scene_(scene),
        count_(count) {
    std::vector<Query> queries;
    for (uint32_t k = 0; k < places; ++k) {
      // Vogel's spiral.
      const double r = reach * std::sqrt((k + 0.5) / places), phi = k * pi * (3.0 - std::sqrt(5.0));
      queries.push_back({glm::vec3(glm::dvec3(r * std::cos(phi), -2.0, r * std::sin(phi))), {0, 1, 0}});
      truth.emplace_back(r);
    }
    queries_ = placed_queries(device_, queries);
  }

  /// Irradiance at each place by pass `pass` of `replicate` [W/m2].
  std::vector<double> irradiance(uint32_t replicate, uint64_t pass = 0) {
    run_.run(pass, replicate, pass * count_, count_);
    const bool nearest = scene_.photons.estimate == PhotonEstimate::nearest;
    if (nearest) fill_photon_tree(device_, tree_, read_photons(device_, run_.map()), scene_.photons.max_radius);
    gather(device_, kernel_, nearest ? tree_ : run_.map(), scene_, queries_);
    std::vector<double> red;
    for (const glm::vec3& found : irradiance_of(device_, queries_)) red.push_back(static_cast<double>(found.x));
    return red;
  }

  /// The mean over the places of what `value` says of each.
  template <typename Value>
  double mean(const Value& value) const {
    double sum = 0.0;
    for (size_t k = 0; k < truth.size(); ++k) sum += value(k);
    return sum / static_cast<double>(truth.size());
  }

 private:
  /// The k nearest are looked for among the same photons, so that the kernels that shoot them are compiled once.
  static Scene with_fixed_radius(Scene scene) {
    scene.photons.estimate = PhotonEstimate::fixed_radius;
    return scene;
  }

  Device& device_;
  Scene shot_;
  PhotonRun run_;
  PhotonMap tree_;
  cl::Kernel kernel_;
  const Scene& scene_;
  uint64_t count_;
  PlacedQueries queries_;
};

/// The bias of `values` as a multiple of `expected` at each place, weighted by that.
template <typename Value>
double share_of_bias(const Gathering& gathering, const std::vector<double>& values, const Value& expected) {
  return gathering.mean([&](size_t k) { return expected(k) * (values[k] - gathering.truth[k].value); }) /
         gathering.mean([&](size_t k) { return expected(k) * expected(k); });
}

uint32_t replicates_of(const CheckContext& context) { return context.full ? 192 : 48; }

constexpr const char* blunt = "standard error of the estimates";

/// Many estimates from few photons each: their mean is the convolution, and their scatter goes by the number of
/// photons.
void check_noise(const CheckContext& context, Estimates& unbiased, std::vector<CheckResult>& rows) {
  const uint32_t replicates = replicates_of(context), places = 4096;
  constexpr double radius = 0.0125 * height;
  const Scene scene = lamp_over_plane(radius);
  Estimates noise;
  std::vector<double> all(replicates, 0.0);
  std::vector<std::pair<double, double>> curve;
  const uint64_t least = context.full ? 32'000 : 8'000;
  const std::vector<uint64_t> counts = {least, 2 * least, 4 * least};
  for (const uint64_t count : counts) {
    Gathering gathering(context, scene, places, count);
    std::vector<double> means, squares;
    for (uint32_t replicate = 0; replicate < replicates; ++replicate) {
      const std::vector<double> values = gathering.irradiance(replicate);
      means.push_back(gathering.mean([&](size_t k) { return values[k] / gathering.truth[k].convolved(radius); }));
      squares.push_back(gathering.mean([&](size_t k) {
        const double off = values[k] - gathering.truth[k].convolved(radius);
        return off * off / gathering.truth[k].variance(radius, static_cast<double>(count));
      }));
      all[replicate] += squares.back() / static_cast<double>(counts.size());
    }
    const std::string what = printed("%llu photons, radius %g m", static_cast<unsigned long long>(count), radius);
    unbiased.add(means, 1.0, rounding, what);
    noise.add(squares, 1.0, rounding, what);
    const Irradiance axis(0.0);
    const double n = static_cast<double>(count);
    const double scatter = std::accumulate(squares.begin(), squares.end(), 0.0) / replicates;
    curve.emplace_back(axis.value * pi * radius * radius * n / cone_power,
                       std::sqrt(scatter * axis.variance(radius, n)) / axis.value);
  }
  noise.add(all, 1.0, rounding, "all numbers of photons");
  const size_t first = rows.size();
  noise.rows("density/noise with count", "variance over 4/(3 k) E^2 and its terms of higher order",
             context.full ? 0.003 : 0.01, "of the variance", blunt, rows);
  rows[first].plots.push_back({"Noise of an estimate of irradiance, independent photons", "photons within the radius",
                               "noise, relative", {{"vitrum", curve}}, true, true});
}

/// Many photons within wide radii: the bias is the kernel's second moment times the Laplacian.
void check_bias(const CheckContext& context, Estimates& unbiased, std::vector<CheckResult>& rows) {
  const uint32_t replicates = replicates_of(context);
  const uint64_t count = context.full ? 1'000'000 : 80'000;
  Estimates bias;
  std::vector<std::pair<double, double>> curve;
  for (const double radius : {0.14 * height, 0.2 * height}) {
    const Scene scene = lamp_over_plane(radius);
    Gathering gathering(context, scene, 1024, count);
    const auto expected = [&](size_t k) { return gathering.truth[k].convolved(radius) - gathering.truth[k].value; };
    std::vector<double> means, shares;
    for (uint32_t replicate = 0; replicate < replicates; ++replicate) {
      const std::vector<double> values = gathering.irradiance(replicate);
      means.push_back(gathering.mean([&](size_t k) { return values[k] / gathering.truth[k].convolved(radius); }));
      shares.push_back(share_of_bias(gathering, values, expected));
    }
    const std::string what = printed("%llu photons, radius %g m", static_cast<unsigned long long>(count), radius);
    unbiased.add(means, 1.0, rounding, what);
    bias.add(shares, 1.0, 1e-3, what);  // the series ends at r^4: up to 7e-4 of the bias
    curve.emplace_back(radius, std::abs(Irradiance(0.0).convolved(radius) / Irradiance(0.0).value - 1) *
                                   std::accumulate(shares.begin(), shares.end(), 0.0) / replicates);
  }
  const size_t first = rows.size();
  bias.rows("density/bias with radius", "r^2 lap(E) / 12 + r^4 lap(lap(E)) / 384", context.full ? 0.02 : 0.2,
            "of the bias", blunt, rows);
  rows[first].plots.push_back({"Bias of an estimate of irradiance by its radius", "radius [m]", "bias, relative",
                               {{"vitrum", curve}}, true, true});
}

/// Bias of the mean over passes whose radius shrinks.
void check_progressive(const CheckContext& context, std::vector<CheckResult>& rows) {
  const uint32_t replicates = replicates_of(context);
  const uint64_t passes = context.full ? 64 : 4, count = 20'000;
  Scene scene = lamp_over_plane(0.2 * height);
  scene.photons.progressive = true;
  Gathering gathering(context, scene, 1024, count);
  std::vector<double> expected(gathering.truth.size(), 0.0), shares;
  double area = 1.0;            // as a multiple of the first pass's
  for (uint64_t pass = 0; pass < passes; ++pass) {
    for (size_t k = 0; k < expected.size(); ++k)
      expected[k] += (gathering.truth[k].convolved(scene.photons.radius * std::sqrt(area)) - gathering.truth[k].value) /
                     static_cast<double>(passes);
    const double i = static_cast<double>(pass + 1);
    area *= (i + 2.0 / 3.0) / (i + 1.0);
  }
  for (uint32_t replicate = 0; replicate < replicates; ++replicate) {
    std::vector<double> mean(expected.size(), 0.0);
    for (uint64_t pass = 0; pass < passes; ++pass) {
      const std::vector<double> values = gathering.irradiance(replicate, pass);
      for (size_t k = 0; k < mean.size(); ++k) mean[k] += values[k] / static_cast<double>(passes);
    }
    shares.push_back(share_of_bias(gathering, mean, [&](size_t k) { return expected[k]; }));
  }
  Estimates bias;
  bias.add(shares, 1.0, 1e-3, printed("%llu passes", static_cast<unsigned long long>(passes)));
  bias.rows("density/progressive: bias", "r_(i+1)^2 / r_i^2 = (i + 2/3) / (i + 1)", context.full ? 0.05 : 0.2,
            "of the bias", blunt, rows);
}

/// Mean squared error of the mean over passes, where the noise is most of it: a fixed radius would give -1. The first
/// passes are left out: theory's own exponent over passes 16 to 128 is -.69, from there to 1024 it is -.67.
void check_slope(const CheckContext& context, std::vector<CheckResult>& rows) {
  const uint32_t replicates = context.full ? 16 : 8;
  const uint64_t first = 16, passes = context.full ? 1024 : 128;
  Scene scene = lamp_over_plane(0.05 * height);
  scene.photons.progressive = true;
  Gathering gathering(context, scene, 1024, 4000);
  std::vector<std::pair<double, double>> errors;  // by number of passes
  for (uint64_t n = first; n <= passes; n *= 2) errors.emplace_back(static_cast<double>(n), 0.0);
  for (uint32_t replicate = 0; replicate < replicates; ++replicate) {
    std::vector<double> sum(gathering.truth.size(), 0.0);
    auto next = errors.begin();
    for (uint64_t pass = 0; pass < passes; ++pass) {
      const std::vector<double> values = gathering.irradiance(replicate, pass);
      for (size_t k = 0; k < sum.size(); ++k) sum[k] += values[k];
      if (static_cast<double>(pass + 1) != next->first) continue;
      next->second += gathering.mean([&](size_t k) {
        const double off = sum[k] / next->first / gathering.truth[k].value - 1;
        return off * off / replicates;
      });
      ++next;
    }
  }
  const double slope = fitted_exponent(errors);
  rows.push_back({"density/progressive: slope", errors.size(), std::abs(slope + 2.0 / 3.0), 0.05, "of the exponent",
                  "mean squared error ~ passes^(-2/3), Knaus and Zwicker 2011", printed("slope %.4f", slope),
                  {{"Error over passes with a radius that shrinks", "passes", "mean squared error, relative",
                    {{"vitrum", errors}}, true, true}}});
}

/// The k nearest of n photons. The share of the light within their circle is the k-th of n even numbers: distributed as
/// Beta(k, n - k + 1). By the moments of its inverse the estimate k Phi / (n pi r_k^2) is k / (k - 1) of an even
/// irradiance, and has the variance below. In the circle of a curved irradiance E are pi r^2 (E + r^2 lap(E) / 8), to
/// the next order, which adds k Phi lap(E) / (8 pi n E) to the mean and nothing to the variance.
void check_nearest(const CheckContext& context, std::vector<CheckResult>& rows) {
  const uint32_t replicates = replicates_of(context);
  constexpr double series = 5e-6;  // the next order of the curvature where 320 circles hold all photons
  Estimates mean, noise;
  for (const int nearest : {10, 50}) {
    const uint64_t count = (context.full ? 1600u : 320u) * static_cast<uint64_t>(nearest);
    const double k = nearest, n = static_cast<double>(count);
    Scene scene = lamp_over_plane(0.01);
    scene.photons.estimate = PhotonEstimate::nearest;
    scene.photons.nearest = nearest;
    scene.photons.max_radius = height;
    Gathering gathering(context, scene, context.full ? 4096 : 1024, count);
    std::vector<double> expected;
    for (const Irradiance& truth : gathering.truth)
      expected.push_back(k / (k - 1) * truth.value + k * cone_power * truth.laplacian / (8 * pi * n * truth.value));
    const double variance = k * k / ((k - 1) * (k - 1) * (k - 2)) * (1 - (k - 1) / n);  // of the irradiance's square
    std::vector<double> means, squares;
    for (uint32_t replicate = 0; replicate < replicates; ++replicate) {
      const std::vector<double> values = gathering.irradiance(replicate);
      means.push_back(gathering.mean([&](size_t i) { return values[i] / expected[i]; }));
      squares.push_back(gathering.mean([&](size_t i) {
        const double off = (values[i] - expected[i]) / gathering.truth[i].value;
        return off * off / variance;
      }));
    }
    const std::string what = printed("%d nearest of %llu photons", nearest, static_cast<unsigned long long>(count));
    mean.add(means, 1.0, rounding + series, what);
    noise.add(squares, 1.0, rounding + series, what);
  }
  mean.rows("density/k nearest", "k / (k - 1) of the irradiance, Beta(k, n - k + 1)", context.full ? 6e-4 : 2.5e-3,
            "relative", blunt, rows);
  noise.rows("density/k nearest: noise", "variance k^2 / ((k - 1)^2 (k - 2)) (1 - (k - 1) / n) E^2",
             context.full ? 0.005 : 0.02, "of the variance", blunt, rows);
}

}  // namespace

std::vector<CheckResult> check_density(const CheckContext& context) {
  Estimates unbiased;
  std::vector<CheckResult> others, rows;
  check_noise(context, unbiased, others);
  check_bias(context, unbiased, others);
  check_progressive(context, others);
  check_slope(context, others);
  check_nearest(context, others);
  unbiased.rows("density/unbiased", "irradiance convolved with Epanechnikov's kernel", context.full ? 8e-4 : 2.5e-3,
                "relative", blunt, rows);
  rows.insert(rows.end(), others.begin(), others.end());
  for (CheckResult& row : check_patches(context)) rows.push_back(std::move(row));
  return rows;
}

}  // namespace vitrum
