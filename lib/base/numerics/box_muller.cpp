// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D66
#include "base/numerics/box_muller.h"

#include <algorithm>
#include <array>
#include <cassert>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/numerics/box_muller.cpp"
#include "base/numerics/elementary-inl.h"

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

/// The upper 26 bits of the significand: the product of two such numbers is exact.
HWY_INLINE V Upper(V x) {
  return hn::BitCast(D(),
                     hn::And(hn::BitCast(Bits(), x), hn::Set(Bits(), std::uint64_t{0xfffffffff8000000})));
}

/// sin(2 pi t), |t| <= 1/8, by its Taylor series; the first term is an exact product plus a remainder.
HWY_INLINE V SinTurns(V t) {
  constexpr std::array kOdd = {0x1.aaec32af93359p-4,  -0x1.6fadb9f155744p-1, 0x1.e8f434d018d63p+1,
                               -0x1.e3074fde8871fp+3, 0x1.50783487ee782p+5,  -0x1.32d2cce62bd86p+6,
                               0x1.466bc6775aae2p+6,  -0x1.4abbce625be53p+5};
  constexpr double kTwoPiHigh = 0x1.921fb58p+2;  // 26 bits
  constexpr double kTwoPiLow = -0x1.dde973dcb3b3ap-25;
  const V high = Upper(t);
  const V z = hn::Mul(t, t);
  const V rest =
      hn::Add(hn::Mul(hn::Sub(t, high), constant(kTwoPiHigh)),
              hn::Add(hn::Mul(t, constant(kTwoPiLow)), hn::Mul(hn::Mul(t, z), Polynomial(kOdd, z))));
  return hn::Add(hn::Mul(high, constant(kTwoPiHigh)), rest);
}

/// cos(2 pi t), |t| <= 1/8, by its Taylor series; (2 pi t)^2 / 2 is an exact product plus a remainder, and
/// the rounding error of 1 minus that product is added back.
HWY_INLINE V CosTurns(V t) {
  constexpr std::array kEven = {-0x1.2a0c591af8314p-5, 0x1.20c62c2f2d7f5p-2,  -0x1.b6e24f44b128fp+0,
                                0x1.f9d38a3763cc3p+2,  -0x1.a6d1f2a204a8cp+4, 0x1.e1f506891babbp+5,
                                -0x1.55d3c7e3cbffap+6, 0x1.03c1f081b5ac4p+6};
  constexpr double kTwoPiSquareHigh = 0x1.3bd3cc8000000p+4;  // 26 bits
  constexpr double kTwoPiSquareLow = 0x1.be45de5a4adc5p-24;
  const V t_high = Upper(t);
  const V z = hn::Mul(t, t);
  const V z_high = Upper(z);
  const V z_low =
      hn::Add(hn::Sub(hn::Mul(t_high, t_high), z_high), hn::Mul(hn::Sub(t, t_high), hn::Add(t, t_high)));
  const V square = hn::Mul(z_high, constant(kTwoPiSquareHigh));
  const V square_rest =
      hn::Add(hn::Mul(z_low, constant(kTwoPiSquareHigh)), hn::Mul(z, constant(kTwoPiSquareLow)));
  const V high = hn::Sub(constant(1), square);
  const V low = hn::Sub(hn::Sub(hn::Sub(constant(1), high), square), square_rest);
  return hn::Add(high, hn::Add(low, hn::Mul(hn::Mul(z, z), Polynomial(kEven, z))));
}

/// cos(2 pi v): v = q / 4 + t, t exact.
HWY_INLINE V CosOfTurn(V v) {
  const V q = hn::Floor(hn::Add(hn::Mul(v, constant(4)), constant(0.5)));
  const V t = hn::Sub(v, hn::Mul(q, constant(0.25)));
  const auto first = hn::Eq(q, constant(1));
  const V value = hn::IfThenElse(hn::Or(first, hn::Eq(q, constant(3))), SinTurns(t), CosTurns(t));
  return hn::IfThenElse(hn::Or(first, hn::Eq(q, constant(2))), hn::Neg(value), value);
}

HWY_INLINE void TransformLanes(const double* u, const double* v, double* out) {
  const V log = Log(hn::Sub(constant(1), hn::LoadU(D(), u)));
  const V radius = hn::Sqrt(hn::Mul(constant(-2), log));
  hn::StoreU(hn::Mul(radius, CosOfTurn(hn::LoadU(D(), v))), D(), out);
}

void TransformUniforms(std::span<const double> u, std::span<const double> v, std::span<double> out) {
  const std::size_t whole = out.size() / hn::Lanes(D()) * hn::Lanes(D());
  for (std::size_t i = 0; i < whole; i += hn::Lanes(D()))
    TransformLanes(u.data() + i, v.data() + i, out.data() + i);
  if (whole == out.size()) return;
  std::array<double, kMaxLanes> rest_u{};
  std::array<double, kMaxLanes> rest_v{};
  std::ranges::copy(u.subspan(whole), rest_u.begin());
  std::ranges::copy(v.subspan(whole), rest_v.begin());
  std::array<double, kMaxLanes> rest;
  TransformLanes(rest_u.data(), rest_v.data(), rest.data());
  std::copy_n(rest.begin(), out.size() - whole, out.begin() + static_cast<std::ptrdiff_t>(whole));
}

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace landfall {

HWY_EXPORT(TransformUniforms);

void box_muller(std::span<const double> u, std::span<const double> v, std::span<double> out) {
  assert(u.size() == out.size() && v.size() == out.size());
  HWY_DYNAMIC_DISPATCH(TransformUniforms)(u, v, out);
}

}  // namespace landfall
#endif
