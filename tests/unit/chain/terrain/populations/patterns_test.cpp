// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/core/error.h"
#include "chain/terrain/populations/line_pattern.h"
#include "chain/terrain/populations/patterns.h"
#include "chain/terrain/relief/feature_field.h"
#include "constants.h"
#include "populations/drawn.h"
#include "populations/expect_even.h"
#include "refusal.h"

namespace landfall {
namespace {

using testing::HasSubstr;

const RockPattern kRocks{{GolombekLaw{0.1}, {0.3, 3}}};
const IceBlockPattern kBlocks{{GolombekLaw{0.2}, {0.3, 3}}, 15 * kPi / 180};
const CraterPattern kCraters{{kTraskCraters, {1, 50}}, 0.2};

/// One number of every shape of a list.
template <class Shape, class F>
std::vector<double> values(const std::vector<Feature>& features, const F& value) {
  std::vector<double> list;
  for (const Feature& feature : features) list.push_back(value(std::get<Shape>(feature.shape)));
  return list;
}

/// N(0.5, 0.1) cut at 2.5 standard deviations: 0.62 % lie at each bound.
void expect_height_ratios(const std::vector<double>& ratios) {
  const double n = static_cast<double>(ratios.size());
  double sum = 0;
  for (const double ratio : ratios) {
    EXPECT_GE(ratio, 0.25 * (1 - 1e-15));
    EXPECT_LE(ratio, 0.75 * (1 + 1e-15));
    sum += ratio;
  }
  EXPECT_NEAR(sum / n, 0.5, 4 * 0.1 / std::sqrt(n));
  const auto below = std::ranges::count_if(ratios, [](double ratio) { return ratio < 0.4; });
  EXPECT_NEAR(static_cast<double>(below) / n, 0.158655, 4 * std::sqrt(0.1335 / n));
}

TEST(RockPattern, RocksAreHalfBuriedEllipsoidsOfAnyYaw) {
  const auto rocks = kRocks.features(hectare());
  EXPECT_GT(rocks.size(), 1900U);
  expect_even(values<Rock>(rocks, [](const Rock& r) { return r.yaw_rad; }), 0, 2 * kPi);
  expect_height_ratios(values<Rock>(rocks, [](const Rock& r) { return r.height_m / r.size().diameter_m; }));
  for (const double ratio : values<Rock>(rocks, [](const Rock& r) { return r.axis_ratio; }))
    EXPECT_EQ(ratio, 0.8);
}

// A size law counts the area of discs. Rocks of 0.3 to 3 m at k = 0.2 cover 0.0931 of the ground; here on 20
// hectares, within 5 standard deviations of a Poisson process (false alarms: 1 in 10^6).
TEST(RockPattern, RocksCoverTheAreaOfTheirLaw) {
  const DiameterRange range{0.3, 3};
  const GolombekLaw law{0.2};
  double area_m2 = 0;
  double square_m4 = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    for (const Feature& feature : RockPattern{{law, range}}.features(hectare(seed, 0))) {
      const auto& rock = std::get<Rock>(feature.shape);
      const double footprint_m2 = kPi / 4 * rock.diameter_m * (rock.axis_ratio * rock.diameter_m);
      EXPECT_NEAR(footprint_m2, kPi / 4 * std::pow(rock.size().diameter_m, 2), 1e-12);
      EXPECT_LT(rock.size().diameter_m, 3);
      area_m2 += footprint_m2;
      square_m4 += footprint_m2 * footprint_m2;
    }
  EXPECT_NEAR(law.area_fraction(range), 0.0931, 2e-4);
  EXPECT_NEAR(area_m2, 20e4 * law.area_fraction(range), 5 * std::sqrt(square_m4));
}

TEST(IceBlockPattern, TheLengthIsTheLongestSide) {
  const auto blocks = kBlocks.features(hectare());
  expect_even(values<IceBlock>(blocks, [](const IceBlock& b) { return b.tilt_rad; }), -kPi / 12, kPi / 12);
  expect_height_ratios(values<IceBlock>(blocks, [](const IceBlock& b) { return b.height_m / b.length_m; }));
  for (const Feature& feature : blocks) {
    const auto& block = std::get<IceBlock>(feature.shape);
    EXPECT_EQ(block.size().diameter_m, block.length_m);
    EXPECT_EQ(block.width_m, 0.8 * block.length_m);
  }
}

TEST(CraterPattern, FreshnessIsEven) {
  const auto craters = kCraters.features(hectare());
  EXPECT_GT(craters.size(), 700U);
  expect_even(values<Crater>(craters, [](const Crater& c) { return c.freshness; }), 0.2, 1);
  for (const double depth : values<Crater>(craters, [](const Crater& c) { return c.depth_m; }))
    EXPECT_EQ(depth, 0);  // that of its size
}

// The sampler takes objects for discs of a fixed reach: none may stick out.
TEST(ScatterPatterns, TheShapesStayWithinTheReachOfTheSampler) {
  for (const Feature& feature : kBlocks.features(hectare()))
    EXPECT_LE(std::get<IceBlock>(feature.shape).reach_m(),
              0.7665 * std::get<IceBlock>(feature.shape).length_m);
  IceBlockPattern packed = kBlocks;
  packed.population.overlap = false;
  const auto blocks = packed.features(hectare());
  for (std::size_t i = 0; i < blocks.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      ASSERT_GE(
          std::hypot(blocks[i].x_m - blocks[j].x_m, blocks[i].y_m - blocks[j].y_m),
          std::get<IceBlock>(blocks[i].shape).reach_m() + std::get<IceBlock>(blocks[j].shape).reach_m());
}

/// The features of one pattern of a model.
std::vector<Feature> of_pattern(const TerrainModel& model, std::int32_t pattern) {
  const FeatureField field(model, GridSpec::centered(50, 0.5));
  std::vector<Feature> list;
  for (const PlacedFeature& placed : field.features())
    if (placed.pattern == pattern) list.push_back(placed.feature);
  return list;
}

TEST(ScatterPatterns, RemovingOneChangesNoOther) {
  TerrainModel model;
  model.patterns = {kRocks, kBlocks, kCraters, kRocks};
  const auto blocks = of_pattern(model, 1);
  const auto craters = of_pattern(model, 2);
  EXPECT_NE(of_pattern(model, 0), of_pattern(model, 3));  // equal patterns draw apart
  TerrainModel shorter = model;
  shorter.patterns.pop_back();
  EXPECT_EQ(of_pattern(shorter, 1), blocks);
  EXPECT_EQ(of_pattern(shorter, 2), craters);
  // With seeds of their own they may also move up.
  auto& seeded_blocks = std::get<IceBlockPattern>(model.patterns[1]);
  seeded_blocks.population.seed = 1;
  auto& seeded_craters = std::get<CraterPattern>(model.patterns[2]);
  seeded_craters.population.seed = 2;
  model.patterns.erase(model.patterns.begin());
  EXPECT_EQ(of_pattern(model, 0), blocks);
  EXPECT_EQ(of_pattern(model, 1), craters);
}

// Pinned: a change of these is a change of every terrain that has them.
TEST(ScatterPatterns, TheDrawsStayWhatTheyAre) {
  const auto rocks = kRocks.features(hectare(1, 0));
  const auto blocks = kBlocks.features(hectare(1, 1));
  const auto craters = kCraters.features(hectare(1, 2));
  EXPECT_EQ(rocks.size(), 2220U);
  EXPECT_EQ(blocks.size(), 4614U);
  EXPECT_EQ(craters.size(), 827U);
  const auto& rock = std::get<Rock>(rocks[0].shape);
  const auto& block = std::get<IceBlock>(blocks[0].shape);
  const auto& crater = std::get<Crater>(craters[0].shape);
  const auto expect_all = [](const std::vector<double>& got, const std::vector<double>& expected) {
    for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(got[i], expected[i], 1e-11) << i;
  };
  expect_all(
      {rocks[0].x_m, rocks.back().y_m, rock.size().diameter_m, rock.height_m, rock.yaw_rad},
      {22.308032071125268, -48.35648851825276, 1.6107024767152174, 1.208026857536413, 4.9471494093546866});
  expect_all({blocks[0].x_m, blocks.back().y_m, block.length_m, block.tilt_rad},
             {-13.961640858567726, 7.8039267034943904, 2.4955663783013482, -0.067205459454479949});
  expect_all({craters[0].x_m, craters.back().y_m, crater.diameter_m, crater.freshness},
             {9.4821702006782971, -23.096609836827046, 39.406016123200722, 0.34289537424096911});
}

TEST(ScatterPatterns, RefuseParametersWithoutSense) {
  const auto refusal = [](const auto& pattern) -> std::string {
    return landfall::refusal([&] { pattern.validate("patterns/4"); });
  };
  EXPECT_EQ(refusal(kRocks), "accepted");
  EXPECT_EQ(refusal(kBlocks), "accepted");
  EXPECT_EQ(refusal(kCraters), "accepted");
  EXPECT_THAT(refusal(RockPattern{{GolombekLaw{0.1}, {0, 3}}}), HasSubstr("patterns/4/min_diameter_m"));
  EXPECT_THAT(refusal(IceBlockPattern{kBlocks.population, 0.3}), HasSubstr("patterns/4/max_tilt_rad: 0.3"));
  EXPECT_THAT(refusal(CraterPattern{kCraters.population, 0}), HasSubstr("patterns/4/freshness_min: 0"));
  EXPECT_THROW(RockPattern({{GolombekLaw{1}, {1e-3, 3}}}).require_bounded(hectare()), UsageError);
}

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
