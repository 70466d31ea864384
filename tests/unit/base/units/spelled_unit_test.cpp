// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/units/spelled_unit.h"

#include <gtest/gtest.h>

#include <numbers>

namespace landfall {
namespace {

TEST(SpelledUnit, ReadsLengths) {
  for (const std::string text : {"m", "metres", "Meter", "M", "[m]", "m above MSL", "metres (NAVD88)"})
    EXPECT_EQ(spelled_unit(text).metres, 1) << text;
  EXPECT_DOUBLE_EQ(spelled_unit("mm").metres, 1e-3);
  EXPECT_EQ(spelled_unit("KM").metres, 1000);
  EXPECT_EQ(spelled_unit("ft").metres, 0.3048);
  EXPECT_EQ(spelled_unit("US survey feet").metres, 1200.0 / 3937);
  EXPECT_FALSE(spelled_unit("MM").is_known());  // millimetres or megametres
  EXPECT_TRUE(spelled_unit("m below sea level").downwards);
}

TEST(SpelledUnit, ReadsAnglesAndTimes) {
  for (const std::string text : {"deg", "degrees", "degrees_north", "\xc2\xb0"})
    EXPECT_DOUBLE_EQ(spelled_unit(text).radians, std::numbers::pi / 180) << text;
  EXPECT_DOUBLE_EQ(spelled_unit("ms").seconds, 1e-3);
  EXPECT_DOUBLE_EQ(spelled_unit("hours").seconds, 3600);
  EXPECT_EQ(spelled_unit("s").metres, 0);
}

TEST(SpelledUnit, IsNotKnownForOtherTexts) {
  for (const std::string text : {"", "1", "kg", "m/s", "cubit", "degrees_west", "NAVD88"})
    EXPECT_FALSE(spelled_unit(text).is_known()) << text;
}

TEST(SpelledUnit, SomeTextsSayThatThereIsNone) {
  for (const std::string text : {"", "1", "none", "Unknown", "N/A", "-"})
    EXPECT_TRUE(says_no_unit(text)) << text;
  for (const std::string text : {"m", "\xc2\xb0", "counts"}) EXPECT_FALSE(says_no_unit(text)) << text;
}

}  // namespace
}  // namespace landfall
