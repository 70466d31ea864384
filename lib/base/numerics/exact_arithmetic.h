// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <limits>

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

/// The product a b, if neither it nor its rounding error over- or underflows.
inline ExactPair exact_product(double a, double b) {
  const double value = a * b;
  return {value, std::fma(a, b, -value)};
}

/// IEEE 754 binary128: the same bits on every processor, where long double is 80 bits long on x86-64 and 128
/// on arm64. The processor has no such numbers, so that an operation takes some 30 ns.
#ifdef __SIZEOF_FLOAT128__
__extension__ typedef __float128 Quad;
#else
using Quad = long double;
static_assert(std::numeric_limits<Quad>::digits == 113);
#endif

/// a b - product without an error, where `product` is their product after rounding (Dekker, 1971).
inline Quad product_rest(Quad a, Quad b, Quad product) {
  const auto high_half = [](Quad x) {
    const Quad scaled = x * Quad{144115188075855873};  // 2^57 + 1
    return scaled - (scaled - x);
  };
  const Quad a_high = high_half(a), a_low = a - a_high;
  const Quad b_high = high_half(b), b_low = b - b_high;
  return ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
}

}  // namespace landfall
