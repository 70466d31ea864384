// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/draws/draw_table.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/dictionary/tables/requirements.h"

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

TEST(DrawTable, SixPassedTellsUnjudgedDraws) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  DrawTable table{0, {1, 1, 1, 1}, {0, 1, 2, 3}, {}, {}, {1, 0, -1, 0}};
  for (const auto& words : dictionary::kRequirements)
    table.metrics.push_back({"requirements." + std::string(words.name) + ".pass", {1, 1, 1, 1}});
  table.metrics[0].values = {1, 0, 1, 1};
  table.metrics[3].values = {1, 1, kNan, kNan};
  table.metrics[5].values = {1, 1, 1, 0};
  EXPECT_EQ(six_passed(table), (std::vector<std::int8_t>{1, 0, -1, 0}));
  EXPECT_EQ(judged_draws(table, std::string(dictionary::kRequirements[3].name)), 2);
  EXPECT_EQ(judged_draws(table, std::string(dictionary::kRequirements[0].name)), 4);
}

}  // namespace
}  // namespace landfall
