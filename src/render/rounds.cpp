#include "render/rounds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "film/bias_fit.hpp"
#include "film/mean_square.hpp"
#include "render/sample_allocation.hpp"

namespace vitrum {
namespace {

// What a photon costs as a multiple of a camera ray, about: fixed, so that the same seed gives the same picture.
constexpr double photon_cost = 0.25, footprint_cost = 1.5;
constexpr uint64_t least_photons = 1024;   // of a round in each replicate
constexpr double largest_step = 2.0;       // of a round's cost by that before
constexpr double telling_change = 1.5;     // of the area, from which on two rounds tell the bias
constexpr size_t rounds_compared = 3;      // with a new one

using Picture = std::vector<double>;

double mean_of(const Picture& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// What a round is to do in each replicate.
struct Round {
  double half_samples = 1.0;    ///< of a pixel in each half of a pass, mean
  uint64_t photons = 0;         ///< of all its passes
  double share = 1.0;           ///< of photons.nearest that an automatic radius takes in, of all its passes
};

/// A round that later ones are compared with.
struct PastRound {
  double area;
  Picture picture;
  MeanSquare noise;
};

class Rounds {
 public:
  Rounds(const KernelContext& context, Passes& passes, Film& film, std::chrono::steady_clock::time_point start,
         Progress& progress)
      : context_(context), settings_(context.scene.render), passes_(passes), film_(film), start_(start),
        progress_(progress), width_(context.scene.film.width),
        pixels_(static_cast<size_t>(width_) * static_cast<size_t>(context.scene.film.height)),
        footprints_(context.features.footprints), variance_(pixels_, 0.0) {}

  RoundsResult run() {
    Round round;
    // As much for photons as for camera rays.
    if (passes_.has_photons())
      round.photons = std::clamp<uint64_t>(static_cast<uint64_t>(2.0 * static_cast<double>(pixels_) / cost_of_photon()),
                                           least_photons, most_photons());
    round.share = 1.0 / replicates();
    while (true) {
      const double before = elapsed();
      run_round(round);
      const double seconds = elapsed() - before;
      judge();
      if (is_over(round, seconds)) return result_;
      plan_next(round, seconds);
    }
  }

 private:
  double replicates() const { return film_.replicates(); }
  double cost_of_photon() const { return footprints_ ? footprint_cost : photon_cost; }
  double elapsed() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  double time_left() const {
    return settings_.time_limit > 0.0 ? settings_.time_limit - elapsed() : std::numeric_limits<double>::infinity();
  }

  /// Photons of a pass.
  uint64_t most_photons() const {
    return std::min(photons_in_memory, PhotonPass::capacity(context_.device, context_.features));
  }

  /// How much is done, where the present round is `within` done.
  void tell(double within) {
    double done = settings_.time_limit > 0.0 ? elapsed() / settings_.time_limit : 0.0;
    // The squared error falls as one over the cost.
    if (settings_.target_error > 0.0 && result_.rounds > 0) {
      const double ratio = settings_.target_error / std::max(result_.error.value, settings_.target_error);
      done = std::max(done, ratio * ratio * (1.0 + within));
    }
    progress_.update(std::min(done, 1.0));
  }

  /// Runs the passes of a round, and leaves its replicates' pictures in pictures_.
  void run_round(const Round& round) {
    const auto rows = static_cast<uint32_t>(std::max<uint64_t>(1, (round.photons + most_photons() - 1) / most_photons()));
    const SampleCounts counts = SampleCounts::of(allot_samples(variance_, width_, round.half_samples / rows));
    spent_ = {};
    spent_.camera_cost = replicates() * rows * 2.0 * static_cast<double>(counts.total());
    spent_.photon_cost = replicates() * static_cast<double>(round.photons) * cost_of_photon();
    const double cost = spent_.camera_cost + spent_.photon_cost;
    if (first_cost_ == 0.0) first_cost_ = cost;
    weight_ = cost / first_cost_ * (cost / first_cost_);
    weights_ += weight_;
    weighted_costs_ += weight_ * weight_ / cost;

    pictures_.assign(static_cast<size_t>(film_.replicates()), Picture(3 * pixels_, 0.0));
    scatter_.assign(pixels_, 0.0);
    round_camera_error_ = 0.0;
    for (uint32_t row = 0; row < rows; ++row)
      for (int replicate = 0; replicate < film_.replicates(); ++replicate) {
        const uint32_t done = row * static_cast<uint32_t>(film_.replicates()) + static_cast<uint32_t>(replicate);
        run_pass(round, rows, row, static_cast<uint32_t>(replicate), counts, done / (rows * replicates()));
      }
    // The next rounds go by the later, larger ones mostly.
    const double weight_of_last = result_.rounds == 0 ? 1.0 : 0.6;
    for (size_t i = 0; i < pixels_; ++i)
      variance_[i] += weight_of_last * (scatter_[i] / (replicates() * rows) - variance_[i]);
    photons_before_ += round.photons;
    samples_before_ += 2 * rows * counts.most();
    result_.rounds += 1;
    result_.samples += spent_.camera_cost / static_cast<double>(pixels_);
    round_camera_error_ /= replicates() * replicates() * rows * rows;
  }

  /// Pass `row` of a replicate's `rows`; `done` of the round is over.
  void run_pass(const Round& round, uint32_t rows, uint32_t row, uint32_t replicate, const SampleCounts& counts,
                double done) {
    const double step = 1.0 / (rows * replicates());
    const uint64_t pass = static_cast<uint64_t>(result_.passes++);
    if (passes_.has_photons()) {
      PhotonPassPlan plan;
      plan.pass = pass;
      plan.replicate = replicate;
      plan.before = photons_before_ + round.photons * row / rows;
      plan.count = round.photons * (row + 1) / rows - round.photons * row / rows;
      plan.share = round.share / rows;
      plan.samples = static_cast<int>(std::max(1.0, 2.0 * replicates() * round.half_samples));
      passes_.shoot(plan, [&](double d) { tell(done + step * 0.5 * d); });
      if (const std::vector<float> dots = passes_.dots(); !dots.empty()) film_.add(pass, "photons", 1, dots, 1.0);
    }
    HalvedPass traced = passes_.trace_halves(replicate, samples_before_ + 2 * row * counts.most(), counts,
                                             [&](double d) { tell(done + step * (0.5 + 0.5 * d)); });
    for (size_t i = 0; i < pixels_; ++i) scatter_[i] += traced.variance[i];
    round_camera_error_ += traced.error;
    for (PlaneSums& plane : traced.means) {
      if (plane.name == "radiance")
        for (size_t i = 0; i < plane.values.size(); ++i)
          if (std::isfinite(plane.values[i])) pictures_[replicate][i] += static_cast<double>(plane.values[i]) / rows;
      for (float& value : plane.values) value *= static_cast<float>(weight_ / rows);
      result_.rejected_values += film_.add(pass, plane.name, plane.channels, plane.values, weight_ / rows);
    }
  }

  /// Estimates the picture's error after a round.
  void judge() {
    const double mean = mean_of(film_.mean("radiance"));
    const double scale = mean > 0.0 ? 1.0 / (mean * mean) : 0.0;
    std::vector<Picture> all(static_cast<size_t>(film_.replicates()));
    for (int r = 0; r < film_.replicates(); ++r) {
      const FilmPlane& plane = *film_.plane("radiance", r);
      for (size_t i = 0; i < plane.sums.size(); ++i)
        all[static_cast<size_t>(r)].push_back(plane.samples_of(i) > 0.0 ? plane.sums[i] / plane.samples_of(i) : 0.0);
    }
    const MeanSquare noise = mean_square_error(all);
    RelativeError& error = result_.error;
    areas_.push_back(area_);
    round_weights_.push_back(weight_);
    if (passes_.has_photons()) compare_rounds();
    const bool tells = std::any_of(steps_.begin(), steps_.end(), [](const BiasStep& step) {
      return std::max(step.area_a, step.area_b) >= telling_change * std::min(step.area_a, step.area_b);
    });
    error.bias_known = tells || !passes_.has_photons();
    const SquaredBias bias = tells ? fit_bias(steps_, areas_, round_weights_) : SquaredBias{};
    const MeanSquare::Interval interval = noise.interval(RoundsResult::confidence);
    error.noise = std::sqrt(noise.value * scale);
    error.bias = std::sqrt(bias.value * scale);
    error.value = std::sqrt((noise.value + bias.value) * scale);
    error.low = std::sqrt((interval.low + bias.low) * scale);
    error.high = std::sqrt((interval.high + bias.high) * scale);
  }

  /// Holds the last round against those before.
  void compare_rounds() {
    PastRound now{area_, Picture(3 * pixels_, 0.0), mean_square_error(pictures_)};
    round_noise_ = now.noise.value;
    for (const Picture& replicate : pictures_)
      for (size_t i = 0; i < now.picture.size(); ++i) now.picture[i] += replicate[i] / replicates();
    for (const PastRound& past : past_) {
      double squares = 0.0, all = 0.0;
      for (size_t i = 0; i < now.picture.size(); ++i) {
        squares += std::pow(now.picture[i] - past.picture[i], 2.0);
        all += std::pow(now.picture[i], 2.0);
      }
      const double values = static_cast<double>(now.picture.size());
      const double both = now.noise.value + past.noise.value;
      // Noise of the difference itself and of what it is known by.
      const double by_chance = both * std::sqrt(2.0 / std::min(now.noise.degrees, past.noise.degrees));
      // Where there is no noise at all, values are rounded.
      const double rounding = 1e-14 * all / values + 1e-100;
      steps_.push_back({past.area, now.area, squares / values - both,
                        rounding + std::hypot(by_chance, now.noise.deviation(), past.noise.deviation())});
    }
    past_.push_back(std::move(now));
    if (past_.size() <= rounds_compared) return;
    // What the first rounds were off says little of the last; but one of another area must stay.
    const bool is_needed = past_[1].area < telling_change * past_.back().area;
    past_.erase(past_.begin() + (is_needed ? 1 : 0));
    std::erase_if(steps_, [oldest = past_.front().area](const BiasStep& step) { return step.area_a > oldest; });
  }

  bool is_over(const Round& round, double seconds_of_round) {
    const RelativeError& error = result_.error;
    if (settings_.target_error > 0.0 && error.bias_known && error.value <= settings_.target_error) {
      result_.end = RoundsResult::End::target;
      return true;
    }
    // A round of a quarter of the cost gains next to nothing.
    if (time_left() < 0.25 * seconds_of_round) {
      result_.end = RoundsResult::End::time;
      return true;
    }
    if (settings_.target_error > 0.0 && footprints_ && round.photons == most_photons() &&
        error.bias > settings_.target_error) {
      result_.end = RoundsResult::End::footprints;
      return true;
    }
    return false;
  }

  /// How much dearer than the last round the next is to be.
  double step_of_cost(double seconds_of_round) const {
    double step = largest_step;
    const double last = spent_.camera_cost + spent_.photon_cost;
    if (settings_.target_error > 0.0 && result_.error.bias_known)
      for (double smaller = 1.0; smaller < step; smaller += 0.05) {
        // Weighted by the squares of their costs, rounds whose squared errors go as one over their costs.
        const double weight = std::pow(smaller * last / first_cost_, 2.0);
        const double next = (weighted_costs_ + weight * weight / (smaller * last)) / std::pow(weights_ + weight, 2.0);
        const double ratio = next / (weighted_costs_ / (weights_ * weights_));
        const double reach = 0.95 * settings_.target_error;
        if (result_.error.value * result_.error.value * ratio <= reach * reach) step = smaller;
      }
    return std::min(step, 0.9 * time_left() / seconds_of_round);
  }

  void plan_next(Round& round, double seconds_of_round) {
    const bool tells = passes_.has_photons() && result_.error.bias_known;
    SquaredBias bias;           // of the last round
    if (tells) bias = fit_bias(steps_, std::span(areas_).last(1), std::span(round_weights_).last(1));
    if (passes_.has_photons()) {
      spent_.photon_error = std::max(round_noise_ - round_camera_error_, 0.0) + bias.value;
      spent_.camera_error = round_camera_error_;
    }
    const double step = step_of_cost(seconds_of_round);
    // Until the bias is known, as before.
    const Growth growth = result_.error.bias_known ? best_growth(spent_, step) : Growth{step, step};
    round.half_samples = std::max(0.5, round.half_samples * growth.samples);
    if (!passes_.has_photons()) return;
    auto photons = static_cast<uint64_t>(static_cast<double>(round.photons) * growth.photons);
    photons = std::max(photons, least_photons);
    // Those of another pass would be no smaller.
    if (footprints_) photons = std::min(photons, most_photons());
    const double more = static_cast<double>(photons) / static_cast<double>(round.photons);
    round.photons = photons;
    if (footprints_) {
      area_ /= more;
      return;
    }
    // The noise N goes as one over the number of photons and the area A that an estimate takes in, that of camera rays too,
    // which find smaller spots by chance; the squared bias B goes as A^(2 c). N / A + B A^(2 c) is least where
    // A^(2 c + 1) = N / (2 c B). The photons in an estimate do not become fewer.
    double area = 1.0 / more;
    if (tells) {
      const double noise = round_noise_ / more;
      const double power = 1.0 / (2.0 * bias.exponent + 1.0);
      area = bias.value > 0.0 ? std::pow(noise / (2.0 * bias.exponent * bias.value), power) : 1.0;
      area = std::clamp(area, std::min(1.0, 1.0 / more), 1.0);
    }
    round.share *= area * more;
    area_ *= area;
  }

  KernelContext context_;
  const RenderSettings& settings_;
  Passes& passes_;
  Film& film_;
  std::chrono::steady_clock::time_point start_;
  Progress& progress_;
  int width_;
  size_t pixels_;
  bool footprints_;
  std::vector<double> variance_;        ///< of a sample, by pixel
  std::vector<double> scatter_;         ///< the same, summed over the passes of the round
  std::vector<Picture> pictures_;       ///< of the round, by replicate
  double round_camera_error_ = 0.0, round_noise_ = 0.0;  ///< squares, of the round's mean
  Spending spent_;                      ///< by the round
  double first_cost_ = 0.0, weight_ = 0.0, weights_ = 0.0, weighted_costs_ = 0.0;
  uint64_t photons_before_ = 0;         ///< of each replicate
  uint32_t samples_before_ = 0;
  double area_ = 1.0;                   ///< that an estimate takes in, over that of the first round
  std::vector<double> areas_, round_weights_;  ///< by round
  std::vector<PastRound> past_;
  std::vector<BiasStep> steps_;
  RoundsResult result_;
};

}  // namespace

RoundsResult run_rounds(const KernelContext& context, Passes& passes, Film& film,
                        std::chrono::steady_clock::time_point start, Progress& progress) {
  return Rounds(context, passes, film, start, progress).run();
}

}  // namespace vitrum
