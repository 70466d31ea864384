// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D24, D64
#include "chain/evaluation/accuracy.h"

#include <cmath>
#include <limits>
#include <utility>

#include "base/numerics/portable_math.h"
#include "base/raster/by_rows.h"
#include "chain/evaluation/piecewise.h"
#include "chain/evaluation/quantile/order_statistics.h"

namespace landfall {
namespace {

/// The quantile of the summaries over footprints, independent of EvaluationParameters::quantile.
constexpr double kSummaryQuantile = 0.95;

auto grid_values(const Grid<double>& grid) {
  return [values = grid.values()](std::size_t i) { return values[i]; };
}

auto magnitudes_of(const Grid<double>& grid) {
  return [values = grid.values()](std::size_t i) { return std::abs(values[i]); };
}

/// The quantile of magnitudes that have already been counted; at least one exists.
template <ValueAt F>
double p95(const ValueSummary& summary, std::size_t bins, const F& magnitude_at) {
  const BucketRange range = *find_buckets(summary.counts, kSummaryQuantile);
  return value_at_rank(values_in(bins, magnitude_at, range), range.rank);
}

}  // namespace

Grid<double> error_of(Axis axis, Grid<double> truth, const Grid<double>& z_est) {
  const GridSpec& spec = truth.spec();
  by_rows(spec, [&](std::int64_t row) {
    for (std::int64_t col = 0; col < spec.cols; ++col)
      truth.at({row, col}) -= axis == Axis::x   ? spec.x(col)
                              : axis == Axis::y ? spec.y(row)
                                                : z_est.at({row, col});
  });
  return truth;
}

ErrorLayers errors_of(TrueLayers truth, const Grid<double>& z_est, std::optional<Grid<double>> corrected) {
  if (corrected)
    for_each_index(z_est.spec().size(), [&](std::size_t i) {
      double& value = corrected->values()[i];
      value = truth.z.values()[i] - value;
    });
  // Grids without bins remain so.
  return {.x = error_of(Axis::x, std::move(truth.x), z_est),
          .y = error_of(Axis::y, std::move(truth.y), z_est),
          .z = error_of(Axis::z, std::move(truth.z), z_est),
          .corrected = std::move(corrected)};
}

FootprintRule footprint_rule(const EvaluationParameters& parameters, double resolution_m) {
  FootprintRule rule{footprint_of(parameters, resolution_m), std::nullopt};
  if (judges_relative_errors(rule.footprint.edge_bins())) rule.quantile = parameters.quantile;
  return rule;
}

FootprintStatistics footprint_statistics(const Grid<double>& error, const BinMask& region,
                                         const FootprintRule& rule, const ProgressCallback& progress) {
  WindowMeans windows = window_means(error, rule.footprint);
  FootprintStatistics result;
  if (rule.quantile)
    result.relative = window_quantile({.error = error,
                                       .windows = windows,
                                       .footprint = rule.footprint,
                                       .region = region,
                                       .quantile = *rule.quantile},
                                      progress);
  else
    result.relative = Grid<double>(region.spec(), std::numeric_limits<double>::quiet_NaN());
  for_each_index(region.spec().size(), [&](std::size_t i) {
    if (region.values()[i] == 0) windows.mean.values()[i] = std::numeric_limits<double>::quiet_NaN();
  });
  result.mean = std::move(windows.mean);
  return result;
}

AbsoluteMetrics summarise_absolute(const Grid<double>& mean) {
  const std::size_t bins = mean.spec().size();
  const ValueSummary summary = summarize(bins, grid_values(mean), HUGE_VAL);
  if (summary.sum.count == 0) return {};
  return {.p95_m = p95(summary, bins, magnitudes_of(mean)),
          .mean_m = summary.sum.mean(),
          .max_m = summary.largest};
}

RelativeMetrics summarise_relative(const Grid<double>& relative, double limit_m) {
  const std::size_t bins = relative.spec().size();
  const ValueSummary summary = summarize(bins, grid_values(relative), limit_m);
  if (summary.sum.count == 0) return {.violation_count = 0};
  return {.p95_m = p95(summary, bins, grid_values(relative)),
          .max_m = summary.largest,
          .violation_count = summary.above};
}

HorizontalMetrics summarise_horizontal(const Grid<double>& horizontal, double limit_m) {
  const std::size_t bins = horizontal.spec().size();
  const ValueSummary summary = summarize(bins, grid_values(horizontal), limit_m);
  if (summary.sum.count == 0) return {};
  const auto count = static_cast<double>(summary.sum.count);
  return {.p95_m = p95(summary, bins, grid_values(horizontal)),
          .within_limit_frac = (count - static_cast<double>(summary.above)) / count};
}

Grid<double> horizontal_error(Grid<double> x, const Grid<double>& y) {
  const std::span<double> values = x.values();
  for_each_index(values.size(),
                 [&](std::size_t i) { values[i] = portable::hypot(values[i], y.values()[i]); });
  return x;
}

}  // namespace landfall
