// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "raster/grid.h"

namespace landfall {

/// A rectangle, in cells from node (0, 0).
struct CellBox {
  double low_x;
  double high_x;
  double low_y;
  double high_y;
};

/// How low and how high the surface gets, over square blocks of cells: blocks of 4 x 4 cells on level 0, of
/// four blocks of the level below on each further level, one block on the last. Single precision, `low`
/// rounded down and `high` up; a block that has no finite node has low = +infinity, high = -infinity.
class ElevationPyramid {
 public:
  static constexpr int kLog2BlockCells = 2;
  static constexpr std::int64_t kBlockCells = 1 << kLog2BlockCells;

  struct Level {
    std::int64_t rows = 0;
    std::int64_t cols = 0;
    std::vector<float> low;
    std::vector<float> high;

    [[nodiscard]] std::size_t index(BinIndex block) const {
      return static_cast<std::size_t>(block.row * cols + block.col);
    }
  };

  /// O(nodes); the nodes must be at least 2 x 2.
  explicit ElevationPyramid(const Grid<double>& nodes);

  [[nodiscard]] int level_count() const { return static_cast<int>(levels_.size()); }
  [[nodiscard]] const Level& level(int level) const { return levels_[static_cast<std::size_t>(level)]; }
  struct Bounds {
    float low = std::numeric_limits<float>::infinity();
    float high = -std::numeric_limits<float>::infinity();
  };
  /// Of the few blocks, at most 2 x 2, that the box widened by 1/16 cell touches: bounds of the surface over
  /// the box, not the closest. O(levels).
  [[nodiscard]] Bounds over(const CellBox& box) const;
  [[nodiscard]] float lowest() const { return levels_.back().low.front(); }
  [[nodiscard]] float highest() const { return levels_.back().high.front(); }

 private:
  std::vector<Level> levels_;
};

}  // namespace landfall
