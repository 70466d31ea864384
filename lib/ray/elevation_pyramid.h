// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "raster/grid.h"

namespace landfall {

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
  [[nodiscard]] float lowest() const { return levels_.back().low.front(); }
  [[nodiscard]] float highest() const { return levels_.back().high.front(); }

 private:
  std::vector<Level> levels_;
};

}  // namespace landfall
