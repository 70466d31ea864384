// SPDX-License-Identifier: GPL-3.0-or-later
#include "campaign/draw_table.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace landfall {
namespace {

TEST(DrawTable, AppendsRows) {
  DrawTable table{3,
                  {13, 13},
                  {3, 4},
                  {{"scan.seed", {1, 2}}},
                  {{"a", {5, 6}}, {"requirements.coverage.pass", {1, 0}}},
                  {1, 0}};
  EXPECT_EQ(table.size(), 2);
  EXPECT_EQ(table.end(), 5);
  append(table, {5, {13}, {5}, {{"scan.seed", {3}}}, {{"a", {7}}, {"requirements.coverage.pass", {1}}}, {1}});
  const DrawTable expected{3,
                           {13, 13, 13},
                           {3, 4, 5},
                           {{"scan.seed", {1, 2, 3}}},
                           {{"a", {5, 6, 7}}, {"requirements.coverage.pass", {1, 0, 1}}},
                           {1, 0, 1}};
  EXPECT_EQ(table, expected);
}

TEST(DrawTable, FindsMetrics) {
  const DrawTable table{0, {1}, {0}, {}, {{"a", {5}}, {"requirements.coverage.pass", {1}}}, {1}};
  ASSERT_NE(find_metric(table, "a"), nullptr);
  EXPECT_EQ(find_metric(table, "a")->values.front(), 5);
  EXPECT_EQ(find_metric(table, "b"), nullptr);
  EXPECT_EQ(pass_column(table, "coverage").name, "requirements.coverage.pass");
  EXPECT_THROW(static_cast<void>(pass_column(table, "a")), std::out_of_range);
}

}  // namespace
}  // namespace landfall
