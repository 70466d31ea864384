// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/raster/grid_spec.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/core/error.h"

namespace landfall {
namespace {

TEST(GridSpec, PapersDemIs2001Square) {
  const GridSpec dem = GridSpec::centered(50, 0.05);
  EXPECT_EQ(dem.rows, 2001);
  EXPECT_EQ(dem.cols, 2001);
  EXPECT_EQ(dem.x(0), -50);
  EXPECT_EQ(dem.x(1000), 0);
  EXPECT_EQ(dem.y(2000), 50);
}

TEST(GridSpec, RefusesAHalfWidthThatIsNoMultiple) {
  EXPECT_THROW(GridSpec::centered(50.01, 0.05), UsageError);
  EXPECT_THROW(GridSpec::centered(0.01, 0.05), UsageError);
  EXPECT_THROW(GridSpec::centered(-50, 0.05), UsageError);
  EXPECT_THROW(GridSpec::centered(50, 0), UsageError);
  EXPECT_THROW(GridSpec::centered(50, std::numeric_limits<double>::quiet_NaN()), UsageError);
  EXPECT_NO_THROW(GridSpec::centered(0.3, 0.1));  // 0.3 / 0.1 = 2.9999999999999996
}

// Bins are half-open, [-s/2, s/2) about the centre, on both sides of zero: never a truncation toward zero.
TEST(GridSpec, BinEdgesAndNegativeCoordinates) {
  const GridSpec grid = GridSpec::centered(2, 0.5);  // centres -2, -1.5, .., 2: nine bins
  const auto col = [&](double x) { return grid.bin_of(x, 0).col; };
  EXPECT_EQ(col(0.0), 4);
  EXPECT_EQ(col(0.2499), 4);
  EXPECT_EQ(col(0.25), 5);
  EXPECT_EQ(col(-0.25), 4);
  EXPECT_EQ(col(-0.2501), 3);
  EXPECT_EQ(col(-0.75), 3);
  EXPECT_EQ(col(-0.7501), 2);
  EXPECT_EQ(col(-2.25), 0);
  EXPECT_FALSE(grid.contains(grid.bin_of(-2.2501, 0)));
  EXPECT_FALSE(grid.contains(grid.bin_of(2.25, 0)));
  EXPECT_EQ(grid.bin_of(0, -0.75).row, 3);
}

TEST(GridSpec, WildCoordinatesLieOutside) {
  const GridSpec grid = GridSpec::centered(2, 0.5);
  for (const double wild :
       {1e300, -1e300, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_FALSE(grid.contains(grid.bin_of(wild, 0)));
    EXPECT_FALSE(grid.contains(grid.bin_of(0, wild)));
  }
}

}  // namespace
}  // namespace landfall
