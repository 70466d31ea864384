// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

namespace landfall {

/// The rule by which a pixel makes one range of those of its samples, the rays of its sub-pixels. A sample
/// that missed is NaN; with one sample every rule returns it unchanged.
enum class RangeRule {
  mean,       ///< mean of the samples that hit (Chen et al.); no return where fewer than half hit
  first,      ///< the nearest, as a leading-edge trigger reports it; one hit is enough
  median,     ///< median of the hits (even count: mean of the middle two); none where fewer than half hit
  strongest,  ///< the mean of the densest cluster, as a peak detector reports it; one hit is enough
};

struct RangeEstimatorParameters {
  RangeRule rule = RangeRule::mean;
  /// `strongest`: the largest extent of a cluster, its farthest minus its nearest range. Finite, > 0.
  double range_resolution_m = 0.15;
};

/// Turns the ranges of a pixel's samples into the range that the pixel reports.
class RangeEstimator {
 public:
  RangeEstimator() = default;
  /// Throws UsageError, naming the key, unless range_resolution_m is finite and > 0.
  explicit RangeEstimator(const RangeEstimatorParameters& parameters);

  /// The reported range, metres; NaN for no return, also if there are no samples. If several clusters have
  /// the most ranges, `strongest` takes the nearest. Only `mean` depends on the order of the samples, by
  /// rounding: it adds them in the order given. The call may reorder `sample_ranges_m`.
  [[nodiscard]] double range_m(std::span<double> sample_ranges_m) const;

 private:
  RangeEstimatorParameters parameters_{};
};

}  // namespace landfall
