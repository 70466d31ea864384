// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "returns/columns.h"

namespace landfall {

/// Which columns of the points a batch holds.
enum class PointContent {
  all,
  estimate,  ///< those that errors change (ErrorEffect)
};

/// Consecutive pulses with all their pixels. Its memory is kept from one use to the next.
struct PulseBatch {
  PointColumns points;
  PulseColumns pulses;

  /// Room for every pixel of every pulse. Values are left as they are: whoever resizes fills all rows.
  void resize(std::size_t pulse_count, std::size_t pixel_count, PointContent content = PointContent::all);
  /// Rows per status, indexed by its value.
  [[nodiscard]] std::array<std::int64_t, kPointStatusCount> status_counts() const;
  /// Removes all points but returns and false returns; the order and the pulses stay.
  void keep_returns();
};

}  // namespace landfall
