// SPDX-License-Identifier: GPL-3.0-or-later
// Against long double, whose 64 bits hold the results of the C library to about 2^-63.
#include "base/numerics/portable_math.h"

#include <gtest/gtest.h>

#include <boost/math/distributions/normal.hpp>
#include <boost/math/special_functions/expint.hpp>
#include <cmath>
#include <numbers>

#include "base/numerics/non_finite.h"

namespace landfall::portable {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kSteps = 100000;

/// |value - exact| in ulp of exact.
double ulps(double value, long double exact) {
  const double size = std::abs(static_cast<double>(exact));
  const double ulp = std::nextafter(size, kInfinity) - size;
  return std::abs(
      static_cast<double>((static_cast<long double>(value) - exact) / static_cast<long double>(ulp)));
}

/// The largest error in ulp over an irregular walk from low to high.
template <class Function, class Exact>
double largest_error(const Function& function, const Exact& exact, double low, double high) {
  double largest = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double x = low + (high - low) * (i + 0.37 * std::sin(i)) / (kSteps + 1);
    largest = std::max(largest, ulps(function(x), exact(static_cast<long double>(x))));
  }
  return largest;
}

#define LANDFALL_EXACT(name) [](long double x) { return std::name(x); }

TEST(PortableMath, AnglesOfAllSizes) {
  for (const double largest : {1e-3, 7.0, 1e5, 5e8}) {
    EXPECT_LE(largest_error(sin, LANDFALL_EXACT(sin), -largest, largest), 1) << largest;
    EXPECT_LE(largest_error(cos, LANDFALL_EXACT(cos), -largest, largest), 1) << largest;
  }
  EXPECT_LE(largest_error(tan, LANDFALL_EXACT(tan), -7, 7), 3);
  EXPECT_NEAR(sin(1e12), std::sin(std::fmod(1e12, 2 * kPi)), 1e-15);
  EXPECT_TRUE(std::isnan(sin(kInfinity)) && std::isnan(cos(-kInfinity)));
  EXPECT_TRUE(std::signbit(sin(-0.0)));
}

TEST(PortableMath, InverseFunctionsOfAngles) {
  EXPECT_LE(largest_error(asin, LANDFALL_EXACT(asin), -1, 1), 4);
  EXPECT_LE(largest_error(acos, LANDFALL_EXACT(acos), -1, 1), 4);
  EXPECT_LE(largest_error(atan, LANDFALL_EXACT(atan), -30, 30), 2);
  for (const double x : {-3.0, -1e-9, 1e-9, 0.7, 1e9})
    EXPECT_LE(largest_error([&](double y) { return atan2(y, x); },
                            [&](long double y) { return std::atan2(y, static_cast<long double>(x)); }, -2, 2),
              2)
        << x;
  EXPECT_TRUE(std::isnan(asin(1.0000001)) && std::isnan(acos(-2)));
  for (const double y : {0.0, -0.0, 1.0, -1.0})
    for (const double x : {0.0, -0.0, 2.0, -2.0, kInfinity, -kInfinity}) {
      EXPECT_EQ(atan2(y, x), std::atan2(y, x)) << y << " " << x;
      EXPECT_EQ(std::signbit(atan2(y, x)), std::signbit(std::atan2(y, x))) << y << " " << x;
    }
  EXPECT_EQ(atan2(kInfinity, 1), kPi / 2);
}

TEST(PortableMath, Exponentials) {
  EXPECT_LE(largest_error(exp, LANDFALL_EXACT(exp), -700, 709), 1);
  EXPECT_LE(largest_error(exp, LANDFALL_EXACT(exp), -1, 1), 1);
  EXPECT_LE(largest_error(exp2, LANDFALL_EXACT(exp2), -1020, 1023), 1);
  EXPECT_LE(largest_error(expm1, LANDFALL_EXACT(expm1), -50, 50), 2);
  EXPECT_LE(largest_error(expm1, LANDFALL_EXACT(expm1), -1e-3, 1e-3), 2);
  EXPECT_LE(largest_error(cosh, LANDFALL_EXACT(cosh), -9, 9), 3);
  EXPECT_LE(largest_error(tanh, LANDFALL_EXACT(tanh), -9, 9), 3);
  EXPECT_LE(ulps(exp(-744.5), std::exp(-744.5L)), 1);  // below the normal numbers
  for (const double x : {0.0, kInfinity, -kInfinity, 710.0, -746.0}) EXPECT_EQ(exp(x), std::exp(x)) << x;
  for (const int n : {-1074, -1, 0, 3, 1023}) EXPECT_EQ(exp2(n), std::ldexp(1, n)) << n;
  EXPECT_EQ(exp2(1024), kInfinity);
  EXPECT_EQ(expm1(-kInfinity), -1);
  EXPECT_EQ(tanh(-kInfinity), -1);
}

