// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/numerics/random.h"

namespace landfall {

struct RangeTimerParameters {
  double jitter_sigma_s = 0;        ///< one sigma of a time of flight, per pixel and pulse, >= 0
  double pixel_offset_sigma_m = 0;  ///< one sigma of the offset that a pixel keeps for the whole scan, >= 0
  std::vector<double> pixel_offset_m{};  ///< or the offsets of all pixels, with sigma 0; empty: drawn
  double clock_scale_ppm = 0;            ///< the clock's period is too short by this; in [-1e5, 1e5]
  double timer_step_s = 0;  ///< a time of flight is rounded to a multiple of it, >= 0; 0: not rounded
};

/// The clock that measures the time of flight, r = c t/2:
///   r' = q round((1 + 1e-6 clock_scale_ppm)(r + c/2 jitter + offset)/q),   q = c/2 timer_step.
/// Every draw is a function of (seed, draw, cause, pulse, pixel).
class RangeTimer {
 public:
  /// Without any error.
  RangeTimer() : RangeTimer({}, 0, 0) {}
  /// Throws UsageError, naming the key and the bound, for a parameter out of range.
  RangeTimer(RangeTimerParameters parameters, std::size_t pixels, RandomSeed seed);

  /// False: apply() changes nothing.
  [[nodiscard]] bool is_on() const { return is_on_; }
  /// The ranges of return `number` (0: the first) of all pixels, metres; NaN stays NaN.
  void apply(std::int64_t pulse, std::int64_t number, std::span<double> ranges_m) const;

 private:
  RangeTimerParameters parameters_;  ///< pixel_offset_m also if drawn; empty without offsets
  RandomField jitter_;
  bool is_on_;
};

}  // namespace landfall
