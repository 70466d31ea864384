// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <utility>

#include "base/core/error.h"
#include "chain/lidar/scanner/fsm.h"
#include "chain/lidar/scanner/gimbal.h"
#include "chain/lidar/scanner/patterns.h"
#include "chain/lidar/scanner/table_scanner.h"
#include "pattern_random.h"
#include "refusal.h"
#include "steering.h"

namespace landfall {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

const std::vector<AimSample> kTriangle{{0, 0, 0}, {1, 4, 0}, {1.5, 4, 2}, {3, 0, 0}};

TablePattern table(std::vector<AimSample> samples, AtTableEnd at_end = AtTableEnd::stop) {
  return TablePattern({.samples = std::move(samples), .at_end = at_end});
}

std::string message_of(std::vector<AimSample> samples, AtTableEnd at_end = AtTableEnd::stop) {
  return refusal<FormatError>([&] { const TablePattern pattern = table(std::move(samples), at_end); });
}

TEST(TablePattern, IsLinearBetweenRows) {
  const TablePattern pattern = table(kTriangle);
  EXPECT_EQ(aim_at(pattern, 0.25), Vector3d(1, 0, 0));
  EXPECT_EQ(aim_at(pattern, 1.25), Vector3d(4, 1, 0));
  EXPECT_LT((aim_at(pattern, 2.25) - Vector3d(2, 1, 0)).norm(), 1e-15);
}

TEST(TablePattern, GoesThroughItsRows) {
  PatternRandom random;
  std::vector<AimSample> samples{{0, random.real(-50, 50), random.real(-50, 50)}};
  for (int i = 0; i < 1000; ++i)
    samples.push_back(
        {samples.back().t_s + random.real(1e-6, 1), random.real(-50, 50), random.real(-50, 50)});
  const TablePattern pattern = table(samples);
  for (const AimSample& s : samples) ASSERT_EQ(aim_at(pattern, s.t_s), Vector3d(s.x_m, s.y_m, 0));
  // Between two rows, on the segment that joins them, in proportion to time.
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    const AimSample& a = samples[i];
    const AimSample& b = samples[i + 1];
    const double u = random.real(0, 1);
    const Vector3d expected = Vector3d(a.x_m, a.y_m, 0) + u * Vector3d(b.x_m - a.x_m, b.y_m - a.y_m, 0);
    ASSERT_LT((aim_at(pattern, a.t_s + u * (b.t_s - a.t_s)) - expected).norm(), 1e-6);
  }
}

TEST(TablePattern, StopsAtItsEnd) {
  const TablePattern pattern = table(kTriangle);
  EXPECT_EQ(aim_at(pattern, 3), Vector3d(0, 0, 0));
  EXPECT_EQ(aim_at(pattern, 3 + 0.9e-9), Vector3d(0, 0, 0));
  EXPECT_FALSE(pattern.aim_point({0, 3 + 2e-9}).has_value());
}

TEST(TablePattern, HoldsItsLastAim) {
  const TablePattern pattern = table({{0, 0, 0}, {1, 4, -2}}, AtTableEnd::hold);
  for (const double t : {1.0, 1.5, 1e6}) EXPECT_EQ(aim_at(pattern, t), Vector3d(4, -2, 0));
}

TEST(TablePattern, WrapsWhatIsClosed) {
  const TablePattern pattern = table(kTriangle, AtTableEnd::wrap);
  for (double t = 0; t < 3; t += 0.125)
    for (const double passes : {1, 2, 1000}) EXPECT_EQ(aim_at(pattern, t + 3 * passes), aim_at(pattern, t));
}

TEST(TablePattern, TakesItsColumnsFromATable) {
  const NumberTable read("aims.csv", {{"t_s", {0, 2}}, {"x_m", {1, 3}}, {"y_m", {-5, 5}}});
  EXPECT_EQ(aim_at(table(aim_samples(read)), 1), Vector3d(2, 0, 0));
  EXPECT_EQ(aim_columns().required, (std::vector<std::string>{"t_s", "x_m", "y_m"}));
  EXPECT_THAT(refusal<FormatError>([&] {
                const TablePattern pattern({.samples = {{0, 0, 0}}}, "aims.csv: pattern table");
              }),
              HasSubstr("aims.csv: pattern table: 1 rows"));
}

TEST(TablePattern, SaysHowItIsRun) {
  EXPECT_TRUE(table(kTriangle).compensated());
  EXPECT_FALSE(TablePattern({.samples = kTriangle, .compensated = false}).compensated());
  EXPECT_FALSE(table(kTriangle).pulse_limit().has_value());
}

TEST(TablePattern, RefusesABadTable) {
  EXPECT_THAT(message_of({}), HasSubstr("0 rows, at least 2"));
  EXPECT_THAT(message_of({{0, 1, 1}}), HasSubstr("1 rows, at least 2"));
  EXPECT_THAT(message_of({{0.5, 0, 0}, {1, 0, 0}}), HasSubstr("row 1: t_s is 0.5, not 0"));
  EXPECT_THAT(message_of({{0, 0, 0}, {1, 0, 0}, {1, 2, 0}}), HasSubstr("row 3: t_s does not exceed"));
  EXPECT_THAT(message_of({{0, 0, 0}, {1, std::nan(""), 0}}), HasSubstr("row 2: a value"));
  EXPECT_THAT(message_of({{0, 0, HUGE_VAL}, {1, 0, 0}}), HasSubstr("row 1: a value"));
  EXPECT_THAT(message_of({{0, 0, 0}, {HUGE_VAL, 0, 0}}), HasSubstr("row 2: a value"));
}

TEST(TablePattern, WrapAsksForAClosedTable) {
  EXPECT_EQ(message_of({{0, 0, 0}, {1, 3, 4}, {2, 0.0006, 0.0008}}, AtTableEnd::wrap), "accepted");
  EXPECT_THAT(message_of({{0, 0, 0}, {1, 3, 4}}, AtTableEnd::wrap),
              HasSubstr("row 2: ends 5 m from the first row"));
  EXPECT_EQ(message_of({{0, 0, 0}, {1, 3, 4}}, AtTableEnd::hold), "accepted");
}

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
