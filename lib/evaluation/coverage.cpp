// SPDX-License-Identifier: GPL-3.0-or-later
#include "evaluation/coverage.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "raster/distance_transform.h"

namespace landfall {
namespace {

BinMask valid_bins(const Grid<double>& z_est) {
  auto valid = BinMask::unset(z_est.spec());
  std::ranges::transform(z_est.values(), valid.values().begin(),
                         [](double z) -> std::int8_t { return std::isnan(z) ? 0 : 1; });
  return valid;
}

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

/// Computes the largest distance of each hole and counts the bins beyond the limit.
void measure_distances(Coverage& coverage, double limit_bins) {
  for (std::size_t i = 0; i < coverage.invalid.spec().size(); ++i) {
    const std::int32_t id = coverage.hole_id.values()[i];
    if (id == 0) continue;
    const double distance = distance_bins(coverage.squared_distance.values()[i]);
    Hole& hole = coverage.holes[static_cast<std::size_t>(id - 1)];
    hole.largest_distance_bins = std::max(hole.largest_distance_bins, distance);
    if (distance > limit_bins) ++coverage.metrics.distance_over_limit_count;
  }
}

}  // namespace

Coverage assess_coverage(const Grid<double>& z_est, const BinMask& region, const EvaluationLimits& limits) {
  const BinMask valid = valid_bins(z_est);
  Coverage result;
  result.invalid = inside_but_not(region, valid);
  HoleLabels labels = label_holes(result.invalid);
  result.hole_id = std::move(labels.id);
  result.holes = std::move(labels.holes);
  result.squared_distance = squared_distance(valid);
  measure_distances(result, limits.distance_bins);

  CoverageMetrics& metrics = result.metrics;
  metrics.invalid_count = count_set(result.invalid);
  metrics.invalid_frac = static_cast<double>(metrics.invalid_count) / static_cast<double>(count_set(region));
  metrics.hole_count = std::ssize(result.holes);
  for (const Hole& hole : result.holes) {
    metrics.largest_hole_bins = std::max(metrics.largest_hole_bins, hole.size_bins);
    metrics.max_distance_bins = std::max(metrics.max_distance_bins, hole.largest_distance_bins);
    if (hole.size_bins > limits.hole_bins) ++metrics.holes_over_limit;
  }
  metrics.hole_size_histogram = histogram(result.holes);
  return result;
}

}  // namespace landfall
