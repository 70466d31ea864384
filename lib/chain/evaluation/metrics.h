// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/core/fields.h"
#include "base/dictionary/requirement.h"
#include "base/dictionary/tables/requirements.h"
#include "chain/evaluation/parameters.h"

namespace landfall {

// The fields of metrics.json; each struct lists them in the order of the file (base/core/fields.h). An empty
// optional is written as null, and so is a number that is not finite (max_distance_bins if the DEM has no
// valid bin).

struct RegionMetrics {
  RegionShape shape = RegionShape::circle;
  std::optional<double> radius_m = std::nullopt;      ///< of the circle
  std::optional<double> half_width_m = std::nullopt;  ///< of the square
  std::int64_t bin_count = 0;
  std::optional<double> center_x_m = std::nullopt;  ///< of the circle
  std::optional<double> center_y_m = std::nullopt;
  LANDFALL_FIELDS(radius_m, bin_count, shape, half_width_m, center_x_m, center_y_m)
};

/// The assumptions on which a verdict rests, empty where they are unknown.
struct AssumptionMetrics {
  std::int64_t footprint_bins = 0;                              ///< Footprint::edge_bins()
  std::optional<double> truth_spacing_m = std::nullopt;         ///< DemLayers::truth_spacing_m
  std::optional<double> median_returns_per_bin = std::nullopt;  ///< over the region's bins with returns
  std::optional<double> single_return_frac = std::nullopt;      ///< of these bins, those with one return
  LANDFALL_FIELDS(footprint_bins, truth_spacing_m, median_returns_per_bin, single_return_frac)
};

/// The hole sizes that occur, ascending, and the number of holes of each size.
struct HoleSizeHistogram {
  std::vector<std::int64_t> size_bins;
  std::vector<std::int64_t> count;
  LANDFALL_FIELDS(size_bins, count)
};

struct CoverageMetrics {
  std::int64_t invalid_count = 0;
  double invalid_frac = 0;  ///< of all bins of the region
  [[nodiscard]] double valid_frac() const { return 1 - invalid_frac; }
  std::int64_t hole_count = 0;
  std::int64_t largest_hole_bins = 0;
  std::int64_t holes_over_limit = 0;
  double max_distance_bins = 0;  ///< over the region's invalid bins; infinite if the DEM has no valid bin
  std::int64_t distance_over_limit_count = 0;
  HoleSizeHistogram hole_size_histogram;
  LANDFALL_FIELDS(invalid_count, invalid_frac, hole_count, largest_hole_bins, holes_over_limit,
                  max_distance_bins, distance_over_limit_count, hole_size_histogram)
};

/// Over the footprints with a value; all null without one.
struct AbsoluteMetrics {
  std::optional<double> p95_m;   ///< 0.95 quantile of |mean|, independent of EvaluationParameters::quantile
  std::optional<double> mean_m;  ///< signed
  std::optional<double> max_m;   ///< of |mean|
  LANDFALL_FIELDS(p95_m, mean_m, max_m)
};

/// Over the footprints with a value in x and in y. The fraction's denominator excludes the others.
struct HorizontalMetrics {
  std::optional<double> p95_m;
  std::optional<double> within_limit_frac;
  LANDFALL_FIELDS(p95_m, within_limit_frac)
};

/// Empty where relative errors are not judged. p95_m is the 0.95 quantile, independent of
/// EvaluationParameters::quantile; the footprints above the limit are counted in double.
struct RelativeMetrics {
  std::optional<double> p95_m = std::nullopt;
  std::optional<double> max_m = std::nullopt;
  std::optional<std::int64_t> violation_count = std::nullopt;
  LANDFALL_FIELDS(p95_m, max_m, violation_count)
};

/// Errors of the region's bins (error_statistics.h). All are null without truth; without an error all except
/// the count are null.
struct ErrorStatistics {
  std::optional<std::int64_t> count = std::nullopt;
  std::optional<double> mean_m = std::nullopt;
  std::optional<double> std_m = std::nullopt;
  std::optional<double> rmse_m = std::nullopt;
  std::optional<double> median_m = std::nullopt;
  std::optional<double> nmad_m = std::nullopt;
  std::optional<double> le90_m = std::nullopt;
  std::optional<double> p95_m = std::nullopt;
  LANDFALL_FIELDS(count, mean_m, std_m, rmse_m, median_m, nmad_m, le90_m, p95_m)
};

struct HorizontalStatistics {
  std::optional<std::int64_t> count = std::nullopt;
  std::optional<double> ce90_m = std::nullopt;
  std::optional<double> rmse_m = std::nullopt;
  LANDFALL_FIELDS(count, ce90_m, rmse_m)
};

struct StatisticsMetrics {
  double valid_frac = 0;  ///< bins of the region with an elevation, over all its bins
  ErrorStatistics x, y, z;
  std::optional<ErrorStatistics> z_corrected;  ///< for a DEM with that layer
  HorizontalStatistics horizontal;
  LANDFALL_FIELDS(valid_frac, x, y, z, z_corrected, horizontal)
};

struct AccuracyMetrics {
  static constexpr bool kShownEmpty = true;  ///< metrics.json keeps its keys without truth
  std::int64_t footprint_bins = 0;           ///< edge
  double quantile = 0;
  struct Absolute {
    AbsoluteMetrics x, y, z;
    std::optional<AbsoluteMetrics> z_corrected;  ///< for a DEM with that layer; not judged
    HorizontalMetrics horizontal;
    LANDFALL_FIELDS(x, y, z, horizontal, z_corrected)
  } absolute;
  struct Relative {
    RelativeMetrics x, y, z;
    std::optional<RelativeMetrics> z_corrected;
    LANDFALL_FIELDS(x, y, z, z_corrected)
  } relative;
  LANDFALL_FIELDS(footprint_bins, quantile, absolute, relative)
};

/// The reason of relative requirements that are not judged because footprints have too few bins
/// (judges_relative_errors()).
inline constexpr const char* kFootprintBins = "footprint_bins";

/// The requirements of schemas/dictionary/requirements.json; not judged at first.
struct Table1Verdicts : RequirementVerdicts {
  Table1Verdicts() : Table1Verdicts(EvaluationLimits{}) {}
  explicit Table1Verdicts(const EvaluationLimits& limits);
};

/// z-scores of one 1-sigma map (uncertainty.h).
struct ScoreMetrics {
  /// By the number of returns of a bin, ascending; empty for a DEM without counts.
  struct ByCount {
    std::vector<std::int64_t> count;  ///< returns
    std::vector<std::int64_t> bins;
    std::vector<double> std;
    std::vector<double> within_1_sigma_frac;
    std::vector<double> within_2_sigma_frac;
    LANDFALL_FIELDS(count, bins, std, within_1_sigma_frac, within_2_sigma_frac)
  };
  /// By sigma, ascending, in steps of a quarter of an octave.
  struct Reliability {
    std::vector<double> sigma_m;  ///< root mean square of the predicted sigma
    std::vector<double> rmse_m;   ///< of the errors
    std::vector<std::int64_t> bins;
    LANDFALL_FIELDS(sigma_m, rmse_m, bins)
  };
  struct WithinSigmas {
    std::vector<double> k;
    std::vector<double> frac;  ///< of the errors within k sigma
    LANDFALL_FIELDS(k, frac)
  };

