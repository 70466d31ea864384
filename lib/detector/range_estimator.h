// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

namespace landfall {

/// The range that a pixel reports when its sub-pixels see several. A sample that missed is NaN; with one
/// sample every rule returns it unchanged.
enum class RangeRule {
  mean,       ///< mean of the samples that hit (Chen et al.); no return where fewer than half hit
  first,      ///< the nearest, as a leading-edge trigger reports it; one hit is enough
  median,     ///< median of the hits (even count: mean of the middle two); none where fewer than half hit
  strongest,  ///< the mean of the densest cluster, as a peak detector reports it; one hit is enough
};

struct RangeEstimatorParameters {
  RangeRule rule = RangeRule::mean;
  /// The range extent that `strongest` accepts for one echo: a cluster's farthest range minus its nearest is
  /// at most this. Finite, > 0.
  double range_resolution_m = 0.15;
};

/// Turns the ranges of a pixel's samples into the range that the pixel reports.
class RangeEstimator {
 public:
  RangeEstimator() = default;
  /// Throws UsageError, naming the key, where range_resolution_m is out of range.
  explicit RangeEstimator(const RangeEstimatorParameters& parameters);

  /// Metres; NaN for no return, also without any sample. `strongest` takes the nearest of the clusters with
  /// the most ranges and sums from its nearest range on. Only the result of `mean`, which sums in the order
  /// given, depends on the order of the samples. The call may reorder them.
  [[nodiscard]] double range_m(std::span<double> sample_ranges_m) const;

 private:
  RangeEstimatorParameters parameters_{};
};

}  // namespace landfall
