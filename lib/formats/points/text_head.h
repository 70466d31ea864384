// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "formats/points/cloud_bytes.h"
#include "formats/points/text_cells.h"

namespace landfall {

/// A line at the beginning of a text.
struct HeadLine {
  std::string_view text;
  std::size_t at = 0;      ///< its offset
  std::size_t number = 1;  ///< for messages
};

/// The complete lines at the beginning of a file, without empty ones.
struct TextHead {
  std::vector<std::string_view> comments;  ///< the first 65,536 of those before the first other line
  std::vector<HeadLine> lines;             ///< the others
  std::size_t end = 0;                     ///< offset behind them
};

/// The beginning of a text with its comments, its header and a row, unless that takes more than 64 MiB.
[[nodiscard]] std::vector<std::byte> beginning_of_text(const CloudBytes& file);

/// `is_all`: the text is the whole file, so that its last line is complete.
[[nodiscard]] TextHead text_head(std::string_view text, bool is_all);

/// True for text whose lines are points: rows of as many numbers, at least three, under a header with x, y
/// and z or none.
[[nodiscard]] bool holds_rows_of_points(const TextHead& head);

/// True for the header of a PTX: columns, rows, four lines of three numbers, four of four.
[[nodiscard]] bool is_ptx(const TextHead& head);

/// True for the text formats of grids: Esri (ncols), Surfer (DSAA), GRASS (north:).
[[nodiscard]] bool is_grid_text(std::string_view text);

}  // namespace landfall
