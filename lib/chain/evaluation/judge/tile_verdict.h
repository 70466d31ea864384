// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "chain/evaluation/judge/window_judge.h"
#include "chain/evaluation/parameters.h"

namespace landfall {

/// The largest footprint of a TileJudge: 257 bins on a side.
inline constexpr std::int64_t kMaxHalfBins = 128;

/// The windows on an edge of a tile: few enough that their means are alike, and enough to share the errors
/// that they reach.
[[nodiscard]] inline std::int64_t tile_edge(const Footprint& footprint) {
  return std::max<std::int64_t>(64, 2 * footprint.half_bins());
}

/// The counts that decide the accuracy requirements, of a tile or added up.
struct TileVerdict {
  WindowJudge::Outcome x, y, z;     ///< relative errors
  WindowJudge::Outcome horizontal;  ///< the absolute one; its footprints have a value in x and in y
  bool has_unusual = false;  ///< infinite values, or so large errors that sums may overflow: no counts then

  TileVerdict& operator+=(const TileVerdict& other);
};

/// Judges the footprints of one tile after another.
class TileJudge {
 public:
  TileJudge(const DemLayers& dem, const BinMask& region, const EvaluationParameters& parameters,
            const Footprint& footprint, Grid<std::int8_t>& fail);
  TileVerdict judge(const Tile& tile);

 private:
  [[nodiscard]] bool is_outside(const Tile& tile) const;
  [[nodiscard]] bool has_infinite_layer(const Tile& tile) const;
  void judge_horizontal(const Tile& tile, std::int64_t footprints, WindowJudge::Outcome& outcome);
  void judge_means(const Tile& tile, WindowJudge::Outcome& outcome);

  const DemLayers& dem_;
  const BinMask& region_;
  EvaluationLimits limits_;  ///< effective_limits()
  const Footprint& footprint_;
  Grid<std::int8_t>& fail_;
  TileErrors x_, y_, z_;
  WindowJudge judge_x_, judge_y_, judge_z_;
};

}  // namespace landfall
