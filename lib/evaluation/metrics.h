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
  RegionShape shape = RegionShape::circle;
  std::optional<double> radius_m = std::nullopt;      ///< of the circle
  std::optional<double> half_width_m = std::nullopt;  ///< of the square
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

/// Of the errors of the region's bins (error_statistics.h); all null without truth, all but count without an
/// error.
struct ErrorStatistics {
  std::optional<std::int64_t> count = std::nullopt;
  std::optional<double> mean_m = std::nullopt;
  std::optional<double> std_m = std::nullopt;
  std::optional<double> rmse_m = std::nullopt;
  std::optional<double> median_m = std::nullopt;
  std::optional<double> nmad_m = std::nullopt;
  std::optional<double> le90_m = std::nullopt;
  std::optional<double> p95_m = std::nullopt;
  friend bool operator==(const ErrorStatistics&, const ErrorStatistics&) = default;
};

struct HorizontalStatistics {
  std::optional<std::int64_t> count = std::nullopt;
  std::optional<double> ce90_m = std::nullopt;
  std::optional<double> rmse_m = std::nullopt;
  friend bool operator==(const HorizontalStatistics&, const HorizontalStatistics&) = default;
};

struct StatisticsMetrics {
  double valid_frac = 0;  ///< bins of the region with an elevation, over all
  ErrorStatistics x, y, z;
  std::optional<ErrorStatistics> z_corrected;  ///< for a DEM with that layer
  HorizontalStatistics horizontal;
  friend bool operator==(const StatisticsMetrics&, const StatisticsMetrics&) = default;
};

struct AccuracyMetrics {
  std::int64_t footprint_bins = 0;  ///< edge
  double quantile = 0;
  struct Absolute {
    AbsoluteMetrics x, y, z;
    std::optional<AbsoluteMetrics> z_corrected;  ///< for a DEM with that layer; judged by no requirement
    HorizontalMetrics horizontal;
    friend bool operator==(const Absolute&, const Absolute&) = default;
  } absolute;
  struct Relative {
    RelativeMetrics x, y, z;
    std::optional<RelativeMetrics> z_corrected;
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

/// z-scores of one 1-sigma map (uncertainty.h).
struct ScoreMetrics {
  struct OfCount {
    std::int32_t count = 0;  ///< returns
    std::int64_t bins = 0;
    double std = 0;
    double within_1_sigma_frac = 0;
    double within_2_sigma_frac = 0;
    friend bool operator==(const OfCount&, const OfCount&) = default;
  };
  /// Bins of nearly equal sigma: its steps are a quarter of a doubling.
  struct OfSigma {
    double sigma_m = 0;  ///< root mean square of the predicted sigma
    double rmse_m = 0;   ///< of the errors
    std::int64_t bins = 0;
    friend bool operator==(const OfSigma&, const OfSigma&) = default;
  };
  struct Share {
    double k = 0;
    double within_frac = 0;  ///< of the errors within k sigma
    friend bool operator==(const Share&, const Share&) = default;
  };

  std::int64_t count = 0;
  std::int64_t left_out_count = 0;  ///< bins with an error but no usable sigma
  std::optional<double> mean = std::nullopt;
  std::optional<double> std = std::nullopt;
  std::optional<double> within_1_sigma_frac = std::nullopt;
  std::optional<double> within_2_sigma_frac = std::nullopt;
  std::vector<OfCount> by_count = {};     ///< ascending; empty for a DEM without counts
  std::vector<OfSigma> reliability = {};  ///< ascending
  std::vector<Share> shares = {};
  friend bool operator==(const ScoreMetrics&, const ScoreMetrics&) = default;
};

struct UncertaintyMetrics {
  ScoreMetrics absolute;
  ScoreMetrics relative;
  friend bool operator==(const UncertaintyMetrics&, const UncertaintyMetrics&) = default;
};

struct Metrics {
  std::optional<bool> pass;  ///< all requirements; null when one is null
  RegionMetrics region;
  CoverageMetrics coverage;
  std::optional<AccuracyMetrics> accuracy;  ///< null without truth
  StatisticsMetrics statistics;
  RequirementMetrics requirements;
  std::optional<UncertaintyMetrics> uncertainty;  ///< for a DEM with 1-sigma maps
  friend bool operator==(const Metrics&, const Metrics&) = default;
};

/// Judges coverage and accuracy against Table 1. `accuracy` is empty without truth.
[[nodiscard]] RequirementMetrics judge(const CoverageMetrics& coverage,
                                       const std::optional<AccuracyMetrics>& accuracy,
                                       const EvaluationLimits& limits);

/// Whether all pass; null when one is null, even if another fails.
[[nodiscard]] std::optional<bool> overall_pass(const RequirementMetrics& requirements);

}  // namespace landfall
