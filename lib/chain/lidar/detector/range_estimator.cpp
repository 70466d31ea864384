// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D12, D94
#include "chain/lidar/detector/range_estimator.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "base/text/parameter_check.h"

namespace landfall {
namespace {

constexpr double kNoReturn = std::numeric_limits<double>::quiet_NaN();

bool too_few(std::size_t hits, std::size_t samples) { return hits == 0 || 2 * hits < samples; }

double mean_m(std::span<const double> samples) {
  double sum = 0;
  std::size_t hits = 0;
  for (const double range : samples) {
    if (std::isnan(range)) continue;
    sum += range;
    ++hits;
  }
  return too_few(hits, samples.size()) ? kNoReturn : sum / static_cast<double>(hits);
}

/// The ranges of the samples that hit, ascending, at the front of `samples`.
std::span<const double> sorted_hits(std::span<double> samples) {
  const auto end = std::remove_if(samples.begin(), samples.end(), [](double r) { return std::isnan(r); });
  std::sort(samples.begin(), end);
  return {samples.begin(), end};
}

double first_m(std::span<const double> samples) {
  double nearest = kNoReturn;
  for (const double range : samples) nearest = std::fmin(nearest, range);
  return nearest;
}

double median_m(std::span<double> samples) {
  const std::span<const double> hits = sorted_hits(samples);
  if (too_few(hits.size(), samples.size())) return kNoReturn;
  const std::size_t middle = hits.size() / 2;
  if (hits.size() % 2 == 1) return hits[middle];
  return (hits[middle - 1] + hits[middle]) / 2;
}

/// The longest run of `sorted` that spans at most `width`; the first of several.
std::span<const double> densest(std::span<const double> sorted, double width) {
  std::span<const double> best;
  for (std::size_t begin = 0, end = 0; begin < sorted.size(); ++begin) {
    while (end < sorted.size() && sorted[end] - sorted[begin] <= width) ++end;
    if (end - begin > best.size()) best = sorted.subspan(begin, end - begin);
  }
  return best;
}

}  // namespace

RangeEstimator::RangeEstimator(const RangeEstimatorParameters& parameters) : parameters_(parameters) {
  require_positive({"", "range_resolution_m"}, parameters.range_resolution_m);
}

double RangeEstimator::range_m(std::span<double> sample_ranges_m) const {
  switch (parameters_.rule) {
    case RangeRule::mean:
      break;
    case RangeRule::first:
      return first_m(sample_ranges_m);
    case RangeRule::median:
      return median_m(sample_ranges_m);
    case RangeRule::strongest:
      return mean_m(densest(sorted_hits(sample_ranges_m), parameters_.range_resolution_m));
  }
  return mean_m(sample_ranges_m);
}

}  // namespace landfall
