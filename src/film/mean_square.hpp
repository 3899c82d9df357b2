#pragma once
// How far a picture as a whole is from what it would be without chance, told by its replicates.

#include <span>
#include <vector>

namespace vitrum {

/// Mean squared error of a picture: that of the mean of independent replicates of it, over all values.
struct MeanSquare {
  double value = 0.0;           ///< unbiased estimate
  /// Degrees of freedom of a chi-squared variable that is spread as the squared error of one picture: many where pixels err
  /// each by itself, few where they share what makes them err.
  double degrees = 1.0;
  double estimate_degrees = 1.0;  ///< and as the estimate: by so many replicates, less one, more

  /// Standard deviation of the estimate.
  double deviation() const;
  /// The squared error itself lies between these in a `share` of all cases, share in (0, 1), as likely above as below: by
  /// Fisher's distribution of its ratio to the estimate, for errors that are about normal.
  struct Interval { double low, high; };
  Interval interval(double share) const;
};

/// Of the mean of at least 3 replicates of equal size, each all values of a picture. The covariance C of a replicate has
/// tr C by their scatter, and tr C^2, which the degrees (tr C)^2 / tr C^2 hang on, by their products, without bias for
/// normal errors (Bai and Saranadasa, "Effect of high dimension", Statistica Sinica 6, 1996), and taken twice, to be safe.
/// `replicates` have the same number of values, at least 1.
MeanSquare mean_square_error(const std::vector<std::vector<double>>& replicates);

}  // namespace vitrum
