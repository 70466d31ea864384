// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "gridding/accumulator.h"

namespace landfall {

/// The return that represents a bin, or the mean of two, in methods that choose a return.
struct ChosenReturn {
  double z, x_true, y_true, x_est, y_est, t;
};

/// The values of a bin of `count` (> 0) returns without weights, one of which was chosen.
[[nodiscard]] inline BinValues values_of(const ChosenReturn& chosen, std::int32_t count, double z_spread) {
  return {.count = count,
          .weight_sum = static_cast<double>(count),
          .z_est = chosen.z,
          .x_true = chosen.x_true,
          .y_true = chosen.y_true,
          .x_est = chosen.x_est,
          .y_est = chosen.y_est,
          .x_offset = chosen.x_true - chosen.x_est,
          .y_offset = chosen.y_true - chosen.y_est,
          .t = chosen.t,
          .z_spread = z_spread};
}

}  // namespace landfall
