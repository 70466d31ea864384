// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "evaluation/parameters.h"

namespace landfall {

// The fields of metrics.json, by their names and in their order. An empty optional is null there, and so is a
// number that is not finite (max_distance_bins, when the DEM has no valid bin).

struct RegionMetrics {
  double radius_m = 0;
  std::int64_t bin_count = 0;
  friend bool operator==(const RegionMetrics&, const RegionMetrics&) = default;
};

/// The sizes that occur, ascending, and how many holes have each.
struct HoleSizeHistogram {
  std::vector<std::int64_t> size_bins;
  std::vector<std::int64_t> count;
  friend bool operator==(const HoleSizeHistogram&, const HoleSizeHistogram&) = default;
};

struct CoverageMetrics {
  std::int64_t invalid_count = 0;
  double invalid_frac = 0;  ///< of all bins of the region
  std::int64_t hole_count = 0;
  std::int64_t largest_hole_bins = 0;
  std::int64_t holes_over_limit = 0;
  double max_distance_bins = 0;  ///< over the region's invalid bins; infinite if the DEM has no valid bin
  std::int64_t distance_over_limit_count = 0;
  HoleSizeHistogram hole_size_histogram;
  friend bool operator==(const CoverageMetrics&, const CoverageMetrics&) = default;
};

/// Over the footprints with a value; all null when there is none.
struct AbsoluteMetrics {
  std::optional<double> p95_m;   ///< 0.95 quantile of |mean|, whatever EvaluationParameters::quantile says
  std::optional<double> mean_m;  ///< signed
  std::optional<double> max_m;   ///< of |mean|
  friend bool operator==(const AbsoluteMetrics&, const AbsoluteMetrics&) = default;
};

/// Over the footprints with a value in x and in y; the others are not in the fraction's denominator.
struct HorizontalMetrics {
  std::optional<double> p95_m;
  std::optional<double> within_limit_frac;
  friend bool operator==(const HorizontalMetrics&, const HorizontalMetrics&) = default;
};

struct RelativeMetrics {
  std::optional<double> p95_m;  ///< 0.95 quantile over footprints, likewise
  std::optional<double> max_m;
  std::int64_t violation_count = 0;  ///< footprints above the limit, judged in double
  friend bool operator==(const RelativeMetrics&, const RelativeMetrics&) = default;
};

struct AccuracyMetrics {
  std::int64_t footprint_bins = 0;  ///< edge
  double quantile = 0;
  struct Absolute {
    AbsoluteMetrics x, y, z;
    HorizontalMetrics horizontal;
    friend bool operator==(const Absolute&, const Absolute&) = default;
  } absolute;
  struct Relative {
    RelativeMetrics x, y, z;
    friend bool operator==(const Relative&, const Relative&) = default;
  } relative;
  friend bool operator==(const AccuracyMetrics&, const AccuracyMetrics&) = default;
};

/// A value equal to its limit passes. Without truth, value and pass of the accuracy requirements are null.
/// With truth but no footprint to judge, value is null and the requirement is not met.
struct Requirement {
  std::optional<double> value;
  double limit = 0;
  std::optional<bool> pass;
  friend bool operator==(const Requirement&, const Requirement&) = default;
};

struct RequirementMetrics {
  Requirement coverage;             ///< invalid_frac
  Requirement hole_size;            ///< largest_hole_bins
  Requirement hole_distance;        ///< max_distance_bins
  Requirement relative_elevation;   ///< violation count of z; the limit is 0
  Requirement relative_horizontal;  ///< violation counts of x and y added; the limit is 0
  Requirement absolute_horizontal;  ///< within_limit_frac; passes at or above the limit
  friend bool operator==(const RequirementMetrics&, const RequirementMetrics&) = default;
};

struct Metrics {
  std::optional<bool> pass;  ///< all requirements; null when one is null
  RegionMetrics region;
  CoverageMetrics coverage;
  std::optional<AccuracyMetrics> accuracy;  ///< null without truth
  RequirementMetrics requirements;
  friend bool operator==(const Metrics&, const Metrics&) = default;
};

/// Judges coverage and accuracy against Table 1. `accuracy` is empty without truth.
[[nodiscard]] RequirementMetrics judge(const CoverageMetrics& coverage,
                                       const std::optional<AccuracyMetrics>& accuracy,
                                       const EvaluationLimits& limits);

/// Whether all pass; null when one is null, even if another fails.
[[nodiscard]] std::optional<bool> overall_pass(const RequirementMetrics& requirements);

}  // namespace landfall
