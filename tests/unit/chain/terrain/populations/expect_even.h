// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace landfall {

/// Expects the mean and standard deviation of a uniform distribution on [a, b], within 4 standard errors.
inline void expect_even(const std::vector<double>& list, double a, double b) {
  double sum = 0;
  double squares = 0;
  for (const double value : list) {
    EXPECT_GE(value, a);
    EXPECT_LE(value, b);
    const double z = (value - (a + b) / 2) / ((b - a) / std::sqrt(12.0));
    sum += z;
    squares += z * z;
  }
  const double n = static_cast<double>(list.size());
  EXPECT_NEAR(sum / n, 0, 4 / std::sqrt(n));
  EXPECT_NEAR(squares / n, 1, 4 * std::sqrt(0.8 / n));  // the kurtosis is 1.8
}

}  // namespace landfall
