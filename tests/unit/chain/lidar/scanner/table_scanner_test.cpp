// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/scanner/table_scanner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "base/core/error.h"
#include "chain/lidar/scanner/fsm.h"
#include "chain/lidar/scanner/gimbal.h"
#include "refusal.h"
#include "steering.h"

namespace landfall {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

ScannerState table_state(const TableScanner& table, double t_s) { return table.state({.time = {3, t_s}}); }

std::string message_of(const std::function<void()>& action) {
  return refusal<FormatError>([&] { action(); });
}

TEST(TableScanner, IsLinearBetweenRows) {
  const TableScanner table({{-1, {0, 0}}, {1, {0.2, -0.4}}, {2, {0.2, 0}}}, std::nullopt);
  EXPECT_EQ(table_state(table, -1).angle_1_rad, 0);
  EXPECT_EQ(table_state(table, 1).angle_2_rad, -0.4);
  EXPECT_NEAR(table_state(table, 0).angle_1_rad, 0.1, 1e-16);
  EXPECT_NEAR(table_state(table, 0.5).angle_2_rad, -0.3, 1e-16);
  EXPECT_NEAR(table_state(table, 1.75).angle_2_rad, -0.1, 1e-16);
  EXPECT_EQ(table_state(table, 2).angle_2_rad, 0);
}

TEST(TableScanner, RoundedTimesCountAsTheEnds) {
  const TableScanner table({{0, {0.1, 0}}, {1, {0.2, 0}}}, std::nullopt);
  EXPECT_EQ(table_state(table, -0.9e-9).angle_1_rad, 0.1);
  EXPECT_EQ(table_state(table, 1 + 0.9e-9).angle_1_rad, 0.2);
}

TEST(TableScanner, RefusesATimeOutside) {
  const TableScanner table({{0, {0.1, 0}}, {1, {0.2, 0}}}, std::nullopt);
  EXPECT_THAT(message_of([&] { static_cast<void>(table_state(table, 1.5)); }),
              HasSubstr("pulse 3, 1.5 s after the first, is outside the table, which goes from 0 to 1 s"));
  EXPECT_THROW(static_cast<void>(table_state(table, -0.1)), FormatError);
  EXPECT_THROW(static_cast<void>(table_state(table, std::nan(""))), FormatError);
}

// Property: an Fsm's and a Gimbal's angles, replayed, give their rays back.
TEST(TableScanner, ReplaysAnFsm) {
  RandomCases random;
  for (int i = 0; i < 1000; ++i) {
    const double incidence = random.uniform(0, 1);
    const double azimuth = random.uniform(-4, 4);
    const Fsm fsm({.incidence_rad = incidence, .fold_azimuth_rad = azimuth});
    const ScannerState state = fsm.state({.aim = random.within(0.3)});
    const TableScanner table({{0, {}}, {1, {state.angle_1_rad, state.angle_2_rad}}},
                             TableMirror{incidence, azimuth});
    const Vector3d pixel = random.within(0.1).v;
    ASSERT_LT(
        (beam_of(table, table_state(table, 1), pixel).direction.v - beam_of(fsm, state, pixel).direction.v)
            .norm(),
        2e-15);
  }
}

TEST(TableScanner, ReplaysAGimbal) {
  RandomCases random;
  const Gimbal gimbal({});
  for (int i = 0; i < 1000; ++i) {
    const ScannerState state = gimbal.state({.aim = random.within(0.5)});
    const TableScanner table({{0, {}}, {1, {state.angle_1_rad, state.angle_2_rad}}}, std::nullopt);
    const Vector3d pixel = random.within(0.1).v;
    ASSERT_LT(
        (beam_of(table, table_state(table, 1), pixel).direction.v - beam_of(gimbal, state, pixel).direction.v)
            .norm(),
        1e-15);
  }
}

TEST(TableScanner, RefusesTheBackOfTheMirror) {
  const TableScanner table({{0, {}}, {1, {kPi, 0}}}, TableMirror{.incidence_rad = 0.5});
  EXPECT_NO_THROW(static_cast<void>(table_state(table, 0.2)));
  EXPECT_THAT(message_of([&] { static_cast<void>(table_state(table, 1)); }), HasSubstr("pulse 3, 1 s"));
}

TEST(TableScanner, TakesItsColumnsFromATable) {
  const NumberTable numbers("a.csv",
                            {{"t_s", {0, 1}}, {"angle_1_rad", {0, 0.5}}, {"angle_2_rad", {0.25, 1}}});
  for (const std::string& name : angle_columns().required) EXPECT_TRUE(numbers.has(name));
  const TableScanner table(angle_samples(numbers), std::nullopt, "a.csv");
  EXPECT_EQ(table_state(table, 1).angle_1_rad, 0.5);
  EXPECT_EQ(table_state(table, 0).angle_2_rad, 0.25);
  EXPECT_THAT(message_of([&] { static_cast<void>(table_state(table, 2)); }), HasSubstr("a.csv: pulse 3"));
}

TEST(TableScanner, RefusesABadTable) {
  const auto make = [](std::vector<AngleSample> rows) {
    return [rows] { TableScanner(rows, std::nullopt); };
  };
  EXPECT_THAT(message_of(make({{0, {}}})), HasSubstr("1 rows, at least 2"));
  EXPECT_THAT(message_of(make({{0, {}}, {0, {}}})), HasSubstr("row 2: t_s does not exceed"));
  EXPECT_THAT(message_of(make({{0, {}}, {1, {}}, {0.5, {}}})), HasSubstr("row 3"));
  EXPECT_THAT(message_of(make({{0, {}}, {1, {std::nan(""), 0}}})), HasSubstr("row 2: a value is not finite"));
  EXPECT_THAT(message_of(make({{0, {0, HUGE_VAL}}, {1, {}}})), HasSubstr("row 1"));
  EXPECT_THROW(TableScanner({{0, {}}, {1, {}}}, TableMirror{.incidence_rad = 2}), UsageError);
}

}  // namespace
}  // namespace landfall
