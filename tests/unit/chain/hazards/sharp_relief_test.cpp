// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/sharp_relief.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "map_noise.h"

namespace landfall {
namespace {

constexpr std::int64_t kBins = 200;
constexpr double kEdge = 0.05;

/// Ground of the function `height` of x and y, with noise of 1 sigma.
template <typename Height>
Grid<double> noisy(double sigma_m, const Height& height) {
  Grid<double> z(GridSpec::centered(kBins / 2 * kEdge, kEdge));
  for (std::int64_t row = 0; row < z.spec().rows; ++row)
    for (std::int64_t col = 0; col < z.spec().cols; ++col)
      z.at({row, col}) = height(z.spec().x(col), z.spec().y(row));
  add_noise(z, sigma_m, 3);
  return z;
}

BinMask all_bins(const Grid<double>& z) { return BinMask(z.spec(), 1); }

double rolling(double x, double y) { return 0.2 * std::sin(x) * std::cos(1.3 * y) + 0.1 * x; }

/// Half an ellipsoid 0.8 m wide and 0.3 m high, on rolling terrain.
double rock(double x, double y) {
  const double r = std::hypot(x - 1, y + 1) / 0.4;
  return rolling(x, y) + (r < 1 ? 0.3 * std::sqrt(1 - r * r) : 0);
}

double step(double x, double y) { return rolling(x, y) + (x > 0.3 * y ? 0.15 : 0); }

TEST(SharpRelief, EvenReliefIsNot) {
  for (const double sigma_m : {0.001, 0.02}) {
    const Grid<double> z = noisy(sigma_m, rolling);
    EXPECT_FALSE(has_sharp_relief(z, all_bins(z))) << sigma_m;
  }
  const Grid<double> level = noisy(0, [](double, double) { return 0.0; });
  EXPECT_FALSE(has_sharp_relief(level, all_bins(level)));
}

TEST(SharpRelief, ARockAndAStepAre) {
  for (const double sigma_m : {0.001, 0.01}) {
    const Grid<double> rocky = noisy(sigma_m, rock);
    EXPECT_TRUE(has_sharp_relief(rocky, all_bins(rocky))) << sigma_m;
    const Grid<double> stepped = noisy(sigma_m, step);
    EXPECT_TRUE(has_sharp_relief(stepped, all_bins(stepped))) << sigma_m;
  }
}

TEST(SharpRelief, OnlyTheRegionCounts) {
  const Grid<double> z = noisy(0.001, rock);
  BinMask region = all_bins(z);
  for (std::int64_t row = 0; row < z.spec().rows; ++row)
    for (std::int64_t col = 0; col < z.spec().cols; ++col)
      if (std::hypot(z.spec().x(col) - 1, z.spec().y(row) + 1) < 0.6) region.at({row, col}) = 0;
  EXPECT_FALSE(has_sharp_relief(z, region));
  EXPECT_FALSE(has_sharp_relief(z, BinMask(z.spec())));
}

TEST(SharpRelief, BinsBesideAHoleDoNotCount) {
  Grid<double> z = noisy(0.001, rock);
  for (std::int64_t row = 0; row < z.spec().rows; ++row)
    for (std::int64_t col = 0; col < z.spec().cols; ++col)
      if (std::hypot(z.spec().x(col) - 1, z.spec().y(row) + 1) < 0.5)
        z.at({row, col}) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(has_sharp_relief(z, all_bins(z)));
}

}  // namespace
}  // namespace landfall
