// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/raster/value_range.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "constants.h"

namespace landfall {
namespace {

template <class T>
std::optional<std::array<double, 2>> range_of(const std::vector<T>& values) {
  ValueRange range;
  range.add(std::span<const T>(values));
  return range.pair();
}

// 8 values are compared at once: the extremes lie in and behind such a group.
TEST(ValueRange, FindsTheExtremesAtEveryPosition) {
  for (std::size_t size = 1; size <= 20; ++size)
    for (std::size_t i = 0; i < size; ++i) {
      std::vector<double> values(size, 2);
      values[i] = -5;
      EXPECT_EQ(range_of(values), (std::array{-5.0, size == 1 ? -5.0 : 2.0}));
      values[i] = 7;
      EXPECT_EQ(range_of(values), (std::array{size == 1 ? 7.0 : 2.0, 7.0}));
    }
}

TEST(ValueRange, IgnoresNanAndIsEmptyWithoutOtherValues) {
  EXPECT_EQ(range_of<double>({kNan, 3, kNan, -1, kNan, kNan, kNan, kNan, kNan, 2}), (std::array{-1.0, 3.0}));
  EXPECT_EQ(range_of<float>(std::vector<float>(11, std::nanf(""))), std::nullopt);
  EXPECT_EQ(range_of<double>({}), std::nullopt);
}

TEST(ValueRange, HoldsTheValuesOfEveryType) {
  EXPECT_EQ(range_of<std::int8_t>({-128, 0, 127}), (std::array{-128.0, 127.0}));
  EXPECT_EQ(range_of<std::int32_t>({0, 0, 2147483647}), (std::array{0.0, 2147483647.0}));
  EXPECT_EQ(range_of<float>({0.1F, -0.3F}), (std::array{double{-0.3F}, double{0.1F}}));
}

TEST(ValueRange, JoinsRangesAndHasNoNegativeZero) {
  const std::vector<double> zeros = {0.0, -0.0};
  ValueRange a;
  ValueRange b;
  a.add(std::span<const double>(zeros).first(1));
  b.add(std::span<const double>(zeros).last(1));
  b.add(a);
  b.add(ValueRange());
  ASSERT_TRUE(b.pair().has_value());
  EXPECT_FALSE(std::signbit((*b.pair())[0]) || std::signbit((*b.pair())[1]));
}

}  // namespace
}  // namespace landfall
