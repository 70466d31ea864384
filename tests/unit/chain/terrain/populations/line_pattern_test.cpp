// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/populations/line_pattern.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "populations/drawn.h"
#include "populations/expect_even.h"
#include "refusal.h"

namespace landfall {
namespace {

using testing::HasSubstr;

/// Ridges of 20 to 60 m towards 0.4 +- 0.3 rad.
LinePattern ridges() {
  Ridge ridge;
  ridge.length_m = 60;
  ridge.width_m = 2;
  ridge.taper_m = 5;
  ridge.yaw_rad = 0.4;
  return {ridge, 2e-3, 20, 0.3};
}

TEST(LinePattern, CountsPlacesLengthsAndYaws) {
  const LinePattern pattern = ridges();
  const double half_m = 50 + std::get<Ridge>(pattern.shape).reach_m();
  const double expected = 2e-3 * 4 * half_m * half_m;
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> lengths;
  std::vector<double> yaws;
  double squares = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const auto lines = pattern.features(hectare(seed));
    const double excess = static_cast<double>(lines.size()) - expected;
    squares += excess * excess / expected;
    for (const Feature& line : lines) {
      const auto& ridge = std::get<Ridge>(line.shape);
      x.push_back(line.x_m);
      y.push_back(line.y_m);
      lengths.push_back(ridge.length_m);
      yaws.push_back(ridge.yaw_rad);
      EXPECT_EQ(ridge.width_m, 2);
    }
  }
  EXPECT_NEAR(static_cast<double>(x.size()), 100 * expected, 3 * std::sqrt(100 * expected));
  EXPECT_NEAR(squares / 100, 1, 3 * std::sqrt(0.02));
  expect_even(x, -half_m, half_m);
  expect_even(y, -half_m, half_m);
  expect_even(lengths, 20, 60);
  expect_even(yaws, 0.1, 0.7);
}

TEST(LinePattern, SeedsDrawApartAndADensityAddsOnly) {
  LinePattern pattern = ridges();
  const auto lines = pattern.features(hectare(1, 0));
  EXPECT_NE(lines, pattern.features(hectare(1, 1)));
  EXPECT_NE(lines, pattern.features(hectare(2, 0)));
  pattern.density_per_m2 *= 2;
  auto more = pattern.features(hectare(1, 0));
  ASSERT_GT(more.size(), lines.size());
  more.resize(lines.size());
  EXPECT_EQ(more, lines);
  pattern = ridges();
  pattern.seed = 0;
  EXPECT_EQ(pattern.features(hectare(1, 5)), lines);
}

TEST(LinePattern, EqualLengthsAndOneDirection) {
  Fracture fracture;
  fracture.yaw_rad = 1;
  for (const Feature& line : LinePattern{fracture, 1e-3, fracture.length_m, 0}.features(hectare()))
    EXPECT_EQ(line.shape, FeatureShape(fracture));
}

TEST(LinePattern, RefusesParametersWithoutSense) {
  const auto of = [](const auto& change) -> std::string {
    LinePattern pattern = ridges();
    change(pattern);
    return refusal([&] {
      pattern.validate("patterns/0");
      pattern.require_bounded(hectare());
    });
  };
  EXPECT_EQ(of([](LinePattern&) {}), "accepted");
  EXPECT_THAT(of([](LinePattern& p) { p.density_per_m2 = 0; }), HasSubstr("patterns/0/density_per_m2: 0"));
  EXPECT_THAT(of([](LinePattern& p) { p.shortest_m = 0; }), HasSubstr("patterns/0/shortest_m: 0"));
  EXPECT_THAT(of([](LinePattern& p) { p.shortest_m = 61; }), HasSubstr("patterns/0/shortest_m: 61"));
  EXPECT_THAT(of([](LinePattern& p) { p.shortest_m = 9; }),
              HasSubstr("feature/taper_m: 5 is not at most half"));
  EXPECT_THAT(of([](LinePattern& p) { p.yaw_spread_rad = 2; }), HasSubstr("yaw_spread_rad: 2"));
  EXPECT_THAT(of([](LinePattern& p) { p.seed = 1ULL << 32U; }), HasSubstr("seed"));
  EXPECT_THAT(of([](LinePattern& p) { std::get<Ridge>(p.shape).width_m = 0; }),
              HasSubstr("feature/width_m: 0"));
  EXPECT_EQ(of([](LinePattern& p) { p.density_per_m2 = 1e3; }).substr(0, 17), "patterns/0: about");
}

}  // namespace
}  // namespace landfall
