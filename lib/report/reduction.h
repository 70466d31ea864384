// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "raster/grid.h"

namespace landfall::html_report {

/// What a square block of bins becomes when a map is made smaller. NaN and infinite values do not count; a
/// block without another value is NaN.
enum class Rule {
  mean,
  extreme,  ///< the value of the largest magnitude, its sign kept; of two equal ones the positive one
  largest,
  least,
  any_bit,  ///< of integers: the bits that any bin has
};

/// A map made smaller: block (r, c) covers the bins from (r factor, c factor); those at the upper and right
/// border may be cut short.
struct ReducedMap {
  std::int64_t factor = 1;
  std::int64_t rows = 0;
  std::int64_t cols = 0;
  std::vector<double> cells;  ///< row-major, y ascending
};

/// The least whole number of bins a side of a block for at most `most_cells` (>= 1) blocks along either axis.
[[nodiscard]] std::int64_t reduction_factor(const GridSpec& spec, std::int64_t most_cells);

/// T: double, float, std::int32_t or std::int8_t. The result does not depend on the number of threads.
template <class T>
[[nodiscard]] ReducedMap reduce(const Grid<T>& layer, std::int64_t factor, Rule rule);

}  // namespace landfall::html_report
