// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/sparse_coverage.h"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <utility>
#include <vector>

#include "base/raster/distance_transform.h"
#include "chain/evaluation/piecewise.h"

namespace landfall {
namespace {

constexpr std::size_t kMaxFrac = 8;  // one bin of the DEM in so many may be invalid

struct InvalidBins {
  std::vector<std::uint32_t> bins;  ///< row-major indices, ascending
  std::int64_t region_bins = 0;
};

InvalidBins find_invalid(const BinMask& valid, const BinMask& region) {
  const std::vector<InvalidBins> pieces =
      by_piece(valid.spec().size(), [&](std::size_t begin, std::size_t end) {
        InvalidBins piece;
        for (std::size_t i = begin; i < end; ++i) {
          if (region.values()[i] == 0) continue;
          ++piece.region_bins;
          if (valid.values()[i] == 0) piece.bins.push_back(static_cast<std::uint32_t>(i));
        }
        return piece;
      });
  InvalidBins result;
  for (const InvalidBins& piece : pieces) {
    result.bins.insert(result.bins.end(), piece.bins.begin(), piece.bins.end());
    result.region_bins += piece.region_bins;
  }
  return result;
}

/// Finds the valid bin nearest to another bin by looking at the squares about it.
class NearestValid {
 public:
  /// Looks at `budget` bins altogether.
  NearestValid(const BinMask& valid, std::int64_t budget) : valid_(valid), budget_(budget) {}

  /// The squared distance in bins; empty if the budget is spent before it is known.
  [[nodiscard]] std::optional<std::int64_t> squared_distance(BinIndex bin) {
    std::int64_t nearest = kNoValidBin;
    for (std::int64_t k = 1; k * k < nearest; ++k) {
      budget_ -= 8 * k;
      if (budget_ < 0) return std::nullopt;
      for (std::int64_t i = -k; i <= k; ++i)
        for (const BinIndex at : {BinIndex{bin.row - k, bin.col + i}, BinIndex{bin.row + k, bin.col + i},
                                  BinIndex{bin.row + i, bin.col - k}, BinIndex{bin.row + i, bin.col + k}})
          if (valid_.spec().contains(at) && valid_.at(at) != 0) nearest = std::min(nearest, i * i + k * k);
    }
    return nearest;
  }

 private:
  const BinMask& valid_;
  std::int64_t budget_;
};

/// The distance of each bin, in bins; empty if it would take too long.
std::optional<std::vector<double>> distances(const BinMask& valid, const std::vector<std::uint32_t>& bins) {
  const GridSpec& spec = valid.spec();
  NearestValid nearest(valid, spec.rows * spec.cols);
  std::vector<double> result;
  result.reserve(bins.size());
  for (const std::uint32_t index : bins) {
    const auto squared = nearest.squared_distance({index / spec.cols, index % spec.cols});
    if (!squared) return std::nullopt;
    result.push_back(bins_apart(*squared));
  }
  return result;
}

JudgedCoverage judge_densely(const BinMask& valid, const BinMask& region, const EvaluationLimits& limits,
                             Grid<std::int8_t>& fail) {
  Coverage coverage = assess_coverage(valid, region, limits);
  flag_coverage(coverage, limits, fail);
  return {std::move(coverage.metrics), std::move(coverage.holes)};
}

}  // namespace

JudgedCoverage judge_coverage(const BinMask& valid, const BinMask& region, const EvaluationLimits& limits,
                              Grid<std::int8_t>& fail) {
  const InvalidBins invalid = find_invalid(valid, region);
  if (invalid.bins.size() > valid.spec().size() / kMaxFrac) return judge_densely(valid, region, limits, fail);
  const auto distance = distances(valid, invalid.bins);
  if (!distance) return judge_densely(valid, region, limits, fail);
  BinLabels labels = label_bins(valid.spec(), invalid.bins);
  const auto hole_of = [&](std::size_t i) -> Hole& {
    return labels.holes[static_cast<std::size_t>(labels.id[i] - 1)];
  };
  std::int64_t beyond = 0;
  for (std::size_t i = 0; i < invalid.bins.size(); ++i) {
    Hole& hole = hole_of(i);
    hole.depth_bins = std::max(hole.depth_bins, (*distance)[i]);
    beyond += (*distance)[i] > limits.hole_depth ? 1 : 0;
    fail.values()[invalid.bins[i]] |= coverage_flags(hole, (*distance)[i], limits);
  }
  CoverageMetrics metrics = coverage_metrics(labels.holes, invalid.region_bins, limits);
  metrics.distance_over_limit_count = beyond;
  return {std::move(metrics), std::move(labels.holes)};
}

}  // namespace landfall
