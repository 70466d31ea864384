// SPDX-License-Identifier: GPL-3.0-or-later
#include "evaluation/accuracy.h"

#include <cmath>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "evaluation/order_statistics.h"
#include "evaluation/piecewise.h"

namespace landfall {
namespace {

/// Of the summaries over footprints; it does not follow EvaluationParameters::quantile.
constexpr double kSummaryQuantile = 0.95;
constexpr std::size_t kRowsPerPiece = 64;

auto values_of(const Grid<double>& grid) {
  return [values = grid.values()](std::size_t i) { return values[i]; };
}

auto magnitudes_of(const Grid<double>& grid) {
  return [values = grid.values()](std::size_t i) { return std::abs(values[i]); };
}

}  // namespace

Grid<double> error_of(Axis axis, Grid<double> truth, const Grid<double>& z_est) {
  const GridSpec& spec = truth.spec();
  parallel_for(static_cast<std::size_t>(spec.rows), kRowsPerPiece, [&](std::size_t begin, std::size_t end) {
    for (auto row = static_cast<std::int64_t>(begin); row < static_cast<std::int64_t>(end); ++row)
      for (std::int64_t col = 0; col < spec.cols; ++col)
        truth.at({row, col}) -= axis == Axis::x   ? spec.x(col)
                                : axis == Axis::y ? spec.y(row)
                                                  : z_est.at({row, col});
  });
  return truth;
}

FootprintStatistics footprint_statistics(const Grid<double>& error, const BinMask& region,
                                         const FootprintRule& rule, const ProgressCallback& progress) {
  WindowMeans windows = window_means(error, rule.footprint);
  FootprintStatistics result;
  result.relative = window_quantile({.error = error,
                                     .windows = windows,
                                     .footprint = rule.footprint,
                                     .region = region,
                                     .quantile = rule.quantile},
                                    progress);
  for_each_index(region.spec().size(), [&](std::size_t i) {
    if (region.values()[i] == 0) windows.mean.values()[i] = std::numeric_limits<double>::quiet_NaN();
  });
  result.mean = std::move(windows.mean);
  return result;
}

AbsoluteMetrics summarise_absolute(const Grid<double>& mean) {
  const std::size_t bins = mean.spec().size();
  const CountedSum sum = counted_sum(bins, values_of(mean));
  if (sum.count == 0) return {};
  return {.p95_m = quantile_of(bins, magnitudes_of(mean), kSummaryQuantile),
          .mean_m = sum.mean(),
          .max_m = largest_of(bins, magnitudes_of(mean))};
}

RelativeMetrics summarise_relative(const Grid<double>& relative, double limit_m) {
  const std::size_t bins = relative.spec().size();
  const std::optional<double> p95_m = quantile_of(bins, values_of(relative), kSummaryQuantile);
  if (!p95_m) return {};
  return {.p95_m = p95_m,
          .max_m = largest_of(bins, values_of(relative)),
          .violation_count = count_above(bins, values_of(relative), limit_m)};
}

HorizontalMetrics summarise_horizontal(const Grid<double>& horizontal, double limit_m) {
  const std::size_t bins = horizontal.spec().size();
  const CountedSum sum = counted_sum(bins, values_of(horizontal));
  if (sum.count == 0) return {};
  const auto count = static_cast<double>(sum.count);
  const auto above = static_cast<double>(count_above(bins, values_of(horizontal), limit_m));
  return {.p95_m = quantile_of(bins, values_of(horizontal), kSummaryQuantile),
          .within_limit_frac = (count - above) / count};
}

Grid<double> horizontal_error(Grid<double> x, const Grid<double>& y) {
  const std::span<double> values = x.values();
  for_each_index(values.size(), [&](std::size_t i) { values[i] = std::hypot(values[i], y.values()[i]); });
  return x;
}

}  // namespace landfall
