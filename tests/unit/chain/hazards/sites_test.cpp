// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "base/numerics/random.h"
#include "bins.h"
#include "chain/hazards/reachable_area.h"
#include "chain/hazards/sites.h"
#include "refusal.h"

namespace landfall {
namespace {

constexpr float kFloatNan = std::numeric_limits<float>::quiet_NaN();

TEST(Touchdown, SmoothingOfOneSafeBinIsTheKernel) {
  const GridSpec spec = GridSpec::centered(2, 0.1);
  Grid<float> p(spec);
  p.at(spec.bin_of(0, 0)) = 1;
  const Grid<float> smooth = touchdown_probability(p, 0.25, BinMask(spec, 1));
  double norm = 0;
  for (int k = -7; k <= 7; ++k) norm += std::exp(-std::pow(k * 0.1 / 0.25, 2) / 2);
  double sum = 0;
  for (const float value : smooth.values()) sum += value;
  EXPECT_NEAR(sum, 1, 1e-5);
  const auto at = [&](double x, double y) { return smooth.at(spec.bin_of(x, y)); };
  EXPECT_NEAR(at(0, 0), 1 / (norm * norm), 1e-7);
  EXPECT_NEAR(at(0.3, -0.5), std::exp(-(0.09 + 0.25) / (2 * 0.0625)) / (norm * norm), 1e-7);
  EXPECT_EQ(at(0.8, 0), 0);  // beyond 3 sigma
}

TEST(Touchdown, WhatIsUnknownOrOffTheMapCountsAsUnsafe) {
  const GridSpec spec = GridSpec::centered(1, 0.1);
  Grid<float> p(spec, 1);
  p.at(spec.bin_of(0.5, 0)) = kFloatNan;
  BinMask region(spec, 1);
  region.at(spec.bin_of(-0.5, 0)) = 0;
  const Grid<float> smooth = touchdown_probability(p, 0.1, region);
  EXPECT_NEAR(smooth.at(spec.bin_of(0, -0.4)), 1, 1e-6);
  EXPECT_LT(smooth.at(spec.bin_of(0.4, 0)), 0.95);
  EXPECT_NEAR(smooth.at({0, 0}), std::pow((1 + smooth.at(spec.bin_of(0, -1)) * 2 - 1) / 2, 2), 1e-6);
  EXPECT_TRUE(std::isnan(smooth.at(spec.bin_of(-0.5, 0))));
  EXPECT_EQ(touchdown_probability(p, 0, region).at(spec.bin_of(0, 0)), 1);
  EXPECT_EQ(touchdown_probability(p, 0, region).at(spec.bin_of(0.5, 0)), 0);
}

TEST(Touchdown, TheKernelReachesThreeSigma) {
  const GridSpec spec = GridSpec::centered(1, 0.1);
  Grid<float> p(spec);
  p.at(spec.bin_of(0, 0)) = 1;
  const Grid<float> smooth = touchdown_probability(p, 0.1, BinMask(spec, 1));
  EXPECT_GT(smooth.at(spec.bin_of(0.3, 0)), 0.001);
  EXPECT_GT(smooth.at(spec.bin_of(0, -0.3)), 0.001);
  EXPECT_EQ(smooth.at(spec.bin_of(0.4, 0)), 0);
}

TEST(LandingCost, OfTheWholeMap) {
  const Grid<float> cost = landing_cost(Grid<float>(GridSpec::centered(2, 1), 0.75F), {.divert_radius_m = 3});
  for (const float value : cost.values()) EXPECT_GE(value, 0.25F);
}

TEST(LandingCost, GrowsWithTheDivert) {
  const GridSpec spec = GridSpec::centered(5, 1);
  const Grid<float> cost =
      landing_cost(Grid<float>(spec, 0.75F), {.divert_radius_m = 4, .divert_weight = 0.2});
  EXPECT_FLOAT_EQ(cost.at(spec.bin_of(0, 0)), 0.25F);
  EXPECT_FLOAT_EQ(cost.at(spec.bin_of(0, -4)), 0.45F);
  EXPECT_TRUE(std::isnan(cost.at(spec.bin_of(3, 3))));
}

TEST(LandingCost, OfAReachIsNanOutsideItAndKeepsItsScale) {
  const GridSpec spec = GridSpec::centered(5, 1);
  const Grid<float> cost = landing_cost(
      Grid<float>(spec, 0.75F), {.divert_radius_m = 4,
                                 .divert_weight = 0.2,
                                 .reach = ReachableArea::polygon({{-1, -5}, {5, -5}, {5, 0}, {-1, 0}})});
  EXPECT_FLOAT_EQ(cost.at(spec.bin_of(0, -4)), 0.45F);
  EXPECT_FLOAT_EQ(cost.at(spec.bin_of(3, -4)), 0.5F);  // beyond divert_radius_m
  EXPECT_FLOAT_EQ(cost.at(spec.bin_of(0, 0)), 0.25F);
  EXPECT_TRUE(std::isnan(cost.at(spec.bin_of(0, 1))));
  EXPECT_TRUE(std::isnan(cost.at(spec.bin_of(-2, -1))));
}

TEST(DistanceToHazard, IsEuclideanAndInTheRegion) {
  const GridSpec spec = GridSpec::centered(5, 0.5);
  Grid<std::int8_t> safe(spec, 1);
  BinMask region(spec, 1);
  EXPECT_TRUE(std::isnan(hazard_distance(safe, region).at({0, 0})));
  safe.at(spec.bin_of(0, 0)) = 2;
  safe.at(spec.bin_of(3, 4)) = 0;
  region.at(spec.bin_of(3, 4)) = 0;
  const Grid<float> distance = hazard_distance(safe, region);
  EXPECT_EQ(distance.at(spec.bin_of(0, 0)), 0);
  EXPECT_FLOAT_EQ(distance.at(spec.bin_of(4, 3)), 5);
  EXPECT_FLOAT_EQ(distance.at({0, 0}), std::hypot(5.0F, 5.0F));
  EXPECT_TRUE(std::isnan(distance.at(spec.bin_of(3, 4))));
  safe.at({0, 0}) = 0;
  EXPECT_EQ(hazard_distance(safe, region).at({0, 0}), 0);
}

TEST(Sites, AreTheBestThatLieApart) {
  const GridSpec spec = GridSpec::centered(10, 1);
  const RandomField field(3, RandomStream::dropout);
  Grid<float> cost(spec);
  Grid<std::int8_t> safe(spec, 1);
  for (std::size_t i = 0; i < spec.size(); ++i) {
    cost.values()[i] = static_cast<float>(std::floor(8 * field.uniform(2 * i)));  // many are equal
    safe.values()[i] = field.uniform(2 * i + 1) < 0.2 ? 0 : 1;
  }
  cost.at({3, 3}) = kFloatNan;
  const SiteParameters parameters{.count = 12, .separation_m = 5};
  const std::vector<BinIndex> sites = choose_sites(cost, safe, parameters);
  ASSERT_GT(sites.size(), 5U);
  const auto squared = [&](BinIndex bin) {
    return std::pow(spec.x(bin.col), 2) + std::pow(spec.y(bin.row), 2);
  };
  const auto key = [&](BinIndex bin) { return std::tuple(cost.at(bin), squared(bin), bin.row, bin.col); };
  const auto is_apart = [&](BinIndex bin, std::size_t rank) {
    for (std::size_t i = 0; i < rank; ++i)
      if (std::hypot(bin.row - sites[i].row, bin.col - sites[i].col) < 5) return false;
    return true;
  };
  for (std::size_t rank = 0; rank < sites.size(); ++rank) {
    EXPECT_TRUE(is_apart(sites[rank], rank));
    for (const BinIndex bin : bins_of(spec)) {
      if (safe.at(bin) != 1 || std::isnan(cost.at(bin)) || !is_apart(bin, rank)) continue;
      EXPECT_GE(key(bin), key(sites[rank]));
    }
  }
  EXPECT_TRUE(choose_sites(cost, Grid<std::int8_t>(spec), parameters).empty());
}

TEST(ChooseSites, NoBinIsChosenTwice) {
  const GridSpec spec = GridSpec::centered(1, 1);
  const std::vector<BinIndex> sites =
      choose_sites(Grid<float>(spec), Grid<std::int8_t>(spec, 1), {.count = 20, .separation_m = 0});
  ASSERT_EQ(sites.size(), 9U);
  EXPECT_EQ(sites[0], (BinIndex{1, 1}));
  EXPECT_EQ(sites[1], (BinIndex{0, 1}));
}

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
