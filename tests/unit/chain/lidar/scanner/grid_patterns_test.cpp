// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <utility>

#include "base/core/error.h"
#include "chain/lidar/scanner/patterns.h"
#include "pattern_random.h"

namespace landfall {
namespace {

using Eigen::Vector3d;
using enum AtEnd;
using enum LineDirection;

Vector3d line_search_aim(const LineSearch& pattern, std::int64_t pulse) {
  return pattern.aim_point({pulse, 0})->v;
}

TEST(LineSearch, ReferenceRaster) {
  const LineSearch pattern({});
  EXPECT_EQ(line_search_aim(pattern, 0), Vector3d(-50, 50, 0));
  EXPECT_EQ(line_search_aim(pattern, 199), Vector3d(50, 50, 0));
  EXPECT_EQ(line_search_aim(pattern, 39800), Vector3d(-50, -50, 0));
  EXPECT_EQ(line_search_aim(pattern, 39999), Vector3d(50, -50, 0));
  EXPECT_NEAR(line_search_aim(pattern, 1).x(), -50 + 100.0 / 199, 1e-14);
  EXPECT_NEAR(line_search_aim(pattern, 200).y(), 50 - 100.0 / 199, 1e-14);
  EXPECT_TRUE(pattern.compensated());
}

// 2 rows x 3 columns over +-4 m.
TEST(LineSearch, RunsLineByLine) {
  const LineSearch pattern({.rows = 2, .columns = 3, .half_width_m = 4});
  const double expected[6][2] = {{-4, 4}, {0, 4}, {4, 4}, {-4, -4}, {0, -4}, {4, -4}};
  for (int k = 0; k < 6; ++k)
    EXPECT_EQ(line_search_aim(pattern, k), Vector3d(expected[k][0], expected[k][1], 0));
}

TEST(LineSearch, BoustrophedonReversesOddLines) {
  const LineSearch pattern({.rows = 3, .columns = 3, .half_width_m = 4, .direction = boustrophedon});
  const double expected[9][2] = {{-4, 4}, {0, 4},   {4, 4},  {4, 0}, {0, 0},
                                 {-4, 0}, {-4, -4}, {0, -4}, {4, -4}};
  for (int k = 0; k < 9; ++k)
    EXPECT_EQ(line_search_aim(pattern, k), Vector3d(expected[k][0], expected[k][1], 0));
}

// Each repetition starts as the first did, also where the number of lines is odd.
TEST(LineSearch, WrapsByDefault) {
  const LineSearch pattern({.rows = 3, .columns = 2, .half_width_m = 4, .direction = boustrophedon});
  EXPECT_FALSE(pattern.pulse_limit().has_value());
  for (int k = 0; k < 6; ++k)
    EXPECT_EQ(line_search_aim(pattern, k), line_search_aim(pattern, k + 600000000000));
}

TEST(LineSearch, StopsOnRequest) {
  const LineSearch pattern({.rows = 3, .columns = 2, .half_width_m = 4, .at_end = stop});
  EXPECT_EQ(pattern.pulse_limit(), 6);
  EXPECT_EQ(line_search_aim(pattern, 5), Vector3d(4, -4, 0));
  EXPECT_FALSE(pattern.aim_point({6, 0}).has_value());
}

TEST(LineSearch, SingleRowOrColumnAimsAtTheMiddle) {
  const LineSearch row({.rows = 1, .columns = 2, .half_width_m = 4});
  EXPECT_EQ(line_search_aim(row, 0), Vector3d(-4, 0, 0));
  EXPECT_EQ(line_search_aim(row, 1), Vector3d(4, 0, 0));
  const LineSearch column({.rows = 2, .columns = 1, .half_width_m = 4});
  EXPECT_EQ(line_search_aim(column, 0), Vector3d(0, 4, 0));
  EXPECT_EQ(line_search_aim(column, 1), Vector3d(0, -4, 0));
}

// y = 4 - 8 k/5 over 2 rows x 3 columns: the corners of the staircase, and even steps between them.
TEST(LineSearch, RampedFallsEvenly) {
  const LineSearch pattern({.rows = 2, .columns = 3, .half_width_m = 4, .ramped = true});
  const double x[3] = {-4, 0, 4};
  for (int k = 0; k < 6; ++k)
    EXPECT_LT((line_search_aim(pattern, k) - Vector3d(x[k % 3], 4 - 8 * k / 5.0, 0)).norm(), 1e-15)
        << "pulse " << k;
  EXPECT_EQ(line_search_aim(pattern, 6), line_search_aim(pattern, 0));
}

TEST(LineSearch, RampedBoustrophedonIsAZigZag) {
  const LineSearch pattern(
      {.rows = 3, .columns = 3, .half_width_m = 4, .direction = boustrophedon, .ramped = true});
  const double x[9] = {-4, 0, 4, 4, 0, -4, -4, 0, 4};
  for (int k = 0; k < 9; ++k)
    EXPECT_EQ(line_search_aim(pattern, k), Vector3d(x[k], 4 - k, 0)) << "pulse " << k;
}

TEST(LineSearch, RampedSingleRowStaysInTheMiddle) {
  const LineSearch row({.rows = 1, .columns = 3, .half_width_m = 4, .ramped = true});
  for (int k = 0; k < 3; ++k) EXPECT_EQ(line_search_aim(row, k).y(), 0);
}

// Over one pass each pair of neighbouring pulses is 2E/(N - 1) apart in y; the x are the staircase's.
TEST(LineSearch, RampedDiffersFromTheStaircaseInYOnly) {
  PatternRandom random;
  for (int trial = 0; trial < 100; ++trial) {
    LineSearchParameters p{.rows = random.whole(2, 30),
                           .columns = random.whole(1, 30),
                           .half_width_m = random.real(0.1, 100),
                           .direction = random.whole(0, 1) == 0 ? unidirectional : boustrophedon};
    const LineSearch staircase(p);
    p.ramped = true;
    const LineSearch ramped(p);
    const int count = p.rows * p.columns;
    for (int k = 0; k < count; ++k)
      ASSERT_EQ(line_search_aim(ramped, k).x(), line_search_aim(staircase, k).x());
    for (int k = 1; k < count; ++k)
      ASSERT_NEAR(line_search_aim(ramped, k - 1).y() - line_search_aim(ramped, k).y(),
                  2 * p.half_width_m / (count - 1), 1e-12);
  }
}

// 2 lines of 3 pulses at 10 Hz.
TEST(LineSearch, EveryLineBeginsWithAJump) {
  for (const LineDirection direction : {unidirectional, boustrophedon})
    for (const bool ramped : {false, true}) {
      const LineSearch pattern({.rows = 2, .columns = 3, .direction = direction, .ramped = ramped});
      for (int k = 0; k < 3; ++k) EXPECT_FALSE(pattern.last_jump({k, 0.1 * k}).has_value());
      const PatternJump jump = pattern.last_jump({5, 0.5}).value();
      EXPECT_DOUBLE_EQ(jump.since_s, 0.2);
      EXPECT_EQ(jump.before.pulse, 2);
      EXPECT_DOUBLE_EQ(jump.before.since_start_s, 0.2);
      EXPECT_EQ(pattern.last_jump({6, 0.6}).value().since_s, 0);
      EXPECT_EQ(pattern.last_jump({6, 0.6}).value().before.pulse, 5);
    }
  EXPECT_FALSE(LineSearch({.rows = 1, .columns = 1}).last_jump({5, 0.5}).has_value());
}

TEST(LineSearch, SaysWhetherItIsCompensated) {
  EXPECT_FALSE(LineSearch({.compensated = false}).compensated());
}

TEST(LineSearch, RefusesParametersOutOfRange) {
  EXPECT_THROW(LineSearch({.rows = 0}), UsageError);
  EXPECT_THROW(LineSearch({.rows = (1 << 20) + 1}), UsageError);
  EXPECT_THROW(LineSearch({.columns = 0}), UsageError);
  EXPECT_THROW(LineSearch({.columns = (1 << 20) + 1}), UsageError);
  EXPECT_THROW(LineSearch({.half_width_m = 0}), UsageError);
  EXPECT_THROW(LineSearch({.half_width_m = std::nan("")}), UsageError);
  EXPECT_THROW(LineSearch({.half_width_m = HUGE_VAL}), UsageError);
}

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

Vector3d aim(const StepStare& pattern, std::int64_t pulse) { return aim_of(pattern, {pulse, 0}); }

// 2 rows x 3 columns over +-6 m: tiles of 4 m x 6 m, two pulses each.
TEST(StepStare, RestsOnTheCentresOfItsTiles) {
  const StepStare pattern({.rows = 2, .columns = 3, .half_width_m = 6, .pulses_per_step = 2});
  const double expected[6][2] = {{-4, 3}, {0, 3}, {4, 3}, {4, -3}, {0, -3}, {-4, -3}};
  for (int k = 0; k < 12; ++k)
    EXPECT_EQ(aim(pattern, k), Vector3d(expected[k / 2][0], expected[k / 2][1], 0)) << "pulse " << k;
}

TEST(StepStare, UnidirectionalRunsEveryRowFromTheLeft) {
  const StepStare pattern({.rows = 2, .columns = 2, .half_width_m = 4, .direction = unidirectional});
  const double expected[4][2] = {{-2, 2}, {2, 2}, {-2, -2}, {2, -2}};
  for (int k = 0; k < 4; ++k) EXPECT_EQ(aim(pattern, k), Vector3d(expected[k][0], expected[k][1], 0));
}

// Every tile is visited once a pass, for pulses_per_step pulses; boustrophedon steps to a neighbour.
TEST(StepStare, VisitsEveryTileOnce) {
  PatternRandom random;
  for (int trial = 0; trial < 100; ++trial) {
    const StepStareParameters p{.rows = random.whole(1, 12),
                                .columns = random.whole(1, 12),
                                .half_width_m = random.real(1, 100),
                                .pulses_per_step = random.whole(1, 5),
                                .direction = random.whole(0, 1) == 0 ? unidirectional : boustrophedon};
    const StepStare pattern(p);
    const int count = p.rows * p.columns * p.pulses_per_step;
    std::map<std::pair<int, int>, int> pulses;
    for (int k = 0; k < count; ++k) {
      const Vector3d at = aim(pattern, k);
      const double column = (at.x() + p.half_width_m) / (2 * p.half_width_m) * p.columns - 0.5;
      const double row = (p.half_width_m - at.y()) / (2 * p.half_width_m) * p.rows - 0.5;
      ASSERT_NEAR(column, std::round(column), 1e-12);
      ASSERT_NEAR(row, std::round(row), 1e-12);
      ++pulses[{static_cast<int>(std::round(row)), static_cast<int>(std::round(column))}];
      ASSERT_EQ(at, aim(pattern, k + count)) << "the next pass differs";
    }
    ASSERT_EQ(pulses.size(), static_cast<std::size_t>(p.rows * p.columns));
    for (const auto& [tile, times] : pulses) {
      ASSERT_EQ(times, p.pulses_per_step);
      ASSERT_TRUE(tile.first >= 0 && tile.first < p.rows && tile.second >= 0 && tile.second < p.columns);
    }
    if (p.direction == unidirectional) continue;
    for (int k = 1; k < count; ++k) {
      const Vector3d step = (aim(pattern, k) - aim(pattern, k - 1)) / (2 * p.half_width_m);
      ASSERT_LE(std::abs(step.x()) * p.columns + std::abs(step.y()) * p.rows, 1 + 1e-12);
    }
  }
}

TEST(StepStare, StopsOnRequest) {
  const StepStare pattern({.rows = 2, .columns = 3, .pulses_per_step = 4, .at_end = stop});
  EXPECT_EQ(pattern.pulse_limit(), 24);
  EXPECT_TRUE(pattern.aim_point({23, 0}).has_value());
  EXPECT_FALSE(pattern.aim_point({24, 0}).has_value());
  EXPECT_FALSE(StepStare({}).pulse_limit().has_value());
}

// At 10 Hz and four pulses a step: pulse 10 is the third of its step, which began at pulse 8.
TEST(StepStare, EveryStepIsAJump) {
  const StepStare pattern({.rows = 2, .columns = 2, .pulses_per_step = 4});
  for (int k = 0; k < 4; ++k) EXPECT_FALSE(pattern.last_jump({k, 0.1 * k}).has_value());
  const PatternJump jump = pattern.last_jump({10, 1.0}).value();
  EXPECT_DOUBLE_EQ(jump.since_s, 0.2);
  EXPECT_EQ(jump.before.pulse, 7);
  EXPECT_DOUBLE_EQ(jump.before.since_start_s, 0.7);
  EXPECT_EQ(pattern.last_jump({16, 1.6}).value().since_s, 0) << "the next pass begins with a jump";
  EXPECT_FALSE(StepStare({.rows = 1, .columns = 1}).last_jump({5, 0.5}).has_value());
}

TEST(StepStare, SaysWhetherItIsCompensated) {
  EXPECT_TRUE(StepStare({}).compensated());
  EXPECT_FALSE(StepStare({.compensated = false}).compensated());
}

TEST(StepStare, RefusesParametersOutOfRange) {
  for (const int bad : {0, -1, (1 << 20) + 1}) {
    EXPECT_THROW(StepStare({.rows = bad}), UsageError) << bad;
    EXPECT_THROW(StepStare({.columns = bad}), UsageError) << bad;
    EXPECT_THROW(StepStare({.pulses_per_step = bad}), UsageError) << bad;
  }
  for (const double bad : {0.0, -1.0, HUGE_VAL, std::nan("")})
    EXPECT_THROW(StepStare({.half_width_m = bad}), UsageError) << bad;
}

}  // namespace
}  // namespace landfall
