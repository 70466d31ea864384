// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "base/numerics/random.h"
#include "base/returns/pulse_pixel.h"

namespace landfall {

/// The key of the noise that depends on the incidence.
inline constexpr const char* kIncidenceNoise = "incidence_sigma_rad";

struct RangeErrorParameters {
  double range_sigma_m = 0;        ///< one sigma, >= 0
  double range_bias_m = 0;         ///< added to every range
  double dead_pixel_frac = 0;      ///< probability that a pixel is dead in all pulses, in [0, 1]
  double dropout_frac = 0;         ///< probability that a pixel misses one pulse, in [0, 1]
  double range_sigma_per_m = 0;    ///< k >= 0: noise that grows with range
  double incidence_sigma_rad = 0;  ///< a >= 0: half-width of a pixel's beam, one sigma
  double false_return_frac = 0;    ///< probability of a false detection per pixel and pulse, in [0, 1]
  double false_min_m = 0;          ///< false ranges lie in [min, max), 0 <= min < max
  double false_max_m = 1000;
};

/// The receiver's effect on a range. Every draw is a function of (seed, draw, stream, pulse, pixel), and each
/// cause has its own stream: no result depends on the order of calls, on the number of threads, or on which
/// of the other errors are enabled.
class RangeErrors {
 public:
  /// Throws UsageError, naming the key and the bound, for a parameter out of range.
  RangeErrors(const RangeErrorParameters& parameters, RandomSeed seed);

  [[nodiscard]] const RangeErrorParameters& parameters() const { return parameters_; }
  [[nodiscard]] RandomSeed seed() const { return seed_; }
  /// False: sigma_m() is range_sigma_m.
  [[nodiscard]] bool has_varying_sigma() const { return !has_constant_sigma_; }
  /// False: every sigma is 0, and no noise is drawn.
  [[nodiscard]] bool is_noisy() const { return is_noisy_; }
  /// Whether the pixel is dead: one Bernoulli draw per pixel, for all pulses.
  [[nodiscard]] bool is_dead(std::int64_t pixel) const;
  /// Whether each pixel of a pulse, from pixel 0 on, misses it: one Bernoulli draw per pixel and pulse. All
  /// at once, for single draws take more than twice as long.
  void find_dropouts(std::int64_t pulse, std::span<std::int8_t> is_dropped) const;
  /// sigma^2 = range_sigma_m^2 + (range_sigma_per_m r)^2 + (incidence_sigma_rad r tan(incidence))^2. The last
  /// term is the depth of the ground patch under a pixel's beam, which stretches the pulse.
  [[nodiscard]] double sigma_m(double range_m, double tan_incidence) const;
  /// False: sigma does not depend on the incidence.
  [[nodiscard]] bool needs_incidence() const { return parameters_.incidence_sigma_rad > 0; }
  /// r + b + v, v ~ N(0, sigma) per pixel and pulse.
  [[nodiscard]] double measured_m(double range_m, PulsePixel where, double tan_incidence = 0) const;
  /// measured_m() for return `number` of all pixels of a pulse from pixel 0 on, many times faster; NaN stays
  /// NaN. All spans have the same length, but `tan_incidences` may be empty unless needs_incidence().
  void measure(std::int64_t pulse, std::span<const double> ranges_m, std::span<const double> tan_incidences,
               std::span<double> measured_m, std::int64_t number = 0) const;
  /// False: no pixel has a false detection.
  [[nodiscard]] bool has_false_returns() const { return parameters_.false_return_frac > 0; }
  /// The range of a false detection, uniform in its gate; empty without a false detection.
  [[nodiscard]] std::optional<double> false_return_m(PulsePixel where) const;

 private:
  RangeErrorParameters parameters_;
  RandomSeed seed_;
  RandomField dead_;
  RandomField dropout_;
  RandomField noise_;
  RandomField false_;
  bool has_constant_sigma_;
  bool is_noisy_;
};

}  // namespace landfall
