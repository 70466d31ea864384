// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

#include "chain/gridding/accumulator.h"
#include "chain/gridding/grid_points.h"

namespace landfall {

/// The sums that a bin keeps of its returns: all that BinValues need. Zero bytes are an empty bin. The eight
/// sums are contiguous because add_returns() processes them as vectors.
struct BinSums {
  double weight;    ///< sum w
  double w_dz;      ///< sum w (z_est - z_first): small numbers, so that squares do not cancel
  double w_dz_dz;   ///< sum w (z_est - z_first)^2
  double w_x_true;  ///< sum w x_true, and so on
  double w_y_true;
  double w_x_est;
  double w_y_est;
  double w_t;
  double z_first;  ///< z_est of the bin's first return, m
  std::int32_t count;
};
static_assert(sizeof(BinSums) == 80);

/// The values of the sums: weighted means, and z_est exact where all elevations are equal.
[[nodiscard]] BinValues values_of(const BinSums& sums);

/// Adds one return to its bin.
void add_return(const GridPoints& points, std::size_t i, double weight, BinSums& bin);

}  // namespace landfall
