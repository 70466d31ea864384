// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/points/cloud_box.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "base/core/error.h"

namespace landfall {
namespace {

using testing::HasSubstr;

constexpr CloudBox kBox{.low = {0, 0, 0}, .high = {100, 50, 10}};
constexpr CloudSteps kSteps{.scale = {0.01, -0.01, 0.01}, .offset = {0, 0, 0}};

std::string verdict(const CloudBox& declared, const CloudBox& points, const CloudSteps& steps = kSteps) {
  try {
    return compare_with_box("a.las", declared, points, steps);
  } catch (const FormatError& error) {
    return error.what();
  }
}

TEST(CloudBox, AllowsTwoStepsWarnsAndRefusesByOnePerCentOfTheLongestEdge) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const bool is_high : {false, true}) {
      const auto beyond = [&](double by) {
        CloudBox points = kBox;
        if (is_high)
          points.high[axis] += by;
        else
          points.low[axis] -= by;
        return verdict(kBox, points);
      };
      EXPECT_EQ(beyond(0), "");
      EXPECT_EQ(beyond(0.02), "");
      EXPECT_THAT(beyond(0.03), HasSubstr(std::string("its points are in ") + "xyz"[axis]));
      EXPECT_THAT(beyond(0.99), HasSubstr("but its header declares [0, "));
      EXPECT_THAT(beyond(0.99), testing::Not(HasSubstr("a.las")));
      EXPECT_THAT(beyond(1.01), HasSubstr("a.las: its points are in "));
    }
  EXPECT_EQ(verdict(kBox, {.low = {50, 25, 5}, .high = {51, 26, 6}}), "");
}

// A box of some steps: rounding by one step is more than 1 % of it.
TEST(CloudBox, AllowsOneStepAroundASmallBox) {
  const CloudBox small{.low = {0, 0, 0}, .high = {0.1, 0.1, 0.1}};
  EXPECT_EQ(verdict(small, {.low = {-0.01, 0, 0}, .high = {0.1, 0.11, 0.1}}), "");
  EXPECT_THAT(verdict(small, {.low = {-0.02, 0, 0}, .high = {0.1, 0.1, 0.1}}), HasSubstr("are damaged"));
}

TEST(CloudBox, WarnsOfABoxThatSaysNothing) {
  const CloudBox points{.low = {1, 1, 1}, .high = {2, 2, 2}};
  EXPECT_THAT(verdict({}, points), HasSubstr("is all zero"));
  CloudBox wrong = kBox;
  wrong.high[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(verdict(wrong, points), HasSubstr("is not finite"));
}

}  // namespace
}  // namespace landfall
