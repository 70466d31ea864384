// SPDX-License-Identifier: GPL-3.0-or-later
#include "evaluation/window_quantile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "evaluation/quantile.h"

namespace landfall {
namespace {

constexpr std::size_t kRowsPerPiece = 4;

/// Bins of the largest window, and one more: a NaN is written behind the last value before it is dropped.
std::size_t buffer_size(const GridSpec& spec, std::int64_t half) {
  const std::int64_t edge = 2 * half + 1;
  return static_cast<std::size_t>(std::min(edge, spec.rows) * std::min(edge, spec.cols) + 1);
}

/// Writes |error - mean| of the window's valid bins; returns how many. Every bin is written and only valid
/// ones advance: a branch on NaN would cost more than the store.
std::size_t gather_deviations(const WindowQuantileInput& input, BinIndex bin, double* deviations) {
  const GridSpec& spec = input.error.spec();
  const double mean = input.windows.mean.at(bin);
  const std::int64_t first_col = std::max<std::int64_t>(bin.col - input.half_bins, 0);
  const std::int64_t last_col = std::min(bin.col + input.half_bins, spec.cols - 1);
  const std::int64_t last_row = std::min(bin.row + input.half_bins, spec.rows - 1);
  std::size_t n = 0;
  for (std::int64_t row = std::max<std::int64_t>(bin.row - input.half_bins, 0); row <= last_row; ++row) {
    const double* const errors = input.error.row(row).data();
    for (std::int64_t col = first_col; col <= last_col; ++col) {
      const double deviation = std::abs(errors[col] - mean);
      deviations[n] = deviation;
      n += std::isnan(deviation) ? 0U : 1U;
    }
  }
  return n;
}

}  // namespace

Grid<double> window_quantile_naive(const WindowQuantileInput& input, const ProgressCallback& progress) {
  const GridSpec& spec = input.error.spec();
  Grid<double> result(spec, std::numeric_limits<double>::quiet_NaN());
  const auto piece = [&](std::size_t begin, std::size_t end) {
    std::vector<double> deviations(buffer_size(spec, input.half_bins));
    for (auto row = static_cast<std::int64_t>(begin); row < static_cast<std::int64_t>(end); ++row) {
      for (std::int64_t col = 0; col < spec.cols; ++col) {
        if (input.region.at({row, col}) == 0 || input.windows.count.at({row, col}) == 0) continue;
        const std::size_t n = gather_deviations(input, {row, col}, deviations.data());
        result.at({row, col}) = quantile_in_place(std::span(deviations).first(n), input.quantile);
      }
    }
  };
  parallel_for(static_cast<std::size_t>(spec.rows), kRowsPerPiece, piece, progress);
  return result;
}

}  // namespace landfall
