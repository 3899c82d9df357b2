#pragma once
// What `vitrum compare` finds: by view, with the limits that the user sets it, as text and as JSON.

#include <optional>
#include <string>
#include <vector>

#include "film/images.hpp"
#include "film/metrics.hpp"

namespace vitrum {

/// A picture that is compared, and the file that it was read from.
struct NamedPicture {
  std::string file;
  LayeredPicture picture;

  /// nullptr if there is no such layer.
  const PictureLayer* layer(const std::string& name) const;
};

struct ComparisonSettings {
  double epsilon = default_epsilon;         ///< of the relative error, in units of a value's square
  double alpha = 1e-3;                      ///< chance of a false alarm of the z-test
  double degrees = 7;                       ///< of freedom of the error estimates
};

/// The name of the layer that holds the standard errors of the beauty's values.
constexpr const char* error_layer = "error";

struct ViewComparison {
  std::string name;
  int channels = 3;
  bool is_colour = true;
  PictureError error;                       ///< of A, with B as the truth
  float largest_a = 0, largest_b = 0;       ///< the two values whose difference is the largest
  uint64_t not_finite_a = 0, not_finite_b = 0;  ///< pixels
  std::optional<ZTest> z_test;              ///< for the beauty, if both pictures have an error layer
  std::optional<PictureError> a_to_reference, b_to_reference;

  /// Whether there are pixels that no threshold lets pass: a NaN; an infinity in one picture only, or in a colour.
  /// Where data are infinite in both, such as the depth of the sky, they agree.
  bool has_faults() const;
};

struct Comparison {
  std::string a, b, reference;              ///< files; "" if there is no reference
  int width = 0, height = 0;
  ComparisonSettings settings;
  std::vector<ViewComparison> views;
};

/// Compares the views `wanted`, or, if none are, all that the pictures have in common but the error layer. `reference`
/// may be nullptr. Throws Error at a picture's file if its size is another than A's or a layer is missing.
Comparison compare_pictures(const NamedPicture& a, const NamedPicture& b, const NamedPicture* reference,
                            const std::vector<std::string>& wanted, const ComparisonSettings& settings);

/// A number that --threshold can limit.
struct Measure {
  std::string name, meaning;
  double (*value)(const ViewComparison& view);
  bool is_p_value = false;                  ///< is exceeded by what is less than the limit

  /// Only the beauty has the p-value, and only where both pictures tell their errors.
  bool applies_to(const ViewComparison& view) const { return !is_p_value || view.z_test.has_value(); }
};
const std::vector<Measure>& measures();

struct Threshold {
  const Measure* measure = nullptr;
  double limit = 0.0;
  std::string text;                         ///< as the user wrote it
};

/// The threshold of "NAME=VALUE". Throws Error at "--threshold NAME=VALUE".
Threshold threshold_of(const std::string& text);

/// What became of a threshold in a view.
struct Verdict {
  const Threshold* threshold = nullptr;
  const ViewComparison* view = nullptr;
  double value = 0.0;
  bool is_exceeded = false;                 ///< also by a value that is NaN, and in a view that has faults
};

/// Holds all views against all thresholds; the result points into both. Throws Error at a threshold that applies to no
/// view.
std::vector<Verdict> verdicts(const Comparison& comparison, const std::vector<Threshold>& thresholds);

bool is_any_exceeded(const std::vector<Verdict>& all);

/// For a reader, and for kernels.
std::string comparison_text(const Comparison& comparison, const std::vector<Verdict>& all);
std::string comparison_report(const Comparison& comparison, const std::vector<Verdict>& all);

}  // namespace vitrum
