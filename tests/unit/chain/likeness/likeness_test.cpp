// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/likeness/likeness.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "base/core/error.h"
#include "test_seed.h"

namespace landfall {
namespace {

/// A line scanner over hills.
struct Flight {
  int lines = 48, points = 50;
  double along_m = 1, across_m = 1.2;
  double noise_m = 0.02, jitter_m = 0.2;
  Horizontal shift{};
  double tilt_rad = 0;
  bool is_reversed = false;  ///< in time

  [[nodiscard]] static double hill(double x, double y) {
    return 3 * std::sin(x / 7) + 2 * std::cos(y / 5 + x / 11);
  }

  [[nodiscard]] ComparedScan scan(std::mt19937_64& random) const {
    std::normal_distribution<double> normal;
    ComparedScan scan;
    ReturnQuantity range{.name = "range_measured", .unit = "m", .values = {}};
    for (int n = 0; n < lines * points; ++n) {
      const int i = is_reversed ? lines * points - 1 - n : n;
      const double x = along_m * (i % points) + jitter_m * normal(random);
      const double y = across_m * (i / points) + jitter_m * normal(random);
      scan.x.push_back(x + shift.x);
      scan.y.push_back(y + shift.y);
      scan.z.push_back(hill(x, y) + noise_m * normal(random) + tilt_rad * x);
      scan.t.push_back(n);
      range.values.push_back(100 - scan.z.back());
    }
    scan.quantities = {range};
    return scan;
  }
};

std::map<std::string, LikenessStatistic> compared(const ComparedScan& a, const ComparedScan& b) {
  std::map<std::string, LikenessStatistic> by_name;
  for (const LikenessStatistic& each : likeness_of(a, b).statistics) by_name[each.name] = each;
  return by_name;
}

class LikenessTest : public ::testing::Test {
 protected:
  std::mt19937_64 random{test_seed()};
};

TEST_F(LikenessTest, AScanIsLikeItself) {
  const ComparedScan scan = Flight{}.scan(random);
  const Likeness likeness = likeness_of(scan, scan, true);
  EXPECT_EQ(likeness.statistics.size(), 13);
  for (const LikenessStatistic& each : likeness.statistics) {
    EXPECT_EQ(each.distance, 0) << each.name;
    EXPECT_TRUE(each.p == 1 || each.name == "elevation_spread") << each.name;
  }
  EXPECT_EQ(likeness.block_overlap, 1);
  EXPECT_EQ(likeness.covered_a, likeness.covered_b);
  double count = 0;
  for (const double each : likeness.counts[0].values()) count += each;
  EXPECT_EQ(count, static_cast<double>(scan.x.size()));
}

TEST_F(LikenessTest, TwoDrawsDifferOnlyByChance) {
  // p <= 0.01 in 1 % of the pairs at most: of 30, more than 4 with probability 1e-5, for each of 12.
  std::map<std::string, int> beyond;
  for (int pair = 0; pair < 30; ++pair) {
    const ComparedScan a = Flight{}.scan(random), b = Flight{}.scan(random);
    for (const auto& [name, each] : compared(a, b)) beyond[name] += each.differs().value_or(false) ? 1 : 0;
  }
  for (const auto& [name, count] : beyond) EXPECT_LE(count, 4) << name;
}

TEST_F(LikenessTest, ShiftAndTiltAreFound) {
  const ComparedScan a = Flight{}.scan(random);
  // Gradients turn over such a shift: least squares from no shift give 5.1 and 6.0 m.
  const SurfaceDifference surface = likeness_of(a, Flight{.shift = {5, 5}}.scan(random)).surface;
  EXPECT_NEAR(surface.shift_x_m, 5, 0.06);
  EXPECT_NEAR(surface.shift_y_m, 5, 0.06);
  const ComparedScan b = Flight{.shift = {0.4, -0.3}, .tilt_rad = 0.01}.scan(random);
  const Likeness likeness = likeness_of(a, b);
  EXPECT_NEAR(likeness.surface.shift_x_m, 0.4, 0.06);
  EXPECT_NEAR(likeness.surface.shift_y_m, -0.3, 0.06);
  EXPECT_NEAR(likeness.surface.tilt_x_rad, 0.01, 0.002);
  EXPECT_NEAR(likeness.surface.tilt_y_rad, 0, 0.002);
  for (const LikenessStatistic& each : likeness.statistics)
    EXPECT_TRUE(each.differs().value_or(false) ||
                (each.name != "shift" && each.name != "tilt" && each.name != "position"))
        << each.name;
}

TEST_F(LikenessTest, AnotherPulseRateChangesSpacingAndDensity) {
  auto found =
      compared(Flight{}.scan(random), Flight{.points = 100, .along_m = 0.5, .jitter_m = 0.1}.scan(random));
  EXPECT_NEAR(found["spacing_along"].a, 1, 0.1);
  EXPECT_NEAR(found["spacing_along"].b, 0.5, 0.05);
  EXPECT_NEAR(found["density"].b / found["density"].a, 2, 0.1);
  for (const char* const name : {"spacing_along", "density"})
    EXPECT_TRUE(found[name].differs().value()) << name;
}

TEST_F(LikenessTest, NoiseIsSeenByTheRoughness) {
  auto found = compared(Flight{}.scan(random), Flight{.noise_m = 0.3}.scan(random));
  EXPECT_TRUE(found["roughness"].differs().value());
  EXPECT_GT(found["roughness"].b, 1.2 * found["roughness"].a);
  EXPECT_GT(found["elevation_spread"].distance, 0.05);
  EXPECT_FALSE(found["spacing_along"].differs().value());
}

TEST_F(LikenessTest, PlacesHaveNoChanceLevelWhereBlocksSeeOtherGround) {
  const ComparedScan a = Flight{}.scan(random);
  const Likeness likeness = likeness_of(a, Flight{.is_reversed = true}.scan(random));
  EXPECT_LT(likeness.block_overlap, 0.1);
  for (const LikenessStatistic& each : likeness.statistics) {
    const bool is_of_places =
        !each.name.starts_with("spacing") && each.name != "roughness" && each.name != "range_measured";
    EXPECT_EQ(each.differs().has_value(), !is_of_places) << each.name;
  }
}

TEST_F(LikenessTest, WhatOneScanAloneHasIsNamed) {
  const ComparedScan a = Flight{}.scan(random);
  ComparedScan b = a;
  b.t.clear();
  b.quantities[0].name = "other";
  b.px = b.py = b.pz = std::vector<double>(b.x.size(), 100);
  EXPECT_EQ(likeness_of(a, b).not_in_both,
            (std::vector<std::string>{"range_measured", "other", "incidence", "coverage_time"}));
}

TEST_F(LikenessTest, IncidenceIsTheAngleToTheNormal) {
  ComparedScan plane = Flight{.jitter_m = 0}.scan(random);
  for (std::size_t i = 0; i < plane.x.size(); ++i) {
    plane.z[i] = plane.x[i] * std::tan(0.3);
    plane.px.push_back(plane.x[i]);
    plane.py.push_back(plane.y[i]);
    plane.pz.push_back(1000);
  }
  auto found = compared(plane, plane);
  EXPECT_NEAR(found["incidence"].a, 0.3 * 180 / std::acos(-1), 1e-6);
}

TEST_F(LikenessTest, ATooSmallScanIsRefused) {
  const ComparedScan scan = Flight{}.scan(random);
  const ComparedScan small = Flight{.lines = 1}.scan(random);
  EXPECT_THROW((void)likeness_of(scan, small), UsageError);
  ComparedScan point = scan;
  for (double& x : point.x) x = 1;
  for (double& y : point.y) y = 2;
  EXPECT_THROW((void)likeness_of(scan, point), UsageError);
}

}  // namespace
}  // namespace landfall
