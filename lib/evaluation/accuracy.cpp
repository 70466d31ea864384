// SPDX-License-Identifier: GPL-3.0-or-later
#include "evaluation/accuracy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "evaluation/quantile.h"

namespace landfall {
namespace {

/// Of the summaries over footprints; it does not follow EvaluationParameters::quantile.
constexpr double kSummaryQuantile = 0.95;

std::vector<double> values_of(const Grid<double>& grid) {
  const auto has_value = [](double v) { return !std::isnan(v); };
  std::vector<double> values(static_cast<std::size_t>(std::ranges::count_if(grid.values(), has_value)));
  std::ranges::copy_if(grid.values(), values.begin(), has_value);
  return values;
}

std::int64_t count_above(const std::vector<double>& values, double limit) {
  return std::ranges::count_if(values, [&](double v) { return v > limit; });
}

}  // namespace

Grid<double> error_of(Axis axis, const DemLayers& dem, const TrueLayers& truth) {
  const GridSpec& spec = dem.z_est.spec();
  Grid<double> error = axis == Axis::x ? truth.x : axis == Axis::y ? truth.y : truth.z;
  for (std::int64_t row = 0; row < spec.rows; ++row) {
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      const BinIndex bin{row, col};
      error.at(bin) -= axis == Axis::x ? spec.x(col) : axis == Axis::y ? spec.y(row) : dem.z_est.at(bin);
    }
  }
  return error;
}

FootprintStatistics footprint_statistics(const Grid<double>& error, const BinMask& region,
                                         const FootprintShape& shape, const ProgressCallback& progress) {
  WindowMeans windows = window_means(error, shape.half_bins);
  FootprintStatistics result;
  result.relative = window_quantile({.error = error,
                                     .windows = windows,
                                     .region = region,
                                     .half_bins = shape.half_bins,
                                     .quantile = shape.quantile},
                                    progress);
  for (std::size_t i = 0; i < region.spec().size(); ++i)
    if (region.values()[i] == 0) windows.mean.values()[i] = std::numeric_limits<double>::quiet_NaN();
  result.mean = std::move(windows.mean);
  return result;
}

AbsoluteMetrics summarise_absolute(const Grid<double>& mean) {
  std::vector<double> values = values_of(mean);
  if (values.empty()) return {};
  double sum = 0;
  for (double& value : values) {
    sum += value;
    value = std::abs(value);
  }
  AbsoluteMetrics result;
  result.mean_m = sum / static_cast<double>(values.size());
  result.max_m = *std::ranges::max_element(values);
  result.p95_m = quantile_in_place(values, kSummaryQuantile);
  return result;
}

RelativeMetrics summarise_relative(const Grid<double>& relative, double limit_m) {
  std::vector<double> values = values_of(relative);
  if (values.empty()) return {};
  RelativeMetrics result;
  result.max_m = *std::ranges::max_element(values);
  result.violation_count = count_above(values, limit_m);
  result.p95_m = quantile_in_place(values, kSummaryQuantile);
  return result;
}

HorizontalMetrics summarise_horizontal(const Grid<double>& horizontal, double limit_m) {
  std::vector<double> values = values_of(horizontal);
  if (values.empty()) return {};
  const auto n = static_cast<double>(values.size());
  HorizontalMetrics result;
  result.within_limit_frac = (n - static_cast<double>(count_above(values, limit_m))) / n;
  result.p95_m = quantile_in_place(values, kSummaryQuantile);
  return result;
}

Grid<double> horizontal_error(Grid<double> mean_x, const Grid<double>& mean_y) {
  std::ranges::transform(mean_x.values(), mean_y.values(), mean_x.values().begin(),
                         [](double x, double y) { return std::hypot(x, y); });
  return mean_x;
}

}  // namespace landfall
