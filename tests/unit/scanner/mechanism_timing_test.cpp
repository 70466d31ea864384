// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanner/mechanism_timing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/error.h"
#include "steering.h"

namespace landfall {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

TEST(MechanismTiming, DefaultFollowsAtOnce) {
  const MechanismTiming timing({});
  for (const double t : {0.0, 1e-6, 1.0, kNever}) {
    EXPECT_FALSE(timing.blanks(t));
    EXPECT_EQ(timing.step_left(t), 0);
  }
}

// 20 kHz, 1 ms: twenty pulses. The times are quotients such as 220/20000 - 200/20000, just below 1 ms.
TEST(MechanismTiming, BlanksTheTimeTimesTheRate) {
  const MechanismTiming timing({.turnaround_time_s = 1e-3});
  for (int line = 0; line < 200; ++line) {
    int blanked = 0;
    for (int k = 0; k < 200; ++k)
      if (timing.blanks((200 * line + k) / 20000.0 - 200 * line / 20000.0)) ++blanked;
    EXPECT_EQ(blanked, 20) << "line " << line;
  }
  EXPECT_FALSE(timing.blanks(kNever));
}

// Against the differential equation x'' + 2 zeta w x' + w^2 x = 0, x(0) = 1, x'(0) = 0, by small steps.
TEST(MechanismTiming, StepSolvesTheOscillator) {
  RandomCases random;
  for (int i = 0; i < 20; ++i) {
    const double zeta = random.uniform(0.2, 0.95);
    const double settle_s = random.uniform(1e-4, 1e-2);
    const MechanismTiming timing({.settle_time_s = settle_s, .settle_damping = zeta});
    const double w = 3 / (zeta * settle_s);
    constexpr int kSteps = 50000;
    const double h = 2 * settle_s / kSteps;
    double x = 1;
    double v = 0;
    for (int k = 1; k <= kSteps; ++k) {
      // The midpoint rule; its error over the run is far below the tolerance.
      const double x_mid = x + h / 2 * v;
      const double v_mid = v - h / 2 * (2 * zeta * w * v + w * w * x);
      x += h * v_mid;
      v -= h * (2 * zeta * w * v_mid + w * w * x_mid);
      if (k % 1000 == 0) {
        ASSERT_NEAR(timing.step_left(k * h), x, 2e-5) << "zeta " << zeta;
      }
    }
  }
}

TEST(MechanismTiming, SettlesWithinItsEnvelope) {
  for (const double zeta : {0.1, 0.4, 0.7, 0.9}) {
    const MechanismTiming timing({.settle_time_s = 2e-3, .settle_damping = zeta});
    const double envelope = std::exp(-3.0) / std::sqrt(1 - zeta * zeta);
    EXPECT_EQ(timing.step_left(0), 1);
    for (double t = 2e-3; t < 6e-3; t += 1e-5) EXPECT_LE(std::abs(timing.step_left(t)), envelope);
    EXPECT_EQ(timing.step_left(0.1), 0);
    EXPECT_EQ(timing.step_left(kNever), 0);
  }
}

TEST(MechanismTiming, RefusesParametersOutOfRange) {
  EXPECT_THROW(MechanismTiming({.turnaround_time_s = -1e-9}), UsageError);
  EXPECT_THROW(MechanismTiming({.turnaround_time_s = HUGE_VAL}), UsageError);
  EXPECT_THROW(MechanismTiming({.settle_time_s = -1e-9}), UsageError);
  EXPECT_THROW(MechanismTiming({.settle_time_s = std::nan("")}), UsageError);
  EXPECT_THROW(MechanismTiming({.settle_damping = 0}), UsageError);
  EXPECT_THROW(MechanismTiming({.settle_damping = 1}), UsageError);
}

}  // namespace
}  // namespace landfall
