// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "base/numerics/random.h"

namespace landfall {

/// A stationary first-order Gauss-Markov process with mean 0 and sigma 1 at the pulses 0 .. 2^31: Cov(x_i,
/// x_j) = exp(-|i - j| h / tau), h the interval of the pulses. A pure function of the pulse: nothing is
/// stored, and any thread may ask for any pulse in any order.
///
/// Between the pulses a and a + 2m, whose values are known, the middle one is normal with the mean
/// (x_a + x_(a + 2m)) / (2 cosh(m h / tau)) and the variance tanh(m h / tau) (the process is a Markov one, so
/// that nothing beyond the two matters). Halving leads from a block of 2^n pulses to any pulse in at most n
/// steps, each with the draw of its own pulse. n is the smallest one with 2^n h > 40 tau, at most 31; the
/// first pulses of two such blocks are correlated by e^-40 = 4e-18 or less, and this correlation is left out.
/// As tau goes to 0, x_i is the draw of pulse i.
class PulseProcess {
 public:
  /// `share` is h / tau, finite and positive.
  explicit PulseProcess(double share);

  /// x of a pulse in 0 .. 2^31 - 1, from the draws (pulse, axis) of the field.
  [[nodiscard]] double at(std::int64_t pulse, const RandomField& field, std::uint64_t axis) const;

 private:
  struct Step {
    double kept = 0;     ///< of the sum of the two neighbours
    double renewed = 1;  ///< times a standard normal draw
  };
  int levels_ = 0;
  Step across_{};                ///< from the begin of a block to its end
  std::array<Step, 31> middle_;  ///< [n]: of two pulses 2^(n + 1) apart
};

}  // namespace landfall
