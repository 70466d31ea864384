// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "chain/draws/pass_rate.h"

namespace landfall {

/// Wald's sequential probability ratio test of a pass probability p: p0 (good) against p1 (bad).
struct SprtParameters {
  double p0 = 0.99;
  double p1 = 0.97;     ///< < p0
  double alpha = 0.05;  ///< nominal probability of rejecting where p = p0
  double beta = 0.05;   ///< nominal probability of accepting where p = p1
  friend bool operator==(const SprtParameters&, const SprtParameters&) = default;
};

/// Throws UsageError, naming the key, unless 0 < p1 < p0 < 1 and alpha and beta lie in (0, 0.5).
void check(const SprtParameters& parameters);

enum class SprtState { running, accepted, rejected };

/// Stops at the first draw after which L = passes ln(p1 / p0) + fails ln((1 - p1) / (1 - p0)), the logarithm
/// of the likelihood ratio, reaches a limit (Wald 1947): accepted where L <= ln(beta / (1 - alpha)), rejected
/// where L >= ln((1 - beta) / alpha), each with a tolerance of 1e-9 that absorbs rounding (D305). L is
/// computed from the counts, so that it does not accumulate errors.
///
/// L jumps over the limits, so that the true error rates differ from alpha and beta: they are at most
/// alpha / (1 - beta) and beta / (1 - alpha), and their sum at most alpha + beta. Intervals of the pass rate
/// are not valid after a stop, because the results decided the number of draws.
class Sprt {
 public:
  /// Throws as check().
  explicit Sprt(const SprtParameters& parameters);

  /// Adds the result of the next draw; the state must be `running`.
  void add(bool passed);

  [[nodiscard]] SprtState state() const { return state_; }
  [[nodiscard]] const PassRate& rate() const { return rate_; }

 private:
  double pass_;    ///< what a pass adds to L, < 0
  double fail_;    ///< what a failure adds to L, > 0
  double accept_;  ///< limits of L
  double reject_;
  PassRate rate_;
  SprtState state_ = SprtState::running;
};

}  // namespace landfall
