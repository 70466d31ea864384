// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

/// The elementary functions with the same bits on every processor, compiler and C library: only operations
/// that IEEE 754 rounds in one way, in one order. A C library chooses some of its own by processor (with and
/// without fused multiply-add), and theirs differ in the last bit. Angles in radians. NaN gives NaN. The
/// errors are bounds of what portable_math_test.cpp finds against long double.
namespace landfall::portable {

/// Within 1 ulp for |x| <= 5e8; beyond, x counts modulo the double next to 2 pi.
[[nodiscard]] double sin(double x);
[[nodiscard]] double cos(double x);
/// Within 3 ulp.
[[nodiscard]] double tan(double x);

/// Within 4 ulp; asin and acos of |x| > 1 are NaN.
[[nodiscard]] double asin(double x);
[[nodiscard]] double acos(double x);
[[nodiscard]] double atan(double x);
/// The angle of the point (x, y) from the x axis, -pi .. pi; as std::atan2 at zeros and infinities but that
/// two infinities give NaN. Within 2 ulp.
[[nodiscard]] double atan2(double y, double x);

/// Within 1 ulp, 2 in expm1.
[[nodiscard]] double exp(double x);
[[nodiscard]] double exp2(double x);
[[nodiscard]] double expm1(double x);
/// Within 1 ulp for normal numbers, 2 in log1p.
[[nodiscard]] double log(double x);
[[nodiscard]] double log1p(double x);
/// x^y of x >= 0 (NaN for x < 0). Within 2 ulp.
[[nodiscard]] double pow(double x, double y);
/// Within 3 ulp.
[[nodiscard]] double cosh(double x);
[[nodiscard]] double tanh(double x);

/// sqrt(x^2 + y^2), whose squares must not overflow: |x|, |y| <= 1e150. Within 1 ulp above 1e-140.
[[nodiscard]] double hypot(double x, double y);
/// Complementary error function. Relative error below 1e-14 for |x| <= 6.
[[nodiscard]] double erfc(double x);
/// Gamma function of x in [1, 3]. Relative error below 2e-14.
[[nodiscard]] double gamma(double x);

/// E_2(x) = integral from 1 of exp(-x t) / t^2 dt, x >= 0. Relative error below 1e-14.
[[nodiscard]] double exponential_integral_2(double x);
/// The standard normal distribution's quantile of p in [1e-32, 1]. Absolute error below 1e-13, relative to it
/// below 1e-15 / |p - 0.5|.
[[nodiscard]] double normal_quantile(double p);

}  // namespace landfall::portable
