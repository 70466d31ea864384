// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/reachable_area.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "refusal.h"

namespace landfall {
namespace {

constexpr double kTilt30 = std::numbers::pi / 6;

TEST(ReachableArea, ACircleHasItsBorder) {
  const ReachableArea area = ReachableArea::circle(5);
  EXPECT_TRUE(area.contains({3, -4}));
  EXPECT_FALSE(area.contains({3, -4 - 1e-8}));
  EXPECT_FALSE(area.contains({5, 0.001}));
  for (const Horizontal& vertex : area.outline()) EXPECT_NEAR(std::hypot(vertex.x, vertex.y), 5, 1e-12);
}

TEST(ReachableArea, APolygonInEitherDirectionAndAwayFromTheOrigin) {
  const std::vector<Horizontal> vertices = {{10, 10}, {14, 10}, {14, 12}, {12, 11}, {10, 14}};
  const ReachableArea area = ReachableArea::polygon(vertices);
  const ReachableArea reversed = ReachableArea::polygon({vertices.rbegin(), vertices.rend()});
  for (const ReachableArea& each : {area, reversed}) {
    EXPECT_TRUE(each.contains({11, 11}));
    EXPECT_TRUE(each.contains({13.9, 11.9}));
    EXPECT_FALSE(each.contains({12, 11.1}));  // above the concave vertex
    EXPECT_FALSE(each.contains({0, 0}));
    EXPECT_FALSE(each.contains({9, 10}));  // on the line of an edge
    EXPECT_TRUE(each.contains({12, 10}));  // on an edge
    EXPECT_TRUE(each.contains({12, 11}));  // on a vertex
    EXPECT_FALSE(each.contains({12, 9.99999}));
  }
  EXPECT_EQ(area.outline().size(), 5U);
}

TEST(ReachableArea, APolygonThatCrossesItselfIsEvenOdd) {
  const ReachableArea star =
      ReachableArea::polygon({{0, 3}, {1.8, -2.4}, {-2.9, 0.9}, {2.9, 0.9}, {-1.8, -2.4}});
  EXPECT_FALSE(star.contains({0, 0}));
  EXPECT_TRUE(star.contains({0, 2}));
  EXPECT_FALSE(star.contains({2, 2}));
}

TEST(ReachableArea, ADivertWithoutSpeedIsACircle) {
  // T = 40 s, a_z = 2 + 0.5, b = 2.5 tan 30 deg within sqrt(9 - 6.25).
  const ReachableArea area = ReachableArea::divert({.height_m = 200,
                                                    .descent_mps = std::sqrt(200.0),
                                                    .velocity_mps = {},
                                                    .position_m = {},
                                                    .tilt_rad = kTilt30,
                                                    .thrust_accel_mps2 = 3,
                                                    .gravity_mps2 = 2});
  const double time_s = 400 / std::sqrt(200.0);
  const double radius_m = 2.5 * std::tan(kTilt30) * time_s * time_s / 4;
  EXPECT_TRUE(area.contains({radius_m * (1 - 1e-9), 0}));
  EXPECT_FALSE(area.contains({0, -radius_m - 1e-6}));
  for (const Horizontal& vertex : area.outline()) EXPECT_NEAR(std::hypot(vertex.x, vertex.y), radius_m, 1e-9);
}

TEST(ReachableArea, ThrustLimitsTheHorizontalAcceleration) {
  // a_z = 1.5 + 1.5: sqrt(3.1^2 - 3^2) = 0.781 is below 3 tan 30 deg = 1.73. T = 20 s.
  const ReachableArea area = ReachableArea::divert({.height_m = 300,
                                                    .descent_mps = 30,
                                                    .velocity_mps = {},
                                                    .position_m = {},
                                                    .tilt_rad = kTilt30,
                                                    .thrust_accel_mps2 = 3.1,
                                                    .gravity_mps2 = 1.5});
  const double radius_m = std::sqrt(0.61) * 100;
  EXPECT_TRUE(area.contains({0, radius_m - 1e-6}));
  EXPECT_FALSE(area.contains({0, radius_m + 1e-6}));
}

/// The end of a flight with the two constant accelerations that bring the lander to rest at a place,
/// integrated in small steps, and the larger of the two.
struct Flight {
  double x = 0, y = 0, vx = 0, vy = 0;
  double largest = 0;
};
Flight flown_to(const DivertStart& start, Horizontal place) {
  const double time_s = 2 * start.height_m / start.descent_mps;
  const auto phases = [&](double from, double speed, double to) {
    // speed + (a + b) T/2 = 0 and from + speed T + a 3 T^2/8 + b T^2/8 = to.
    const double sum = -2 * speed / time_s;
    const double first = 4 * (to - from - speed * time_s) / (time_s * time_s) - sum / 2;
    return std::pair(first, sum - first);
  };
  const auto [ax, bx] = phases(start.position_m.x, start.velocity_mps.x, place.x);
  const auto [ay, by] = phases(start.position_m.y, start.velocity_mps.y, place.y);
  Flight flight{start.position_m.x, start.position_m.y, start.velocity_mps.x, start.velocity_mps.y,
                std::max(std::hypot(ax, ay), std::hypot(bx, by))};
  constexpr int kSteps = 20000;
  const double step_s = time_s / kSteps;
  for (int step = 0; step < kSteps; ++step) {
    const double accel_x = step < kSteps / 2 ? ax : bx;
    const double accel_y = step < kSteps / 2 ? ay : by;
    flight.x += (flight.vx + accel_x * step_s / 2) * step_s;
    flight.y += (flight.vy + accel_y * step_s / 2) * step_s;
    flight.vx += accel_x * step_s;
    flight.vy += accel_y * step_s;
  }
  return flight;
}

TEST(ReachableArea, PointsInsideAreFlownToWithinTheAcceleration) {
  const DivertStart start{.height_m = 300,
                          .descent_mps = 30,
                          .velocity_mps = {8, -3},
                          .position_m = {-40, 25},
                          .tilt_rad = kTilt30 / 2,
                          .thrust_accel_mps2 = 4,
                          .gravity_mps2 = 1.315};
  const double vertical = 1.315 + 1.5;
  const double limit = std::min(vertical * std::tan(kTilt30 / 2), std::sqrt(16 - vertical * vertical));
  const ReachableArea area = ReachableArea::divert(start);
  int inside = 0;
  for (double x = -150; x <= 250; x += 7)
    for (double y = -200; y <= 150; y += 7) {
      const Flight flight = flown_to(start, {x, y});
      ASSERT_NEAR(flight.x, x, 1e-6);
      ASSERT_NEAR(flight.y, y, 1e-6);
      ASSERT_NEAR(std::hypot(flight.vx, flight.vy), 0, 1e-8);
      ASSERT_EQ(area.contains({x, y}), flight.largest <= limit) << x << ' ' << y;
      inside += area.contains({x, y}) ? 1 : 0;
    }
  EXPECT_GT(inside, 100);
  for (const Horizontal& vertex : area.outline()) EXPECT_NEAR(flown_to(start, vertex).largest, limit, 1e-9);
}

TEST(ReachableArea, ALanderThatCannotStopItsDriftReachesNothing) {
  const DivertStart start{.height_m = 100,
                          .descent_mps = 20,
                          .velocity_mps = {50, 0},
                          .position_m = {},
                          .tilt_rad = kTilt30 / 2,
                          .thrust_accel_mps2 = 5,
                          .gravity_mps2 = 1.3};
  const ReachableArea area = ReachableArea::divert(start);
  EXPECT_TRUE(area.outline().empty());
  for (double x = 0; x <= 500; x += 5) EXPECT_FALSE(area.contains({x, 0}));
}

TEST(ReachableArea, WithoutTiltOnlyTheRestingPlaceRemains) {
  const ReachableArea area = ReachableArea::divert({.height_m = 100,
                                                    .descent_mps = 20,
                                                    .velocity_mps = {},
                                                    .position_m = {7, 8},
                                                    .thrust_accel_mps2 = 5,
                                                    .gravity_mps2 = 1.3});
  EXPECT_TRUE(area.contains({7, 8}));
  EXPECT_FALSE(area.contains({7, 8.001}));
}

TEST(ReachableArea, ThrustThatDoesNotStopTheDescentIsRefused) {
  const auto refusal = [](double thrust_mps2) -> std::string {
    return landfall::refusal([&] {
      return ReachableArea::divert({.height_m = 100,
                                    .descent_mps = 20,
                                    .velocity_mps = {},
                                    .position_m = {},
                                    .tilt_rad = kTilt30,
                                    .thrust_accel_mps2 = thrust_mps2,
                                    .gravity_mps2 = 1.5});
    });
  };
  EXPECT_EQ(
      refusal(3.49),
      "thrust_accel_mps2: 3.49 does not stop a descent of 20 m/s within 100 m: it takes 3.5 m/s2 (gravity "
      "+ descent^2 / 2 height)");
  EXPECT_EQ(refusal(3.5), "accepted");
}

}  // namespace
}  // namespace landfall
