// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "base/random.h"

namespace landfall {

struct RangeErrorParameters {
  double range_sigma_m = 0;    ///< one sigma, >= 0
  double range_bias_m = 0;     ///< added to every range
  double dead_pixel_frac = 0;  ///< chance of a pixel to be dead for good, in [0, 1]
  double dropout_frac = 0;     ///< chance of a pixel to miss one pulse, in [0, 1]
};

/// One measurement: the pulse, counted from 0, and the pixel's row-major position on the detector.
struct PulsePixel {
  std::int64_t pulse = 0;
  std::int64_t pixel = 0;
};

/// What the receiver does to a range. Every draw is a function of (seed, stream, pulse, pixel), each cause
/// having a stream of its own: no result depends on the order of calls, on threads, or on which of the other
/// errors are on.
class RangeErrors {
 public:
  /// Throws UsageError, naming the key and the bound, for a parameter out of range.
  RangeErrors(const RangeErrorParameters& parameters, std::uint64_t seed);

  /// A fixed map: Bernoulli per pixel.
  [[nodiscard]] bool is_dead(std::int64_t pixel) const;
  /// Bernoulli per pixel and pulse.
  [[nodiscard]] bool is_dropped(PulsePixel where) const;
  /// r + b + v, v ~ N(0, sigma) per pixel and pulse.
  [[nodiscard]] double measured_m(double range_m, PulsePixel where) const;
  /// The same for all pixels of a pulse, from the first on, many times as fast; NaN stays NaN. Both spans
  /// have one length.
  void measure(std::int64_t pulse, std::span<const double> ranges_m, std::span<double> measured_m) const;

 private:
  RangeErrorParameters parameters_;
  RandomField dead_;
  RandomField dropout_;
  RandomField noise_;
};

}  // namespace landfall
