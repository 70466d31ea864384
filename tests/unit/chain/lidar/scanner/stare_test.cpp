// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/scanner/patterns.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/core/error.h"
#include "pattern_random.h"

namespace landfall {
namespace {

TEST(Stare, AimsAtOnePoint) {
  PatternRandom random;
  EXPECT_EQ(aim_at(Stare({}), 1.5), Eigen::Vector3d::Zero());
  for (int trial = 0; trial < 100; ++trial) {
    const double x = random.real(-100, 100);
    const double y = random.real(-100, 100);
    const Stare stare({.aim_m = {x, y}});
    EXPECT_EQ(aim_of(stare, {random.whole(0, 1 << 30), random.real(0, 1e6)}), Eigen::Vector3d(x, y, 0));
  }
}

TEST(Stare, SaysHowItIsRun) {
  EXPECT_TRUE(Stare({}).compensated());
  EXPECT_FALSE(Stare({.compensated = false}).compensated());
  EXPECT_FALSE(Stare({}).pulse_limit().has_value());
}

TEST(Stare, RefusesAnAimThatIsNotFinite) {
  EXPECT_THROW(Stare({.aim_m = {HUGE_VAL, 0}}), UsageError);
  EXPECT_THROW(Stare({.aim_m = {0, std::nan("")}}), UsageError);
}

}  // namespace
}  // namespace landfall
