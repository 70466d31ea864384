// SPDX-License-Identifier: GPL-3.0-or-later
// Elementary functions in SIMD lanes. They use only operations that IEEE 754 rounds in one way, in one order,
// so that every processor and compiler gives the same bits. Compiled once for each instruction set (Highway).

#include "base/numerics/lanes-inl.h"

#if defined(LANDFALL_BASE_ELEMENTARY_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LANDFALL_BASE_ELEMENTARY_INL_H_
#undef LANDFALL_BASE_ELEMENTARY_INL_H_
#else
#define LANDFALL_BASE_ELEMENTARY_INL_H_
#endif

#include <array>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

using Bits = hn::RebindToUnsigned<D>;

/// A polynomial by Horner's rule, coefficients from the highest power down. MulAdd is fused on some targets.
template <std::size_t N>
HWY_INLINE V Polynomial(const std::array<double, N>& coefficients, V x) {
  V sum = constant(coefficients[0]);
  for (std::size_t i = 1; i < N; ++i) sum = hn::Add(hn::Mul(sum, x), constant(coefficients[i]));
  return sum;
}

/// Natural logarithm for normal, positive x, below 1 ulp: the method of fdlibm's e_log.c. x = 2^k m, m in
/// [sqrt(1/2), sqrt(2)), f = m - 1, s = f / (2 + f), log m = f - f^2 / 2 + s (f^2 / 2 + R(s^2)).
HWY_INLINE V Log(V x) {
  constexpr std::array kR = {0x1.2f112df3e5244p-3, 0x1.39a09d078c69fp-3, 0x1.7466496cb03dep-3,
                             0x1.c71c51d8e78afp-3, 0x1.2492494229359p-2, 0x1.999999997fa04p-2,
                             0x1.5555555555593p-1};
  constexpr double kLn2High = 0x1.62e42feep-1;  // k times this is exact
  constexpr double kLn2Low = 0x1.a39ef35793c76p-33;
  constexpr std::uint64_t kRootHalf = 0x3fe6a09e00000000;
  constexpr std::uint64_t kOne = 0x3ff0000000000000;
  constexpr std::uint64_t kTwo52 = 0x4330000000000000;
  const auto set = [](std::uint64_t bits) { return hn::Set(Bits(), bits); };
  const auto shifted = hn::Add(hn::BitCast(Bits(), x), set(kOne - kRootHalf));
  const auto fraction = hn::And(shifted, set(0x000fffffffffffff));
  const V m = hn::BitCast(D(), hn::Add(fraction, set(kRootHalf)));
  // Converts the exponent through the low bits of 2^52 + exponent, which every target supports.
  const V exponent = hn::BitCast(D(), hn::Or(hn::ShiftRight<52>(shifted), set(kTwo52)));
  const V k = hn::Sub(exponent, constant(0x1p52 + 1023));
  const V f = hn::Sub(m, constant(1));
  const V s = hn::Div(f, hn::Add(constant(2), f));
  const V z = hn::Mul(s, s);
  const V r = hn::Mul(z, Polynomial(kR, z));
  const V half_square = hn::Mul(constant(0.5), hn::Mul(f, f));
  const V small = hn::Add(hn::Mul(s, hn::Add(half_square, r)), hn::Mul(k, constant(kLn2Low)));
  return hn::Sub(hn::Mul(k, constant(kLn2High)), hn::Sub(hn::Sub(half_square, small), f));
}

/// e^x for x <= 709, relative error below 1e-14; 0 for x < -700. x = k log 2 + r, |r| <= log(2)/2, and e^r by
/// its Taylor series.
HWY_INLINE V Exp(V x) {
  constexpr std::array kInverseFactorials = {1.0 / 39916800, 1.0 / 3628800, 1.0 / 362880, 1.0 / 40320,
                                             1.0 / 5040,     1.0 / 720,     1.0 / 120,    1.0 / 24,
                                             1.0 / 6,        1.0 / 2,       1.0,          1.0};
  constexpr double kLn2High = 0x1.62e42feep-1;  // k times this is exact
  constexpr double kLn2Low = 0x1.a39ef35793c76p-33;
  constexpr double kRounder = 0x1.8p52;  // a sum with it is rounded to an integer, which its low bits hold
  const V rounded = hn::Add(hn::Mul(x, constant(0x1.71547652b82fep+0)), constant(kRounder));
  const V k = hn::Sub(rounded, constant(kRounder));
  const V r = hn::Sub(hn::Sub(x, hn::Mul(k, constant(kLn2High))), hn::Mul(k, constant(kLn2Low)));
  const auto power =
      hn::ShiftLeft<52>(hn::Add(hn::BitCast(Bits(), rounded), hn::Set(Bits(), std::uint64_t{1023})));
  const V value = hn::Mul(Polynomial(kInverseFactorials, r), hn::BitCast(D(), power));
  return hn::IfThenZeroElse(hn::Lt(x, constant(-700)), value);
}

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // LANDFALL_BASE_ELEMENTARY_INL_H_
