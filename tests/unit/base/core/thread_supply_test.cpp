// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/core/parallel.h"

#include <gtest/gtest.h>

namespace landfall {
namespace {

TEST(ThreadSupply, CountsThisThread) {
  EXPECT_EQ(thread_supply(1), 1U);
  EXPECT_EQ(thread_supply(0), 1U);
}

TEST(ThreadSupply, GivesWhatIsWantedWhereNothingForbidsIt) { EXPECT_EQ(thread_supply(4), 4U); }

}  // namespace
}  // namespace landfall