TEST(PortableMath, LogarithmsAndPowers) {
  EXPECT_LE(largest_error(log, LANDFALL_EXACT(log), 1e-9, 3), 1);
  EXPECT_LE(largest_error(log, LANDFALL_EXACT(log), 1, 1e300), 1);
  EXPECT_LE(largest_error(log1p, LANDFALL_EXACT(log1p), -0.999, 5), 2);
  EXPECT_LE(largest_error(log1p, LANDFALL_EXACT(log1p), -1e-6, 1e-6), 2);
  for (const double y : {-1.7, -0.5, 0.3, 1.2, 30.3})
    EXPECT_LE(
        largest_error([&](double x) { return pow(x, y); },
                      [&](long double x) { return std::pow(x, static_cast<long double>(y)); }, 1e-3, 1e4),
        2)
        << y;
  for (const double x : {0.0, -1.0, kInfinity, 1.0, 1e-310}) {
    const double expected = std::log(x);
    EXPECT_TRUE(log(x) == expected || (std::isnan(log(x)) && std::isnan(expected))) << x;
  }
  for (const double x : {0.0, 1.0, 2.0, 0.5, kInfinity})
    for (const double y : {0.0, 1.0, 3.0, -1.0, 1e300, -1e300, kInfinity, -kInfinity})
      EXPECT_EQ(pow(x, y), std::pow(x, y)) << x << " " << y;
  EXPECT_TRUE(std::isnan(pow(-1, 2)) && std::isnan(pow(2, std::nan(""))));
  EXPECT_EQ(log1p(-1), -kInfinity);
}

TEST(PortableMath, FunctionsOfStatistics) {
  const auto relative = [](double value, long double exact) {
    return std::abs(static_cast<double>((static_cast<long double>(value) - exact) / exact));
  };
  for (int i = 1; i <= kSteps / 10; ++i) {
    const double x = -3 + 9e-4 * i;
    EXPECT_LT(relative(erfc(x), std::erfc(static_cast<long double>(x))), 2e-14) << x;
    const double z = 1 + 2e-4 * i;
    EXPECT_LT(relative(gamma(z), std::tgamma(static_cast<long double>(z))), 2e-14) << z;
    const double e = 0.06 * i;
    if (e < 600) {
      EXPECT_LT(relative(exponential_integral_2(e), boost::math::expint(2, static_cast<long double>(e))),
                1e-14)
          << e;
    }
    const double p = static_cast<double>(i) / (kSteps / 10 + 1);
    const boost::math::normal_distribution<long double> normal;
    EXPECT_NEAR(normal_quantile(p), static_cast<double>(quantile(normal, static_cast<long double>(p))), 1e-13)
        << p;
    const double far = std::pow(10, -32.0 * i / (kSteps / 10 + 1));
    EXPECT_NEAR(normal_quantile(far), static_cast<double>(quantile(normal, static_cast<long double>(far))),
                1e-13)
        << far;
  }
  EXPECT_EQ(exponential_integral_2(0), 1);
  EXPECT_EQ(normal_quantile(0.5), 0);
  EXPECT_EQ(normal_quantile(1), kInfinity);
  EXPECT_TRUE(std::isnan(normal_quantile(0)) && std::isnan(normal_quantile(1.1)));
  EXPECT_EQ(erfc(kInfinity), 0);
}

TEST(PortableMath, HypotIsTheRootOfTheSquares) {
  EXPECT_EQ(hypot(3, -4), 5);
  EXPECT_LE(largest_error([](double x) { return hypot(x, 0.7); },
                          [](long double x) { return std::hypot(x, static_cast<long double>(0.7)); }, -5, 5),
            2);
  EXPECT_TRUE(std::isnan(hypot(std::nan(""), 1)));
}

}  // namespace
}  // namespace landfall::portable
