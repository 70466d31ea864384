// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scanner/pattern.h"
#include "scanner/raster_order.h"

namespace landfall {

struct LineSearchParameters {
  int rows = 200;            ///< 1 .. 2^20
  int columns = 200;         ///< 1 .. 2^20
  double half_width_m = 50;  ///< E, finite and positive
  LineDirection direction = LineDirection::unidirectional;
  bool compensated = true;
  AtEnd at_end = AtEnd::wrap;
  bool ramped = false;  ///< y falls evenly from pulse to pulse instead of from line to line
};

/// A raster over a square. Pulse k is on line l = k div columns, in column c = k mod columns, and aims at
/// (-E + 2E c/(columns - 1), E - 2E l/(rows - 1), 0): from the upper left to the lower right corner, line by
/// line. A single row or column aims at 0 on that axis; boustrophedon runs odd lines backwards. After
/// N = rows x columns pulses it begins again, or the scan stops.
///
/// Ramped, y = E - 2E k/(N - 1) (0 for a single row): the slow axis moves evenly instead of in steps. The
/// corners stay the same.
class LineSearch : public Pattern {
 public:
  /// Throws UsageError, naming the key and the bound, for a parameter out of range.
  explicit LineSearch(const LineSearchParameters& parameters);

  [[nodiscard]] std::optional<Point<DemFrame>> ground_aim(const PulseTime& pulse) const override;
  /// Every line begins with a jump, also where the mirror only reverses (boustrophedon).
  [[nodiscard]] std::optional<PatternJump> last_jump(const PulseTime& pulse) const override;
  [[nodiscard]] std::optional<std::int64_t> pulse_limit() const override;

 private:
  [[nodiscard]] RasterOrder order() const;

  LineSearchParameters parameters_;
};

}  // namespace landfall
