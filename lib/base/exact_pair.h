// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

namespace landfall {

/// A rounded value and its rounding error, whose unevaluated sum is exact.
struct ExactPair {
  double value;
  double rest;
};

/// a + b (Knuth), for finite numbers whose sum does not overflow.
inline ExactPair exact_sum(double a, double b) {
  const double value = a + b;
  const double b_part = value - a;
  return {value, (a - (value - b_part)) + (b - b_part)};
}

/// a b, where neither product nor rest over- or underflows.
inline ExactPair exact_product(double a, double b) {
  const double value = a * b;
  return {value, std::fma(a, b, -value)};
}

}  // namespace landfall
