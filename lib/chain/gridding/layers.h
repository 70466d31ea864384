// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D5
#pragma once

#include <limits>

#include "chain/gridding/accumulator.h"

namespace landfall {

/// The point at which the true elevation of a bin is taken.
enum class TruthAt {
  bin_center,  ///< under the true position of the bin's centre
  centroid,    ///< at the weighted mean of the true positions
};

/// The true elevation of a bin of returns. bin_center: H(X + dx, Y + dy), (X, Y) the bin's centre, (dx, dy)
/// the bin's x_offset, y_offset. centroid: H(x_true, y_true). NaN off the terrain and where the bin is empty.
/// `elevation`: H(x, y), metres, frame D.
[[nodiscard]] inline double true_elevation(const BinValues& values, const GridSpec& spec, BinIndex bin,
                                           const auto& elevation, TruthAt truth_at) {
  if (values.count == 0) return std::numeric_limits<double>::quiet_NaN();
  if (truth_at == TruthAt::centroid) return elevation(values.x_true, values.y_true);
  return elevation(spec.x(bin.col) + values.x_offset, spec.y(bin.row) + values.y_offset);
}

}  // namespace landfall
