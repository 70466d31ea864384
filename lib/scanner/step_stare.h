// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scanner/pattern.h"
#include "scanner/raster_order.h"

namespace landfall {

struct StepStareParameters {
  int rows = 10;             ///< 1 .. 2^20
  int columns = 10;          ///< 1 .. 2^20
  double half_width_m = 50;  ///< E, finite and positive
  int pulses_per_step = 1;   ///< n, 1 .. 2^20
  LineDirection direction = LineDirection::boustrophedon;
  bool compensated = true;
  AtEnd at_end = AtEnd::wrap;
};

/// A mosaic of a flash array: a square of half width E is divided into rows x columns tiles, and the
/// boresight dwells on a tile's centre for n pulses, then steps to the next. Pulse k is on step j = k div n,
/// at row l = j div columns and column c = j mod columns (odd rows reversed: boustrophedon), and aims at (-E
/// + 2E (c + 1/2)/columns, E - 2E (l + 1/2)/rows, 0). Images of 2E/columns x 2E/rows cover the square without
/// overlap. After rows x columns steps it starts again, or the scan stops.
class StepStare : public Pattern {
 public:
  /// Throws UsageError, naming the key and the bound, for a parameter out of range.
  explicit StepStare(const StepStareParameters& parameters);

  [[nodiscard]] std::optional<Point<DemFrame>> ground_aim(const PulseTime& pulse) const override;
  /// Every step is a jump.
  [[nodiscard]] std::optional<PatternJump> last_jump(const PulseTime& pulse) const override;
  [[nodiscard]] std::optional<std::int64_t> pulse_limit() const override;

 private:
  [[nodiscard]] RasterOrder order() const;

  StepStareParameters parameters_;
};

}  // namespace landfall
