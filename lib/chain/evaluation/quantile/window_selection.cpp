// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/quantile/window_selection.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "chain/evaluation/quantile/quantile.h"

namespace landfall {
namespace {

/// The number of bins of the largest window plus one, because a NaN is written after the last value before it
/// is dropped.
std::size_t buffer_size(const GridSpec& spec, std::int64_t half) {
  const std::int64_t edge = 2 * half + 1;
  return static_cast<std::size_t>(std::min(edge, spec.rows) * std::min(edge, spec.cols) + 1);
}

/// Writes |error - mean| of the window's valid bins and returns their number. Every bin is written and only
/// valid ones advance, since a branch on NaN would cost more than the store.
std::size_t gather_deviations(const WindowQuantileInput& input, BinIndex bin, double* deviations) {
  const GridSpec& spec = input.error.spec();
  const double mean = input.windows.mean.at(bin);
  const std::int64_t half = input.footprint.half_bins();
  const std::int64_t last_row = std::min(bin.row + half, spec.rows - 1);
  std::size_t n = 0;
  for (std::int64_t row = std::max<std::int64_t>(bin.row - half, 0); row <= last_row; ++row) {
    const double* const errors = input.error.row(row).data();
    const std::int64_t half_width = input.footprint.half_width(row - bin.row);
    const std::int64_t last_col = std::min(bin.col + half_width, spec.cols - 1);
    for (std::int64_t col = std::max<std::int64_t>(bin.col - half_width, 0); col <= last_col; ++col) {
      const double deviation = std::abs(errors[col] - mean);
      deviations[n] = deviation;
      n += std::isnan(deviation) ? 0U : 1U;
    }
  }
  return n;
}

}  // namespace

WindowSelection::WindowSelection(const WindowQuantileInput& input)
    : input_(input), deviations_(buffer_size(input.error.spec(), input.footprint.half_bins())) {}

double WindowSelection::at(BinIndex bin) {
  const std::size_t n = gather_deviations(input_, bin, deviations_.data());
  return quantile_in_place(std::span(deviations_).first(n), input_.quantile);
}

}  // namespace landfall
