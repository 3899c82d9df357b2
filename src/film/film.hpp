#pragma once
// The film: what all passes have given so far, as sums in named planes, kept apart by replicate.

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace vitrum {

/// One quantity over the picture, in one replicate: sums over samples, in double, and how many samples they hold.
/// The mean of value i is sums[i] / samples_of(i).
struct FilmPlane {
  std::string name;              ///< "radiance", "caustics", "normal", ...
  int channels = 3;
  double samples = 0;            ///< weight of what was added
  std::vector<double> sums;      ///< width * height * channels, interleaved, row 0 at the top
  std::map<std::size_t, double> rejected;  ///< samples that a value of `sums` lacks, by its index, where it lacks any

  /// Weight of what `sums[i]` holds.
  double samples_of(std::size_t i) const {
    if (rejected.empty()) return samples;
    const auto found = rejected.find(i);
    return found == rejected.end() ? samples : samples - found->second;
  }
};

/// A film of a fixed size. Pass p belongs to replicate p mod replicates: the replicates are independent estimates of
/// the same picture, so that their scatter tells its variance.
class Film {
 public:
  static constexpr int max_replicates = 8;

  /// A black film. `width`, `height` >= 1 [pixels], `replicates` in 1..max_replicates.
  Film(int width, int height, int replicates = max_replicates);

  int width() const { return width_; }
  int height() const { return height_; }
  int replicates() const { return static_cast<int>(planes_.size()); }

  /// Adds what pass `pass` gave to the plane `name`, which is made if it is new: `values` are sums over `samples`
  /// samples (> 0), width * height * channels of them. A plane has the same channels in all passes. A value that is not
  /// finite is rejected: its samples do not count in the mean. Returns how many were, none being expected.
  uint64_t add(uint64_t pass, const std::string& name, int channels, std::span<const float> values, double samples);

  /// Names of all planes that any pass has added to, in the order of the alphabet.
  std::vector<std::string> names() const;

  /// The plane of one replicate; nullptr if no pass of it has added to the plane.
  const FilmPlane* plane(const std::string& name, int replicate) const;

  /// Mean over all samples of all replicates; NaN where all were rejected; empty if there is no such plane.
  std::vector<double> mean(const std::string& name) const;

  /// Estimated variance of `mean`, by value, from the scatter of the replicates' means m_r with their shares w_r of the
  /// samples: sum w_r^2 (m_r - mean)^2 / (1 - w_r). Unbiased where the variance of m_r goes as 1 / w_r, and nearly so
  /// where it is the same for all, as photons make it: HC2 of MacKinnon and White, J. Econometrics 29 (1985). Empty if
  /// fewer than 2 replicates have samples; NaN where fewer than 2 have any of a value.
  std::vector<double> variance_of_mean(const std::string& name) const;

  /// Adds another film of the same size and number of replicates, replicate by replicate. It must hold other passes.
  /// Throws Error if size, replicates or the channels of a plane differ; then this film is as it was.
  void merge(const Film& other);

 private:
  std::size_t values_of(int channels) const;
  /// The plane in those replicates that have it.
  std::vector<const FilmPlane*> parts(const std::string& name) const;

  int width_, height_;
  std::vector<std::map<std::string, FilmPlane>> planes_;  ///< by replicate and name
};

}  // namespace vitrum
