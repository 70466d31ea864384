// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/text/number_table.h"

#include <gtest/gtest.h>

#include "refusal.h"

namespace landfall {
namespace {

TEST(NumberTable, ColumnsAreOfOneLength) {
  EXPECT_EQ(NumberTable("a.csv", {{"t_s", {1, 2}}, {"x_m", {3, 4}}}).row_count(), 2U);
  EXPECT_EQ(NumberTable().row_count(), 0U);
  EXPECT_EQ(refusal<FormatError>([&] {
              const NumberTable table("a.csv", {{"t_s", {1, 2}}, {"x_m", {3}}});
            }),
            "a.csv: columns t_s and x_m differ in length");
}

TEST(NumberTable, RowsAreCountedFromOne) {
  EXPECT_EQ(refusal<FormatError>([&] { NumberTable("a.csv", {}).fail_at(0, "is odd"); }),
            "a.csv: row 1: is odd");
}

}  // namespace
}  // namespace landfall
