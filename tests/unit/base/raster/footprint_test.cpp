// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/raster/footprint.h"

#include <gtest/gtest.h>

namespace landfall {
namespace {

TEST(Footprint, Square) {
  const Footprint footprint = Footprint::square(2);
  EXPECT_TRUE(footprint.is_square());
  EXPECT_EQ(footprint.half_bins(), 2);
  for (const std::int64_t offset : {-2, -1, 0, 1, 2}) EXPECT_EQ(footprint.half_width(offset), 2);
}

// 5^2 = 3^2 + 4^2: the radius of 5 bins holds what lies on the circle.
TEST(Footprint, DiscHoldsItsCircle) {
  const Footprint footprint = Footprint::disc(25);
  EXPECT_FALSE(footprint.is_square());
  EXPECT_EQ(footprint.half_bins(), 5);
  const std::int64_t widths[] = {5, 4, 4, 4, 3, 0};
  for (std::int64_t offset = 0; offset <= 5; ++offset) {
    EXPECT_EQ(footprint.half_width(offset), widths[offset]);
    EXPECT_EQ(footprint.half_width(-offset), widths[offset]);
  }
}

TEST(Footprint, DiscsCountLatticePoints) {
  for (std::int64_t squared = 0; squared < 200; ++squared) {
    const Footprint footprint = Footprint::disc(squared);
    std::int64_t points = 0;
    std::int64_t squares = 0;
    for (std::int64_t i = -15; i <= 15; ++i)
      for (std::int64_t j = -15; j <= 15; ++j)
        if (i * i + j * j <= squared) {
          ++points;
          squares += j * j;
        }
    EXPECT_EQ(footprint.bin_count(), points) << squared;
    EXPECT_EQ(footprint.squared_offsets(), squares) << squared;
  }
}

}  // namespace
}  // namespace landfall
