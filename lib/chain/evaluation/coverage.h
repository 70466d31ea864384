// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "base/raster/holes.h"
#include "chain/evaluation/metrics.h"

namespace landfall {

/// Coverage of the region by valid bins: the first three rows of Table 1.
struct Coverage {
  BinMask invalid;                  ///< 1 where the region has no valid bin
  Grid<std::int32_t> hole_numbers;  ///< 8-connected components of `invalid`; 0 outside them
  /// Euclidean distance of every bin of the DEM, inside the region or not, to the nearest valid bin of the
  /// whole DEM, in bins squared (distance_transform.h).
  Grid<std::int64_t> squared_distance;
  std::vector<Hole> holes;  ///< including their distances
  CoverageMetrics metrics;
};

/// The bins that have an elevation.
[[nodiscard]] BinMask valid_bins(const Grid<double>& z_est);

/// `region` lies on the grid of `valid` and has at least one bin. A DEM without any valid bin has infinite
/// distances.
[[nodiscard]] Coverage assess_coverage(const BinMask& valid, const BinMask& region,
                                       const EvaluationLimits& limits);

/// All metrics but distance_over_limit_count, from all holes of the region with their distances.
[[nodiscard]] CoverageMetrics coverage_metrics(const std::vector<Hole>& holes, std::int64_t region_bins,
                                               const EvaluationLimits& limits);

/// The FailFlag bits of an invalid bin: of its hole, and of its distance to the nearest valid bin.
[[nodiscard]] std::int8_t coverage_flags(const Hole& hole, double bin_distance,
                                         const EvaluationLimits& limits);
/// Sets these bits in the invalid bins.
void flag_coverage(const Coverage& coverage, const EvaluationLimits& limits, Grid<std::int8_t>& fail);

}  // namespace landfall