  std::int64_t count = 0;
  std::int64_t left_out_count = 0;  ///< bins with an error but no usable sigma
  std::optional<double> mean = std::nullopt;
  std::optional<double> std = std::nullopt;
  std::optional<double> within_1_sigma_frac = std::nullopt;
  std::optional<double> within_2_sigma_frac = std::nullopt;
  ByCount by_count = {};
  Reliability reliability = {};
  WithinSigmas within_k_sigma = {};
  LANDFALL_FIELDS(count, left_out_count, mean, std, within_1_sigma_frac, within_2_sigma_frac, by_count,
                  reliability, within_k_sigma)
};

struct UncertaintyMetrics {
  ScoreMetrics absolute;
  ScoreMetrics relative;
  LANDFALL_FIELDS(absolute, relative)
};

struct Metrics {
  std::optional<bool> pass;  ///< with_own()
  RegionMetrics region;
  std::optional<AssumptionMetrics> assumptions;  ///< of evaluate(); files of version 1 have none
  CoverageMetrics coverage;
  std::optional<AccuracyMetrics> accuracy;  ///< null without truth
  StatisticsMetrics statistics;
  Table1Verdicts requirements;
  RequirementVerdicts own_requirements;
  std::optional<UncertaintyMetrics> uncertainty;  ///< for a DEM with 1-sigma maps
  LANDFALL_FIELDS(pass, region, assumptions, coverage, accuracy, requirements, own_requirements, statistics,
                  uncertainty)
};

/// The accuracy requirements of a DEM with truth that can be judged.
struct JudgedFootprints {
  bool judges_relative = true;  ///< judges_relative_errors()
  bool has_positions = true;    ///< else nothing along x and y is judged
  std::string axes = "xyz";     ///< those along which some footprint has a relative error
};

/// Judges the numbers of `metrics` against Table 1, in the order of the dictionary. Without truth
/// (`footprints` is empty) the accuracy requirements have neither value nor pass; with truth but no footprint
/// to judge they have no value and do not pass.
template <class M>
[[nodiscard]] Table1Verdicts judge(const M& metrics, const std::optional<JudgedFootprints>& footprints,
                                   const EvaluationLimits& limits) {
  Table1Verdicts verdicts(limits);
  for (std::size_t i = 0; i < verdicts.all.size(); ++i) {
    const dictionary::Requirement& words = dictionary::kRequirements[i];
    RequirementVerdict& verdict = verdicts.all[i];
    const std::string_view axes = words.footprints;
    if (!axes.empty() && !footprints) continue;
    const bool is_relative = words.unit == std::string_view("footprints");
    if (is_relative && !footprints->judges_relative) verdict.reason = kFootprintBins;
    if (verdict.reason || (axes.starts_with('x') && !footprints->has_positions)) continue;
    const bool is_missing = is_relative && std::ranges::any_of(axes, [&](char axis) {
                              return footprints->axes.find(axis) == std::string::npos;
                            });
    if (!is_missing) verdict.value = number_at(metrics, verdict.requirement.metric);
    verdict.pass = verdict.value && passes(verdict.requirement, *verdict.value);
  }
  return verdicts;
}
[[nodiscard]] Table1Verdicts judge(const Metrics& metrics, const EvaluationLimits& limits,
                                   bool has_positions = true);

/// Whether all requirements pass. Null without truth, even if the coverage fails; with true elevations alone
/// or too few bins in a footprint, false if a judged requirement fails, else null.
[[nodiscard]] std::optional<bool> overall_pass(const Table1Verdicts& requirements);

/// The verdict on Table 1 and on the user's own requirements: false if one of these is missed.
[[nodiscard]] std::optional<bool> with_own(std::optional<bool> pass, const RequirementVerdicts& own);

/// The fields of metrics.json on which a user can set requirements. Some of them have no value for some DEMs.
[[nodiscard]] std::vector<ResultField> metrics_fields();

/// Judges the user's own requirements by all other numbers, and sets `pass`. Called again where numbers were
/// added.
template <class M>
void judge_own_requirements(M& metrics, const std::vector<Requirement>& requirements) {
  metrics.own_requirements = {};
  metrics.own_requirements = judge_own(&std::as_const(metrics), requirements);
  metrics.pass = with_own(overall_pass(metrics.requirements), metrics.own_requirements);
}

}  // namespace landfall
