// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "scanner/pattern.h"

namespace landfall {

struct RosetteParameters {
  double radius_m = 50;                        ///< R, finite and positive
  std::array<double, 2> rates_hz{100, -61.8};  ///< f1, f2; finite; positive is counter-clockwise on the map
  std::array<double, 2> phases_rad{0, 0};      ///< finite
  bool compensated = true;
};

/// Two phasors of equal length, which two equal Risley prisms trace to first order:
///   x + i y = R/2 (e^{i (2 pi f1 t + phi1)} + e^{i (2 pi f2 t + phi2)}),
/// t the time since the first pulse. The pattern fills the circle of radius R, most densely at its rim and
/// centre. For f2/f1 = p/q in lowest terms it closes after q turns of the first phasor and has |p - q|
/// petals; with an irrational ratio it never closes. f2 = -f1 gives a line, f2 = f1 a circle.
class Rosette : public Pattern {
 public:
  /// Throws UsageError, naming the key and the bound, for a parameter out of range.
  explicit Rosette(const RosetteParameters& parameters);

  [[nodiscard]] std::optional<Point<DemFrame>> ground_aim(const PulseTime& pulse) const override;

 private:
  RosetteParameters parameters_;
};

}  // namespace landfall
