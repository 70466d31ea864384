// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/gridding/pose_track.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "base/core/error.h"
#include "refusal.h"

namespace landfall {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Eigen::Quaterniond yaw(double angle) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
}

// From (0, 0, 500) down 10 m per second, turning a quarter about z, over [start, start + 2] s.
ScanPoses descent(const std::string& name, double start) {
  return {name,
          {start, start + 1, start + 2},
          {{0, 0, 500}, {1, 0, 490}, {2, 0, 480}},
          {yaw(0), yaw(std::numbers::pi / 4), yaw(std::numbers::pi / 2)}};
}

template <class ErrorType>
std::string track_refusal(std::vector<ScanPoses> scans) {
  return refusal<ErrorType>([&] { const PoseTrack track(std::move(scans)); });
}

TEST(PoseTrack, InterpolatesAndHoldsTheEnds) {
  const PoseTrack track({descent("a.h5", 10)});
  EXPECT_TRUE(track.at(10.25).position.v.isApprox(Eigen::Vector3d(0.25, 0, 497.5), 1e-15));
  EXPECT_DOUBLE_EQ(track.at(10.25).since_start_s, 0.25);
  EXPECT_TRUE(track.at(11).position.v.isApprox(Eigen::Vector3d(1, 0, 490), 1e-15));
  EXPECT_TRUE(track.at(12).position.v.isApprox(Eigen::Vector3d(2, 0, 480), 1e-15));
  EXPECT_TRUE(track.at(99).position.v.isApprox(Eigen::Vector3d(2, 0, 480), 1e-15));
  EXPECT_EQ(track.at(99).since_start_s, 2);
  EXPECT_TRUE(track.at(-1).position.v.isApprox(Eigen::Vector3d(0, 0, 500), 1e-15));
  EXPECT_EQ(track.at(-1).since_start_s, 0);
}

TEST(PoseTrack, TurnsTheShortWay) {
  ScanPoses poses = descent("a.h5", 0);
  poses.attitude[1].coeffs() *= -1;  // the same attitude
  const PoseTrack track({poses});
  const Eigen::Matrix3d halfway = yaw(std::numbers::pi / 8).toRotationMatrix();
  EXPECT_TRUE(track.at(0.5).attitude.m.isApprox(halfway, 1e-14));
  EXPECT_TRUE(track.at(2).attitude.m.isApprox(yaw(std::numbers::pi / 2).toRotationMatrix(), 1e-14));
}

TEST(PoseTrack, OnePoseHoldsAlways) {
  const PoseTrack track({{"a.h5", {5}, {{1, 2, 3}}, {yaw(0)}}});
  EXPECT_EQ(track.at(4).position.v, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(track.at(6).since_start_s, 0);
}

TEST(PoseTrack, PosesMayBeAnyTimeApart) {
  const PoseTrack track({{"a.h5", {0, 4}, {{0, 0, 0}, {8, 0, 0}}, {yaw(0), yaw(0.4)}}});
  EXPECT_EQ(track.at(1).position.v.x(), 2);
  EXPECT_TRUE(track.at(2).attitude.m.isApprox(yaw(0.2).toRotationMatrix(), 1e-14));
}

// Two pulses at one time: the later one counts from then on.
TEST(PoseTrack, TimesMayRepeat) {
  const PoseTrack track({{"a.h5",
                          {0, 1, 1, 2, 2},
                          {{0, 0, 0}, {1, 0, 0}, {5, 0, 0}, {6, 0, 0}, {9, 0, 0}},
                          {yaw(0), yaw(0), yaw(0), yaw(0), yaw(0)}}});
  EXPECT_EQ(track.at(0.5).position.v.x(), 0.5);
  EXPECT_EQ(track.at(1).position.v.x(), 5);
  EXPECT_EQ(track.at(1.5).position.v.x(), 5.5);
  EXPECT_EQ(track.at(2).position.v.x(), 9);
  EXPECT_EQ(track.at(99).position.v.x(), 9);
  EXPECT_TRUE(track.at(2).attitude.m.isIdentity(1e-15));
}

TEST(PoseTrack, ScansMayFollowOneAnotherInAnyOrderOfGiving) {
  const PoseTrack track({descent("late.h5", 10), descent("early.h5", 0)});
  EXPECT_DOUBLE_EQ(track.at(1.5).since_start_s, 1.5);
  EXPECT_DOUBLE_EQ(track.at(11.5).since_start_s, 1.5);
  EXPECT_EQ(track.at(10).since_start_s, 0);        // the later one has begun
  EXPECT_DOUBLE_EQ(track.at(5).since_start_s, 2);  // between them: the end of the earlier
}

TEST(PoseTrack, ScansMayRepeatThePoses) {
  EXPECT_DOUBLE_EQ(PoseTrack({descent("a.h5", 0), descent("b.h5", 0)}).at(1.5).since_start_s, 1.5);
}

TEST(PoseTrack, RefusesTwoPosesAtOneTime) {
  EXPECT_THAT(track_refusal<UsageError>({descent("a.h5", 0), descent("b.h5", 2)}),
              AllOf(HasSubstr("a.h5"), HasSubstr("b.h5"), HasSubstr("overlaps")));
  ScanPoses moved = descent("b.h5", 0);
  moved.position_m[2].x() += 1;
  EXPECT_THAT(track_refusal<UsageError>({descent("a.h5", 0), moved}), HasSubstr("overlaps"));
}

TEST(PoseTrack, RefusesWhatIsNoTrack) {
  EXPECT_THAT(track_refusal<FormatError>({{"a.h5", {}, {}, {}}}),
              AllOf(HasSubstr("a.h5"), HasSubstr("no poses")));
  ScanPoses poses = descent("a.h5", 0);
  poses.t_s = {0, 2, 1};
  EXPECT_THAT(track_refusal<FormatError>({poses}), AllOf(HasSubstr("a.h5"), HasSubstr("ascending")));
  poses.t_s = {1, 0, 2};
  EXPECT_THAT(track_refusal<FormatError>({poses}), HasSubstr("ascending"));
  poses = descent("a.h5", 0);
  poses.position_m[0].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(track_refusal<FormatError>({poses}), HasSubstr("not finite"));
  poses = descent("a.h5", 0);
  poses.t_s[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(track_refusal<FormatError>({poses}), HasSubstr("not finite"));
  poses = descent("a.h5", 0);
  poses.position_m[1].y() = std::numeric_limits<double>::infinity();
  EXPECT_THAT(track_refusal<FormatError>({poses}), HasSubstr("not finite"));
  poses = descent("a.h5", 0);
  poses.attitude[2].coeffs().setZero();
  EXPECT_THAT(track_refusal<FormatError>({poses}), HasSubstr("not finite"));
  poses = descent("a.h5", 0);
  poses.attitude.pop_back();
  EXPECT_THAT(track_refusal<FormatError>({poses}), HasSubstr("different lengths"));
}

}  // namespace
}  // namespace landfall
