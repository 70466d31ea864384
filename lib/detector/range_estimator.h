// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

namespace landfall {

/// Which range a pixel reports when its sub-pixels see several. A sample that missed is NaN; with one sample
/// every rule returns it unchanged.
enum class RangeRule {
  mean,       ///< of those that hit (Chen et al.); no return where fewer than half hit
  first,      ///< the nearest, as a leading-edge trigger reports it; one hit is enough
  median,     ///< of those that hit, of an even count the middle two's mean; none where fewer than half hit
  strongest,  ///< the mean of the densest cluster, as a peak detector reports it; one hit is enough
};

struct RangeEstimatorParameters {
  RangeRule rule = RangeRule::mean;
  /// What `strongest` takes for one echo: a cluster's farthest range minus its nearest is at most this.
  /// Finite, > 0.
  double range_resolution_m = 0.15;
};

/// Turns the ranges of a pixel's samples into the range that the pixel reports.
class RangeEstimator {
 public:
  RangeEstimator() = default;
  /// Throws UsageError, naming the key, where range_resolution_m is out of range.
  explicit RangeEstimator(const RangeEstimatorParameters& parameters);

  /// Metres; NaN: no return, also where there is no sample. `strongest`: of the clusters with the most ranges
  /// the nearest, summed from its nearest on. The result of all rules but `mean`, which sums in the order
  /// given, does not depend on the order of the samples. They may come back reordered.
  [[nodiscard]] double range_m(std::span<double> sample_ranges_m) const;

 private:
  RangeEstimatorParameters parameters_{};
};

}  // namespace landfall
