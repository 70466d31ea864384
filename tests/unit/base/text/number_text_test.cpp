// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/text/number_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace landfall {
namespace {

TEST(NumberText, Grouped) {
  EXPECT_EQ(grouped(0), "0");
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(grouped(1000), "1,000");
  EXPECT_EQ(grouped(12'960'000), "12,960,000");
  EXPECT_EQ(grouped(-999), "-999");
  EXPECT_EQ(grouped(-1234567), "-1,234,567");
  EXPECT_EQ(grouped(std::numeric_limits<std::int64_t>::min()), "-9,223,372,036,854,775,808");
}

TEST(NumberText, ShortNumbersHaveThreeDigitsAndCountsNoExponent) {
  EXPECT_EQ(short_number(0.000382009), "0.000382");
  EXPECT_EQ(short_number(11.12), "11.1");
  EXPECT_EQ(short_number(99.96), "100");
  EXPECT_EQ(short_number(785321), "785321");
  EXPECT_EQ(short_number(-1423), "-1423");
  EXPECT_EQ(short_number(INFINITY), "inf");
  EXPECT_EQ(percent_text(0.5), "50 %");
}

TEST(NumberText, ReadsBackAsTheSameDouble) {
  EXPECT_EQ(number_text(0.7), "0.7");
  EXPECT_EQ(std::stod(number_text(1.0 / 3)), 1.0 / 3);
}

}  // namespace
}  // namespace landfall
