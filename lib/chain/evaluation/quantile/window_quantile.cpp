// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/quantile/window_quantile.h"

#include <algorithm>

#include "base/core/parallel.h"
#include "base/numerics/non_finite.h"
#include "chain/evaluation/quantile/tile_quantile.h"
#include "chain/evaluation/quantile/window_selection.h"

namespace landfall {
namespace {

constexpr std::size_t kQuantileRows = 4;

/// Below this bound no sum of errors and no difference from a mean overflows.
constexpr double kLargestError = 0x1p900;

bool may_overflow(const Grid<double>& error) {
  return std::ranges::any_of(error.values(), [](double e) { return std::abs(e) > kLargestError; });
}

}  // namespace

Grid<double> window_quantile_naive(const WindowQuantileInput& input, const ProgressCallback& progress) {
  const GridSpec& spec = input.error.spec();
  Grid<double> result(spec, kNan);
  const auto piece = [&](std::size_t begin, std::size_t end) {
    WindowSelection selection(input);
    for (auto row = static_cast<std::int64_t>(begin); row < static_cast<std::int64_t>(end); ++row)
      for (std::int64_t col = 0; col < spec.cols; ++col)
        if (is_pending(input, result, {row, col})) result.at({row, col}) = selection.at({row, col});
  };
  parallel_for(static_cast<std::size_t>(spec.rows), kQuantileRows, piece, progress);
  return result;
}

Grid<double> window_quantile(const WindowQuantileInput& input, const ProgressCallback& progress,
                             const QuantileTile& tile) {
  if (may_overflow(input.error)) return window_quantile_naive(input, progress);
  const GridSpec& spec = input.error.spec();
  auto result = Grid<double>::unset(spec);
  const auto piece = [&](std::size_t begin, std::size_t end) {
    TileQuantile tiles(input, result);
    const auto row = static_cast<std::int64_t>(begin);
    const std::int64_t rows = static_cast<std::int64_t>(end) - row;
    for (std::int64_t r = row; r < row + rows; ++r) std::ranges::fill(result.row(r), kNan);
    for (std::int64_t col = 0; col < spec.cols; col += tile.cols)
      tiles.compute({row, col, rows, std::min(tile.cols, spec.cols - col)});
  };
  parallel_for(static_cast<std::size_t>(spec.rows), static_cast<std::size_t>(tile.rows), piece, progress);
  return result;
}

}  // namespace landfall
