// SPDX-License-Identifier: GPL-3.0-or-later
#include "ray/elevation_pyramid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace landfall {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct NodeBounds {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
};

float rounded_down(double value) {
  const auto nearest = static_cast<float>(value);
  return double{nearest} > value ? std::nextafter(nearest, -kInfinity) : nearest;
}

float rounded_up(double value) { return -rounded_down(-value); }

/// Of the nodes of a block of level 0, those on its borders included.
NodeBounds block_bounds(const Grid<double>& nodes, BinIndex block) {
  constexpr std::int64_t kCells = ElevationPyramid::kBlockCells;
  const BinIndex last{std::min((block.row + 1) * kCells, nodes.spec().rows - 1),
                      std::min((block.col + 1) * kCells, nodes.spec().cols - 1)};
  NodeBounds bounds;
  for (std::int64_t row = block.row * kCells; row <= last.row; ++row)
    for (std::int64_t col = block.col * kCells; col <= last.col; ++col) {
      const double z = nodes.at({row, col});
      if (!std::isfinite(z)) continue;
      bounds.low = std::min(bounds.low, z);
      bounds.high = std::max(bounds.high, z);
    }
  return bounds;
}

ElevationPyramid::Level empty_level(std::int64_t rows, std::int64_t cols) {
  const auto size = static_cast<std::size_t>(rows * cols);
  return {rows, cols, std::vector<float>(size, kInfinity), std::vector<float>(size, -kInfinity)};
}

ElevationPyramid::Level finest_level(const Grid<double>& nodes) {
  const auto blocks = [](std::int64_t node_count) {
    return (node_count - 2) / ElevationPyramid::kBlockCells + 1;
  };
  ElevationPyramid::Level level = empty_level(blocks(nodes.spec().rows), blocks(nodes.spec().cols));
  for (std::int64_t row = 0; row < level.rows; ++row)
    for (std::int64_t col = 0; col < level.cols; ++col) {
      const NodeBounds bounds = block_bounds(nodes, {row, col});
      level.low[level.index({row, col})] = rounded_down(bounds.low);
      level.high[level.index({row, col})] = rounded_up(bounds.high);
    }
  return level;
}

ElevationPyramid::Level next_level(const ElevationPyramid::Level& finer) {
  ElevationPyramid::Level level = empty_level((finer.rows + 1) / 2, (finer.cols + 1) / 2);
  for (std::int64_t row = 0; row < finer.rows; ++row)
    for (std::int64_t col = 0; col < finer.cols; ++col) {
      const std::size_t to = level.index({row / 2, col / 2});
      const std::size_t from = finer.index({row, col});
      level.low[to] = std::min(level.low[to], finer.low[from]);
      level.high[to] = std::max(level.high[to], finer.high[from]);
    }
  return level;
}

}  // namespace

ElevationPyramid::ElevationPyramid(const Grid<double>& nodes) {
  levels_.push_back(finest_level(nodes));
  while (levels_.back().low.size() > 1) levels_.push_back(next_level(levels_.back()));
}

ElevationPyramid::Bounds ElevationPyramid::over(const CellBox& box) const {
  constexpr double kMargin_cells = 0.0625;
  const double width = std::max(box.high_x - box.low_x, box.high_y - box.low_y) + 2 * kMargin_cells;
  int finest = 0;
  while (finest + 1 < level_count() && static_cast<double>(kBlockCells << finest) < width) ++finest;
  const Level& blocks = level(finest);
  const double blocks_per_cell = 1 / static_cast<double>(kBlockCells << finest);
  const auto block = [&](double cell, std::int64_t count) {
    const double position = std::floor(cell * blocks_per_cell);
    return static_cast<std::int64_t>(std::clamp(position, -1.0, static_cast<double>(count)));
  };
  const BinIndex first{std::max<std::int64_t>(block(box.low_y - kMargin_cells, blocks.rows), 0),
                       std::max<std::int64_t>(block(box.low_x - kMargin_cells, blocks.cols), 0)};
  const BinIndex last{std::min(block(box.high_y + kMargin_cells, blocks.rows), blocks.rows - 1),
                      std::min(block(box.high_x + kMargin_cells, blocks.cols), blocks.cols - 1)};
  Bounds bounds;
  for (std::int64_t row = first.row; row <= last.row; ++row)
    for (std::int64_t col = first.col; col <= last.col; ++col) {
      bounds.low = std::min(bounds.low, blocks.low[blocks.index({row, col})]);
      bounds.high = std::max(bounds.high, blocks.high[blocks.index({row, col})]);
    }
  return bounds;
}

}  // namespace landfall
