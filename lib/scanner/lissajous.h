// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "scanner/pattern.h"

namespace landfall {

struct LissajousParameters {
  std::array<double, 2> half_width_m{50, 50};  ///< A_x, A_y; finite and positive
  std::array<double, 2> rates_hz{65, 65.5};    ///< f_x, f_y; finite and >= 0
  double phase_rad = 0;                        ///< phi, finite
  bool compensated = true;
};

/// Two harmonic axes, as a mirror oscillating at its resonances moves:
///   x = A_x sin(2 pi f_x t + phi),  y = A_y sin(2 pi f_y t),
/// t the time since the first pulse. The pattern fills the rectangle +-A_x, +-A_y, most densely at corners
/// and edges. For f_x/f_y = p/q in lowest terms it closes after q/f_y.
class Lissajous : public Pattern {
 public:
  /// Throws UsageError, naming the key and the bound, for a parameter out of range.
  explicit Lissajous(const LissajousParameters& parameters);

  [[nodiscard]] std::optional<Point<DemFrame>> ground_aim(const PulseTime& pulse) const override;

 private:
  LissajousParameters parameters_;
};

}  // namespace landfall
