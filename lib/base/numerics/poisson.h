// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace landfall {

/// Independent random numbers from which a count is drawn.
struct PoissonDraw {
  double normal = 0;   ///< standard normal; decides for large means
  double uniform = 0;  ///< in [0, 1); decides for small means
};

/// The mean from which on `normal` decides.
inline constexpr double kLargePoissonMean = 16;

/// A Poisson count of the given mean >= 0, finite. Small means: the least n with P(count <= n) > uniform.
/// Large means: the floor of the Cornish-Fisher expansion of the inverse distribution to the order 1/mean
/// (Giles 2016, ACM TOMS 42(1), 7), which differs from the exact count for less than 1 draw in 2000.
[[nodiscard]] double poisson_count(double mean, const PoissonDraw& draw);

}  // namespace landfall
