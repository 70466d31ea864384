// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/coverage.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/raster/distance_transform.h"
#include "chain/evaluation/fail_flag.h"
#include "chain/evaluation/piecewise.h"

namespace landfall {
namespace {

BinMask inside_but_not(const BinMask& region, const BinMask& valid) {
  auto invalid = BinMask::unset(region.spec());
  std::ranges::transform(
      region.values(), valid.values(), invalid.values().begin(),
      [](std::int8_t inside, std::int8_t v) -> std::int8_t { return inside != 0 && v == 0 ? 1 : 0; });
  return invalid;
}

HoleSizeHistogram histogram(const std::vector<Hole>& holes) {
  std::map<std::int64_t, std::int64_t> count_of;
  for (const Hole& hole : holes) ++count_of[hole.size_bins];
  HoleSizeHistogram result;
  for (const auto& [size, count] : count_of) {
    result.size_bins.push_back(size);
    result.count.push_back(count);
  }
  return result;
}

/// Computes the largest distance of each hole and returns the number of bins beyond the limit.
std::int64_t measure_distances(Coverage& coverage, double limit_bins) {
  std::int64_t beyond = 0;
  for (std::size_t i = 0; i < coverage.invalid.spec().size(); ++i) {
    const std::int32_t id = coverage.hole_numbers.values()[i];
    if (id == 0) continue;
    const double distance = bins_apart(coverage.squared_distance.values()[i]);
    Hole& hole = coverage.holes[static_cast<std::size_t>(id - 1)];
    hole.depth_bins = std::max(hole.depth_bins, distance);
    if (distance > limit_bins) ++beyond;
  }
  return beyond;
}

}  // namespace

BinMask valid_bins(const Grid<double>& z_est) {
  auto valid = BinMask::unset(z_est.spec());
  for_each_index(z_est.values().size(),
                 [&](std::size_t i) { valid.values()[i] = std::isnan(z_est.values()[i]) ? 0 : 1; });
  return valid;
}

Coverage assess_coverage(const BinMask& valid, const BinMask& region, const EvaluationLimits& limits) {
  Coverage result;
  result.invalid = inside_but_not(region, valid);
  HoleLabels labels = label_holes(result.invalid);
  result.hole_numbers = std::move(labels.id);
  result.holes = std::move(labels.holes);
  result.squared_distance = squared_distance(valid);
  const std::int64_t beyond = measure_distances(result, limits.hole_depth);
  result.metrics = coverage_metrics(result.holes, count_set(region), limits);
  result.metrics.distance_over_limit_count = beyond;
  return result;
}

CoverageMetrics coverage_metrics(const std::vector<Hole>& holes, std::int64_t region_bins,
                                 const EvaluationLimits& limits) {
  CoverageMetrics metrics;
  metrics.hole_count = std::ssize(holes);
  for (const Hole& hole : holes) {
    metrics.invalid_count += hole.size_bins;
    metrics.largest_hole_bins = std::max(metrics.largest_hole_bins, hole.size_bins);
    metrics.max_distance_bins = std::max(metrics.max_distance_bins, hole.depth_bins);
    if (hole.size_bins > limits.hole_size) ++metrics.holes_over_limit;
  }
  metrics.invalid_frac = static_cast<double>(metrics.invalid_count) / static_cast<double>(region_bins);
  metrics.hole_size_histogram = histogram(holes);
  return metrics;
}

std::int8_t coverage_flags(const Hole& hole, double bin_distance, const EvaluationLimits& limits) {
  std::int8_t flags = 0;
  if (hole.size_bins > limits.hole_size) set_flag(flags, fail_hole_size);
  if (bin_distance > limits.hole_depth) set_flag(flags, fail_hole_distance);
  return flags;
}

void flag_coverage(const Coverage& coverage, const EvaluationLimits& limits, Grid<std::int8_t>& fail) {
  for (std::size_t i = 0; i < fail.spec().size(); ++i) {
    const std::int32_t id = coverage.hole_numbers.values()[i];
    if (id != 0)
      fail.values()[i] |= coverage_flags(coverage.holes[static_cast<std::size_t>(id - 1)],
                                         bins_apart(coverage.squared_distance.values()[i]), limits);
  }
}

}  // namespace landfall
