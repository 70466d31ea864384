// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "raster/grid.h"

namespace landfall::html_report {

/// The rule by which a square block of bins is reduced to one value. NaN and infinite values are ignored; a
/// block without any other value becomes NaN.
enum class Rule {
  mean,
  extreme,  ///< the value of the largest magnitude with its sign; the positive one of two equal magnitudes
  largest,
  least,
  any_bit,  ///< for integers: the bits that are set in any bin
};

/// A reduced map: block (r, c) covers the bins from (r factor, c factor) on; blocks at the upper and right
/// border may be smaller.
struct ReducedMap {
  std::int64_t factor = 1;
  std::int64_t rows = 0;
  std::int64_t cols = 0;
  std::vector<double> cells;  ///< row-major, y ascending
};

/// The least block size, in bins a side, that gives at most `max_cells` (>= 1) blocks along either axis.
[[nodiscard]] std::int64_t reduction_factor(const GridSpec& spec, std::int64_t max_cells);

/// T: double, float, std::int32_t or std::int8_t. The result does not depend on the number of threads.
template <class T>
[[nodiscard]] ReducedMap reduce(const Grid<T>& layer, std::int64_t factor, Rule rule);

}  // namespace landfall::html_report
