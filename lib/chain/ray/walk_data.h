// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

#include "chain/ray/pyramid_traversal.h"

namespace landfall {

/// The number of rays that are prepared together.
inline constexpr std::size_t kChunkRays = 64;

/// GridRays component by component. A downward ray passes horizontal position foot + slope * elevation;
/// foot_x is NaN for other rays.
struct RayChunk {
  alignas(64) double x[kChunkRays], y[kChunkRays], z[kChunkRays];
  alignas(64) double dx[kChunkRays], dy[kChunkRays], dz[kChunkRays];
  alignas(64) double position_error[kChunkRays], height_error[kChunkRays];
  alignas(64) double climb[kChunkRays];  ///< 1 / dz
  alignas(64) double foot_x[kChunkRays], foot_y[kChunkRays];
  alignas(64) double slope_x[kChunkRays], slope_y[kChunkRays];
  alignas(64) double range[kChunkRays];
  double greatest_slope;  ///< cells per metre, of the downward rays
};

/// The elevations between which rays are examined. It is certain that no downward ray of the group meets the
/// surface above `high`; `low` is a guess that holes may contradict.
struct HeightSlab {
  double low;
  double high;
};

/// The data that lanes walk over: levels of square blocks, 4^level cells wide, up to a single block for
/// the grid or the last level that fits.
struct WalkTerrain {
  static constexpr int kMaxLevels = 8;

  const float* highs;  ///< ElevationPyramid::highs, lows
  double to_lows;      ///< blocks from highs to lows
  const double* nodes;
  std::int64_t node_cols;
  double rows, cols;  ///< cells
  double lowest, highest;
  int top_level = 0;
  alignas(64) double size[kMaxLevels];        ///< edge of a block, cells
  alignas(64) double per_size[kMaxLevels];    ///< its inverse
  alignas(64) double first[kMaxLevels];       ///< first block of each level, in `highs`
  alignas(64) double block_cols[kMaxLevels];  ///< columns of blocks of each level

  explicit WalkTerrain(const Heightfield& field)
      : highs(field.pyramid.highs().data()),
        to_lows(static_cast<double>(field.pyramid.lows().data() - field.pyramid.highs().data())),
        nodes(field.terrain.nodes().values().data()),
        node_cols(field.spec().cols),
        rows(static_cast<double>(field.spec().rows - 1)),
        cols(static_cast<double>(field.spec().cols - 1)),
        lowest(field.pyramid.lowest()),
        highest(field.pyramid.highest()) {
    for (int level = 0; level < kMaxLevels; ++level) {
      const int pyramid_level = level == 0 ? 0 : 2 * level - 1;
      if (pyramid_level < field.pyramid.level_count()) top_level = level;
      const ElevationPyramid::Level& blocks = field.pyramid.level(top_level == 0 ? 0 : 2 * top_level - 1);
      size[level] = static_cast<double>(std::int64_t{1} << (2 * level));
      per_size[level] = 1 / size[level];
      first[level] = static_cast<double>(blocks.first);
      block_cols[level] = static_cast<double>(blocks.cols);
    }
  }
};

}  // namespace landfall
