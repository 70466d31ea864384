// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/error_models/pointing_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "base/numerics/random.h"
#include "refusal.h"
#include "test_seed.h"

namespace landfall {
namespace {

constexpr std::int64_t kPointingPulses = 100000;

/// The direction of a beam along the boresight.
Eigen::Vector3d boresight(const PointingError& error, std::int64_t pulse) {
  return error.rotation(pulse).m * Eigen::Vector3d::UnitZ();
}

double mean_over_pulses(const std::function<double(std::int64_t pulse)>& value) {
  double sum = 0;
  for (std::int64_t pulse = 0; pulse < kPointingPulses; ++pulse) sum += value(pulse);
  return sum / static_cast<double>(kPointingPulses);
}

TEST(PointingError, NoneByDefault) {
  const PointingError none;
  EXPECT_FALSE(none.turns_beams());
  EXPECT_EQ(none.rotation(5).m, Eigen::Matrix3d::Identity());
  EXPECT_EQ(none.time_stamp_error_s(5), 0);
}

// About x_L by a the boresight leans to -y_L by sin a, about y_L by b to +x_L.
TEST(PointingError, MisalignmentIsFixed) {
  const PointingError about_x({.misalignment = {0.01, 0, 0}}, 1);
  EXPECT_TRUE(about_x.turns_beams());
  EXPECT_LT((boresight(about_x, 0) - Eigen::Vector3d(0, -std::sin(0.01), std::cos(0.01))).norm(), 1e-16);
  EXPECT_EQ(boresight(about_x, 0), boresight(about_x, 77));
  const PointingError about_y({.misalignment = {0, 0.02, 0}}, 1);
  EXPECT_LT((boresight(about_y, 0) - Eigen::Vector3d(std::sin(0.02), 0, std::cos(0.02))).norm(), 1e-16);
}

// 5 standard errors throughout: a right generator fails one comparison in 1.7 million.
TEST(PointingError, JitterHasItsSigmaOnEachAxis) {
  const PointingError error({.jitter_sigma_x_rad = 1e-4, .jitter_sigma_y_rad = 3e-4}, test_seed());
  EXPECT_TRUE(error.turns_beams());
  const double tolerance = 5 * std::sqrt(2.0 / kPointingPulses);
  EXPECT_NEAR(mean_over_pulses([&](auto k) { return std::pow(boresight(error, k).y() / 1e-4, 2); }), 1,
              tolerance);
  EXPECT_NEAR(mean_over_pulses([&](auto k) { return std::pow(boresight(error, k).x() / 3e-4, 2); }), 1,
              tolerance);
  const double once = 5 / std::sqrt(double{kPointingPulses});
  EXPECT_NEAR(mean_over_pulses([&](auto k) { return boresight(error, k).y() / 1e-4; }), 0, once);
  EXPECT_NEAR(
      mean_over_pulses([&](auto k) { return boresight(error, k).x() * boresight(error, k).y() / 3e-8; }), 0,
      once);
}

TEST(PointingError, JitterAboutOneAxisLeavesTheOther) {
  const PointingError about_x({.jitter_sigma_x_rad = 0.1}, 4);
  const PointingError about_y({.jitter_sigma_y_rad = 0.1}, 4);
  EXPECT_EQ(boresight(about_x, 9).x(), 0);
  EXPECT_NE(boresight(about_x, 9).y(), 0);
  EXPECT_EQ(boresight(about_y, 9).y(), 0);
  EXPECT_NE(boresight(about_y, 9).x(), 0);
}

TEST(PointingError, JitterComesFirstInTheMisalignedLidar) {
  const RollPitchYaw misalignment{0.3, 0.2, 0.1};
  const PointingError jitter({.jitter_sigma_x_rad = 0.1, .jitter_sigma_y_rad = 0.1}, 4);
  const PointingError both(
      {.misalignment = misalignment, .jitter_sigma_x_rad = 0.1, .jitter_sigma_y_rad = 0.1}, 4);
  EXPECT_LT((both.rotation(9).m - rotation_matrix(misalignment) * jitter.rotation(9).m).norm(), 1e-15);
  EXPECT_GT((both.rotation(9).m - jitter.rotation(9).m * rotation_matrix(misalignment)).norm(), 1e-3);
}

TEST(PointingError, JitterWithACorrelationTimeIsAProcessOfThePulses) {
  const PointingError error({.jitter_sigma_x_rad = 0.5,
                             .jitter_sigma_y_rad = 0.25,
                             .jitter_time_s = 0.01,
                             .pulse_interval_s = 5e-5},
                            4);
  const PulseProcess process(5e-3);
  const RandomField draws(4, RandomStream::pointing_jitter);
  for (const std::int64_t k : {0, 1, 17, 40000})
    EXPECT_EQ(error.rotation(k).m,
              rotation_matrix({0.5 * process.at(k, draws, 0), 0.25 * process.at(k, draws, 1), 0}));
  EXPECT_LT((boresight(error, 100) - boresight(error, 101)).norm(), 0.2);
}

TEST(PointingError, TimeStampsHaveTheirBiasAndSigma) {
  const PointingError bias({.time_stamp_bias_s = -0.002}, 1);
  EXPECT_FALSE(bias.turns_beams());
  EXPECT_EQ(bias.time_stamp_error_s(3), -0.002);
  const PointingError error({.time_stamp_bias_s = 0.5, .time_stamp_sigma_s = 0.1}, test_seed());
  EXPECT_NEAR(mean_over_pulses([&](auto k) { return error.time_stamp_error_s(k); }), 0.5,
              5 * 0.1 / std::sqrt(double{kPointingPulses}));
  EXPECT_NEAR(
      mean_over_pulses([&](auto k) { return std::pow((error.time_stamp_error_s(k) - 0.5) / 0.1, 2); }), 1,
      5 * std::sqrt(2.0 / kPointingPulses));
  EXPECT_DOUBLE_EQ(error.largest_time_stamp_error_s(), 1.4);
  for (std::int64_t k = 0; k < kPointingPulses; ++k) ASSERT_LE(error.time_stamp_error_s(k), 1.4);
}

TEST(PointingError, TheMirrorClockHasItsBiasAndSigma) {
  const PointingError bias({.mirror_time_bias_s = -1e-5}, 1);
  EXPECT_FALSE(bias.turns_beams());
  EXPECT_EQ(bias.mirror_time_error_s(3), -1e-5);
  EXPECT_EQ(PointingError().mirror_time_error_s(3), 0);
  const PointingError error({.mirror_time_bias_s = 0.5, .mirror_time_sigma_s = 0.25}, 4);
  EXPECT_EQ(error.mirror_time_error_s(9), 0.5 + 0.25 * RandomField(4, RandomStream::mirror_time).normal(9));
}

TEST(PointingError, ASigmaOfOneIsASigma) {
  const PointingError jitter({.jitter_sigma_x_rad = 1, .jitter_sigma_y_rad = 1}, 4);
  const RandomField draws(4, RandomStream::pointing_jitter);
  EXPECT_EQ(jitter.rotation(9).m, rotation_matrix({draws.normal(9, 0), draws.normal(9, 1), 0}));
  const PointingError stamp({.time_stamp_bias_s = 0.25, .time_stamp_sigma_s = 1}, 4);
  EXPECT_EQ(stamp.time_stamp_error_s(9), 0.25 + RandomField(4, RandomStream::time_stamp).normal(9));
}

TEST(PointingError, OneErrorChangesNoDrawOfAnother) {
  const PointingError jitter({.jitter_sigma_x_rad = 0.1}, 4);
  const PointingError stamp({.time_stamp_sigma_s = 0.1}, 4);
  const PointingError both({.jitter_sigma_x_rad = 0.1, .time_stamp_sigma_s = 0.1, .mirror_time_sigma_s = 0.1},
                           4);
  for (std::int64_t k = 0; k < 100; ++k) {
    EXPECT_EQ(both.rotation(k), jitter.rotation(k));
    EXPECT_EQ(both.time_stamp_error_s(k), stamp.time_stamp_error_s(k));
    EXPECT_EQ(stamp.rotation(k).m, Eigen::Matrix3d::Identity());
    EXPECT_EQ(jitter.time_stamp_error_s(k), 0);
  }
}

TEST(PointingError, AMillionSecondsAreWithinTheBounds) {
  EXPECT_EQ(PointingError({.time_stamp_bias_s = -1e6}, 1).time_stamp_error_s(0), -1e6);
  EXPECT_EQ(PointingError({.time_stamp_sigma_s = 1e6}, 1).largest_time_stamp_error_s(), 9e6);
}

TEST(PointingError, RefusesWhatIsOutOfRange) {
  const auto refused = [](const PointingErrorParameters& p, const char* message) {
    EXPECT_THAT(refusal([&] { const PointingError error(p, 1); }), testing::HasSubstr(message));
  };
  refused({.misalignment = {0, std::nan(""), 0}}, "misalignment_rpy_rad/1");
  refused({.jitter_sigma_x_rad = -1}, "jitter_sigma_rad: -1 is not finite and >= 0");
  refused({.jitter_sigma_y_rad = HUGE_VAL}, "jitter_sigma_rad");
  refused({.time_stamp_bias_s = HUGE_VAL}, "time_stamp_bias_s");
  refused({.time_stamp_bias_s = -1.5e6}, "time_stamp_bias_s: -1500000 is not in [-1e6, 1e6]");
  refused({.time_stamp_sigma_s = -1e-3}, "time_stamp_sigma_s: -0.001");
  refused({.time_stamp_sigma_s = 1.5e6}, "time_stamp_sigma_s: 1500000 is not in [0, 1e6]");
  refused({.mirror_time_bias_s = -1.5}, "mirror_time_bias_s: -1.5 is not in [-1, 1]");
  refused({.mirror_time_bias_s = std::nan("")}, "mirror_time_bias_s");
  refused({.jitter_time_s = -1}, "jitter_time_s: -1 is not in [0, 1e6]");
  refused({.jitter_time_s = 1.5e6}, "jitter_time_s");
  refused({.jitter_time_s = 1}, "pulse_interval_s: 0");
  refused({.mirror_time_sigma_s = -1e-6}, "mirror_time_sigma_s: -1e-06");
  refused({.mirror_time_sigma_s = 1.5}, "mirror_time_sigma_s: 1.5 is not in [0, 1]");
}

}  // namespace
}  // namespace landfall
