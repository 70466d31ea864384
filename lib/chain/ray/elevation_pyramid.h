// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "base/core/progress.h"
#include "base/raster/grid.h"

namespace landfall {

/// A rectangle, in cells from node (0, 0).
struct CellBox {
  double low_x;
  double high_x;
  double low_y;
  double high_y;
};

/// The lowest and the highest elevation of the surface over square blocks of cells: single cells on level 0,
/// blocks of 4 x 4 cells on level 1, four blocks of the level below on each further level, one block on the
/// last level. Single precision, `low` rounded down and `high` up. A block without a finite node has low =
/// +infinity, high = -infinity.
class ElevationPyramid {
 public:
  struct Bounds {
    float low = std::numeric_limits<float>::infinity();
    float high = -std::numeric_limits<float>::infinity();
    [[nodiscard]] bool empty() const { return low > high; }
  };

  struct Level {
    std::int64_t rows = 0;
    std::int64_t cols = 0;
    std::size_t first = 0;  ///< index of the level's first block in the pyramid
    [[nodiscard]] std::size_t index(BinIndex block) const {
      return first + static_cast<std::size_t>(block.row * cols + block.col);
    }
  };

  /// The width of a block in cells.
  [[nodiscard]] static constexpr std::int64_t block_cells(int level) {
    return level == 0 ? 1 : std::int64_t{2} << level;
  }

  /// O(nodes), 8.7 bytes per node; the nodes must be at least 2 x 2.
  explicit ElevationPyramid(const Grid<double>& nodes, const ProgressCallback& progress = {});

  [[nodiscard]] int level_count() const { return static_cast<int>(levels_.size()); }
  [[nodiscard]] const Level& level(int level) const { return levels_[static_cast<std::size_t>(level)]; }
  /// The block must lie in the level.
  [[nodiscard]] Bounds bounds(int level, BinIndex block) const { return at(this->level(level).index(block)); }
  /// The upper bounds of all blocks; each level is row-major from Level::first on.
  [[nodiscard]] std::span<const float> highs() const { return std::span(bounds_).first(block_count()); }
  /// The lower bounds of all blocks in the same order. They follow the highs in memory.
  [[nodiscard]] std::span<const float> lows() const { return std::span(bounds_).last(block_count()); }
  /// Bounds of the surface over the box, not the tightest: those of the few blocks (at most 2 x 2) that the
  /// box, widened by 1/16 cell, touches. O(levels).
  [[nodiscard]] Bounds over(const CellBox& box) const;
  [[nodiscard]] float lowest() const { return at(block_count() - 1).low; }
  [[nodiscard]] float highest() const { return at(block_count() - 1).high; }

 private:
  [[nodiscard]] std::size_t block_count() const { return levels_.back().first + 1; }
  [[nodiscard]] Bounds at(std::size_t block) const {
    return {bounds_[block_count() + block], bounds_[block]};
  }
  void set(std::size_t block, Bounds bounds) {
    bounds_[block] = bounds.high;
    bounds_[block_count() + block] = bounds.low;
  }
  void bound_cells(const Grid<double>& nodes, const ProgressCallback& progress);
  void bound_blocks(int level);

  std::vector<Level> levels_;
  std::vector<float> bounds_;
};

}  // namespace landfall
