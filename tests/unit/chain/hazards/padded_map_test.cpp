// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/padded_map.h"

#include <gtest/gtest.h>

#include <cmath>

namespace landfall {
namespace {

// Narrower and wider than the room that a row has beyond its margins.
TEST(PaddedMap, IsTheMapWithUnknownBinsAround) {
  const GridSpec spec{1, 0, 0, 5, 7};
  Grid<double> z(spec);
  for (std::size_t i = 0; i < spec.size(); ++i) z.values()[i] = static_cast<double>(i);
  for (const std::int64_t margin : {0, 3, 40}) {
    const PaddedMap padded(z, margin);
    EXPECT_EQ(padded.rows(), 5);
    EXPECT_EQ(padded.cols(), 7);
    EXPECT_EQ(padded.margin(), margin);
    for (std::int64_t row = -margin; row < 5 + margin; ++row)
      for (std::int64_t col = -margin; col < 7 + margin; ++col)
        if (spec.contains({row, col}))
          EXPECT_EQ(*padded.at(row, col), z.at({row, col}));
        else
          EXPECT_TRUE(std::isnan(*padded.at(row, col))) << margin << ' ' << row << ' ' << col;
  }
}

}  // namespace
}  // namespace landfall
