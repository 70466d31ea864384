// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/text/key_unit.h"

#include <gtest/gtest.h>

namespace landfall {
namespace {

TEST(KeyUnit, IsTheSuffixOfTheName) {
  EXPECT_EQ(unit_of_key("scan.noise.range_sigma_m"), "m");
  EXPECT_EQ(unit_of_key("velocity_mps"), "m/s");
  EXPECT_EQ(unit_of_key("position_m_per_sqrt_s"), "m/s^0.5");
  EXPECT_EQ(unit_of_key("range_sigma_per_m"), "1");
  EXPECT_EQ(unit_of_key("torque_nm"), "N m");
  EXPECT_EQ(unit_of_key("force_n"), "N");
  EXPECT_EQ(unit_of_key("m"), "");
  EXPECT_EQ(unit_of_key("coverage.invalid_count"), "");
}

}  // namespace
}  // namespace landfall
