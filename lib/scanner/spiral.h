// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scanner/pattern.h"

namespace landfall {

enum class SpiralDirection { outward, inward };

struct SpiralParameters {
  double radius_m = 50;       ///< R, finite, above inner_radius_m
  double pitch_m = 0.5;       ///< p, between neighbouring turns; finite and positive
  double inner_radius_m = 0;  ///< r0, finite and >= 0
  double period_s = 2;        ///< T, finite and positive
  SpiralDirection direction = SpiralDirection::outward;
  bool compensated = true;
};

/// An Archimedean spiral about the origin, traced so that every pulse sweeps the same area:
///   r(t) = sqrt(r0^2 + (R^2 - r0^2) t/T),  azimuth = 2 pi r/p, counter-clockwise from +x,
/// t the time since the first pulse. Turns lie p apart; from one pulse to the next the aim moves pi (R^2 -
/// r0^2)/(N p) along its turn, N = T x pulse rate. From T to 2 T it returns along the same path, and so on;
/// inward it begins at R. Near r = 0 the azimuth rate grows without bound, as 1/r.
class Spiral : public Pattern {
 public:
  /// Throws UsageError, naming the key and the bound, for a parameter out of range.
  explicit Spiral(const SpiralParameters& parameters);

  [[nodiscard]] std::optional<Point<DemFrame>> ground_aim(const PulseTime& pulse) const override;

 private:
  SpiralParameters parameters_;
};

}  // namespace landfall
