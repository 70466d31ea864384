// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "scanner/pattern.h"

namespace landfall {

enum class LineDirection {
  unidirectional,  ///< every line from left to right
  boustrophedon,   ///< odd lines from right to left
};

enum class AtEnd { wrap, stop };

/// The order in which the positions of a raster are visited: line by line from the top.
struct RasterOrder {
  int rows = 1;     ///< 1 .. 2^20
  int columns = 1;  ///< 1 .. 2^20
  LineDirection direction = LineDirection::unidirectional;
  AtEnd at_end = AtEnd::wrap;
};

/// The position in a raster at one step.
struct RasterPosition {
  std::int64_t row = 0;     ///< counted from the top
  std::int64_t column = 0;  ///< counted from the left
  std::int64_t step = 0;    ///< in this pass over the raster
};

/// Throws UsageError, naming the pattern's key and the bound, where rows or columns is out of range.
void check_raster(const RasterOrder& order);

/// Positions in one pass.
[[nodiscard]] std::int64_t raster_steps(const RasterOrder& order);

/// The position at a step >= 0, counted over all passes; empty past the end of a raster that stops.
[[nodiscard]] std::optional<RasterPosition> raster_position(const RasterOrder& order, std::int64_t step);

/// The last jump of a pattern that jumps after every `length` pulses, to a new line or step; empty before the
/// first jump.
[[nodiscard]] std::optional<PatternJump> jump_to_piece(const PulseTime& pulse, std::int64_t length);

}  // namespace landfall
