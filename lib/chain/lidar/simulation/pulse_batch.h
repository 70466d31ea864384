// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "base/returns/columns.h"

namespace landfall {

/// The columns of the points that a batch holds.
enum class PointContent {
  all,
  estimate,  ///< only the columns that errors change (ErrorEffect)
  places,    ///< only the status and the coordinates (kCoordinates)
};

/// Consecutive pulses with all their pixels. The memory is reused between batches.
struct PulseBatch {
  /// The return_number of a row of a pixel that has fewer returns.
  static constexpr std::int8_t kNoSuchReturn = -1;

  PointColumns points;
  PulseColumns pulses;
  EchoColumns later_echoes;  ///< those of the pulses filled so far, if they are kept
  bool keeps_later_echoes = false;

  /// Makes room for every pixel of every pulse. Values are not initialised: the caller fills all rows.
  /// `rows_per_pulse`: pixels times the largest number of returns of a pixel.
  void resize(std::size_t pulse_count, std::size_t rows_per_pulse, PointContent content = PointContent::all,
              const OptionalColumns& optional = {});
  /// Number of rows per status, indexed by its value.
  [[nodiscard]] std::array<std::int64_t, kPointStatusCount> status_counts() const;
  /// Removes all points except returns and false returns; the order and the pulses stay.
  void keep_returns();
  /// Removes the rows of returns that do not exist (kNoSuchReturn).
  void remove_absent_returns();

 private:
  void keep_rows(const auto& is_kept);
};

}  // namespace landfall
