// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/returns/columns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

namespace landfall {
namespace {

using enum PointStatus;
using testing::ElementsAre;

// Each column its own member: the static_assert beside the declaration then says that none is left out.
template <class Table, class Columns>
void expect_each_name_and_member_once(const Columns& columns) {
  std::set<std::string> names;
  std::set<const void*> members;
  const Table table;
  for_each_column(columns, [&](const auto& column) {
    EXPECT_TRUE(names.insert(column.name).second) << column.name;
    EXPECT_TRUE(members.insert(&(table.*column.rows)).second) << column.name;
    EXPECT_STREQ(name_of(column.rows), column.name);
    EXPECT_NE(std::string(column.units), "") << column.name;
    EXPECT_NE(std::string(column.long_name), "") << column.name;
  });
}

TEST(Columns, AreDeclaredOnceEach) {
  expect_each_name_and_member_once<PointColumns>(kPointColumns);
  expect_each_name_and_member_once<PulseColumns>(kPulseColumns);
}

TEST(Columns, KnowTheirNames) {
  EXPECT_STREQ(name_of(&PointColumns::range_measured), "range_measured");
  EXPECT_STREQ(name_of(&PointColumns::status), "status");
  EXPECT_STREQ(name_of(&PulseColumns::t), "t");
  EXPECT_STREQ(name_of(&PulseColumns::point_begin), "point_begin");
}

TEST(Columns, ErrorsLeaveTheTruthUnchanged) {
  std::vector<std::string> unchanged;
  for_each_column(kPointColumns, [&](const auto& column) {
    if (column.effect == ErrorEffect::unchanged) unchanged.emplace_back(column.name);
  });
  EXPECT_THAT(unchanged, ElementsAre("x_true", "y_true", "z_true", "range_true", "pulse", "pixel",
                                     "echo_signal", "echo_peak", "echo_edge", "echo_width", "echo_range"));
}

TEST(Columns, CoordinatesAreTheEstimateThenTheTruth) {
  std::vector<std::string> names;
  for (const auto member : kCoordinates) names.emplace_back(name_of(member));
  EXPECT_THAT(names, ElementsAre("x_est", "y_est", "z_est", "x_true", "y_true", "z_true"));
}

// Values and meanings are those of scan files: never change one.
TEST(PointStatus, ValuesAndMeaningsAreTheFiles) {
  std::vector<int> values;
  std::vector<std::string> meanings;
  for (const PointStatusInfo& info : kPointStatuses) {
    values.push_back(static_cast<int>(info.status));
    meanings.emplace_back(info.meaning);
  }
  EXPECT_THAT(values, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
  EXPECT_THAT(meanings, ElementsAre("return", "miss", "dropout", "dead", "blanked", "total_reflection",
                                    "false_return", "undetected"));
  EXPECT_EQ(static_cast<int>(lost_in_optics), 5);
}

TEST(PointStatus, OnlyReturnsHaveNoCauseToBeMissing) {
  for (const PointStatusInfo& info : kPointStatuses)
    EXPECT_EQ(is_return(info.status), *info.cause == '\0') << info.meaning;
}

TEST(PointStatus, NamesTheCountsThatAreTold) {
  const auto counted = [](bool has_receiver) {
    std::vector<std::string> names;
    for (const PointStatusInfo& info : kPointStatuses)
      if (info.is_counted(has_receiver)) names.emplace_back(info.count_name);
    return names;
  };
  EXPECT_THAT(counted(false),
              ElementsAre("return_count", "miss_count", "dropout_count", "dead_count", "false_return_count"));
  EXPECT_THAT(counted(true), ElementsAre("return_count", "miss_count", "dropout_count", "dead_count",
                                         "false_return_count", "undetected_count"));
}

}  // namespace
}  // namespace landfall
