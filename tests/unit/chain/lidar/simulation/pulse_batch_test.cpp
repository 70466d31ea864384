// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/simulation/pulse_batch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace landfall {
namespace {

using enum PointStatus;
using testing::ElementsAre;

// Three pulses of two pixels; the rows are numbered in every column.
PulseBatch numbered(std::initializer_list<PointStatus> status) {
  PulseBatch batch;
  batch.resize(3, 2);
  for_each_column(kPointColumns, [&](const auto& column) {
    auto& rows = batch.points.*column.rows;
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = static_cast<std::decay_t<decltype(rows[0])>>(i);
  });
  batch.points.status = status;
  batch.pulses.point_count = {2, 2, 2};
  return batch;
}

TEST(PulseBatch, ResizesTheColumnsOfTheScan) {
  PulseBatch batch;
  for (const OptionalColumns& optional :
       {OptionalColumns{}, OptionalColumns{.intensity = true}, OptionalColumns{true, true, true}}) {
    batch.resize(4, 3, PointContent::all, optional);
    for_each_column(kPointColumns, [&](const auto& column) {
      EXPECT_EQ((batch.points.*column.rows).size(), optional.has(column.group) ? 12U : 0U) << column.name;
    });
  }
  for_each_column(kPulseColumns, [&](const auto& column) {
    EXPECT_EQ((batch.pulses.*column.rows).size(), 4U) << column.name;
  });
}

TEST(PulseBatch, CanLeaveOutTheTruth) {
  PulseBatch batch;
  batch.resize(4, 3);
  batch.resize(4, 3, PointContent::estimate);
  EXPECT_FALSE(batch.points.holds_truth());
  std::vector<std::string> filled;
  for_each_column(kPointColumns, [&](const auto& column) {
    const auto& rows = batch.points.*column.rows;
    if (rows.empty()) return;
    EXPECT_EQ(rows.size(), 12U) << column.name;
    filled.emplace_back(column.name);
  });
  EXPECT_THAT(filled, ElementsAre("x_est", "y_est", "z_est", "range_measured", "status"));
  batch.points.status.assign(12, miss);
  batch.points.status[5] = returned;
  batch.points.x_est[5] = 7;
  batch.pulses.point_count.assign(4, 3);
  batch.keep_returns();
  EXPECT_THAT(batch.points.x_est, ElementsAre(7));
  EXPECT_TRUE(batch.points.x_true.empty());
  EXPECT_THAT(batch.pulses.point_count, ElementsAre(0, 1, 0, 0));
}

TEST(PulseBatch, CountsEachStatus) {
  const PulseBatch batch = numbered({returned, miss, returned, dead, false_return, blanked});
  EXPECT_THAT(batch.status_counts(), ElementsAre(2, 1, 0, 1, 1, 0, 1, 0));
}

TEST(PulseBatch, KeepsReturnsInOrder) {
  PulseBatch batch = numbered({miss, returned, dropout, dead, false_return, returned});
  batch.keep_returns();
  EXPECT_THAT(batch.points.x_est, ElementsAre(1, 4, 5));
  EXPECT_THAT(batch.points.range_measured, ElementsAre(1, 4, 5));
  EXPECT_THAT(batch.points.pixel, ElementsAre(1, 4, 5));
  EXPECT_THAT(batch.points.status, ElementsAre(returned, false_return, returned));
  EXPECT_THAT(batch.pulses.point_count, ElementsAre(1, 0, 2));
  EXPECT_EQ(batch.pulses.t.size(), 3U);
}

TEST(PulseBatch, KeepingReturnsTwiceIsKeepingThemOnce) {
  PulseBatch batch = numbered({returned, returned, blanked, lost_in_optics, miss, returned});
  batch.keep_returns();
  const PointColumns once = batch.points;
  batch.keep_returns();
  EXPECT_EQ(batch.points, once);
  EXPECT_THAT(batch.pulses.point_count, ElementsAre(2, 0, 1));
}

}  // namespace
}  // namespace landfall
