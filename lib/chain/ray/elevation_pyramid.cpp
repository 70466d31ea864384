// SPDX-License-Identifier: GPL-3.0-or-later
// Bounds of every cell. The heightfield engine stores the minimum and maximum elevation of each cell in
// single precision, 8.7 bytes per node in total: a ray that skims the ground reads one number instead of
// four nodes. This takes 35 MB for 2001 x 2001 nodes.
#include "chain/ray/elevation_pyramid.h"

#include <algorithm>
#include <cmath>

#include "base/numerics/rounding.h"

namespace landfall {
namespace {

using Bounds = ElevationPyramid::Bounds;

Bounds joined_bounds(Bounds a, Bounds b) { return {std::min(a.low, b.low), std::max(a.high, b.high)}; }

/// The elevations of the nodes as bounds. A hole (NaN) has empty bounds.
void bound_nodes(std::span<const double> nodes, std::vector<Bounds>& bounds) {
  std::transform(nodes.begin(), nodes.end(), bounds.begin(), [](double z) {
    return std::isfinite(z) ? Bounds{rounded_down(z), -rounded_down(-z)} : Bounds{};
  });
}

}  // namespace

ElevationPyramid::ElevationPyramid(const Grid<double>& nodes, const ProgressCallback& progress) {
  levels_.push_back({nodes.spec().rows - 1, nodes.spec().cols - 1, 0});
  std::int64_t factor = 4;
  while (levels_.back().rows > 1 || levels_.back().cols > 1) {
    const Level finer = levels_.back();
    levels_.push_back({(finer.rows + factor - 1) / factor, (finer.cols + factor - 1) / factor,
                       finer.index({finer.rows, 0})});
    factor = 2;
  }
  bounds_.resize(2 * block_count());
  bound_cells(nodes, progress);
  for (int level = 1; level < level_count(); ++level) bound_blocks(level);
  report(progress, 1);
}

void ElevationPyramid::bound_cells(const Grid<double>& nodes, const ProgressCallback& progress) {
  constexpr std::int64_t kRowsPerReport = 64;
  const Level& cells = levels_.front();
  const auto cols = static_cast<std::size_t>(cells.cols);
  std::vector<Bounds> south(cols + 1);
  std::vector<Bounds> north(cols + 1);
  bound_nodes(nodes.row(0), south);
  for (std::int64_t row = 0; row < cells.rows; ++row) {
    bound_nodes(nodes.row(row + 1), north);
    const std::size_t first = cells.index({row, 0});
    for (std::size_t col = 0; col < cols; ++col)
      set(first + col, joined_bounds(joined_bounds(south[col], south[col + 1]),
                                     joined_bounds(north[col], north[col + 1])));
    std::swap(south, north);
    if (row % kRowsPerReport == 0)
      report(progress, static_cast<double>(row) / static_cast<double>(cells.rows));
  }
}

void ElevationPyramid::bound_blocks(int level) {
  const Level& finer = levels_[static_cast<std::size_t>(level) - 1];
  const Level& blocks = levels_[static_cast<std::size_t>(level)];
  const std::int64_t factor = block_cells(level) / block_cells(level - 1);
  for (std::size_t i = blocks.first; i < blocks.index({blocks.rows, 0}); ++i) set(i, {});
  for (std::int64_t row = 0; row < finer.rows; ++row)
    for (std::int64_t col = 0; col < finer.cols; ++col) {
      const std::size_t to = blocks.index({row / factor, col / factor});
      set(to, joined_bounds(at(to), bounds(level - 1, {row, col})));
    }
}

ElevationPyramid::Bounds ElevationPyramid::over(const CellBox& box) const {
  constexpr double kMargin_cells = 0.0625;
  const double width = std::max(box.high_x - box.low_x, box.high_y - box.low_y) + 2 * kMargin_cells;
  int finest = 0;
  while (finest + 1 < level_count() && static_cast<double>(block_cells(finest)) < width) ++finest;
  const Level& blocks = level(finest);
  const double blocks_per_cell = 1 / static_cast<double>(block_cells(finest));
  const auto block = [&](double cell, std::int64_t count) {
    const double position = std::floor(cell * blocks_per_cell);
    return static_cast<std::int64_t>(std::clamp(position, -1.0, static_cast<double>(count)));
  };
  const BinIndex first{std::max<std::int64_t>(block(box.low_y - kMargin_cells, blocks.rows), 0),
                       std::max<std::int64_t>(block(box.low_x - kMargin_cells, blocks.cols), 0)};
  const BinIndex last{std::min(block(box.high_y + kMargin_cells, blocks.rows), blocks.rows - 1),
                      std::min(block(box.high_x + kMargin_cells, blocks.cols), blocks.cols - 1)};
  Bounds bounds_over;
  for (std::int64_t row = first.row; row <= last.row; ++row)
    for (std::int64_t col = first.col; col <= last.col; ++col)
      bounds_over = joined_bounds(bounds_over, bounds(finest, {row, col}));
  return bounds_over;
}

}  // namespace landfall
