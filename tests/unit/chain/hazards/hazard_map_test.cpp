// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/hazard_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>

#include "bins.h"
#include "constants.h"
#include "refusal.h"

namespace landfall {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const PhaseRunner kAtOnce = [](const std::string& /*name*/, const auto& part) { part({}); };

HazardInput level_terrain(double half_width_m, double resolution_m) {
  const GridSpec spec = GridSpec::centered(half_width_m, resolution_m);
  return {Grid<double>(spec), std::nullopt, BinMask(spec), std::nullopt};
}

HazardParameters small_lander() {
  HazardParameters parameters;
  parameters.lander = {.leg_radius_m = 0.3, .pad_diameter_m = 0.1, .body_radius_m = 0.3};
  parameters.touchdown_sigma_m = 0;
  return parameters;
}

std::string map_refusal(HazardInput input, const HazardParameters& parameters) {
  return kind_and_refusal([&] { return map_hazards(input, parameters, kAtOnce); });
}

/// On 21 x 21 bins of 0.1 m.
std::string level_refusal(const HazardParameters& parameters) {
  return map_refusal(level_terrain(1, 0.1), parameters);
}

TEST(HazardParameters, DefaultsAreThoseOfTheDocumentation) {
  const HazardParameters parameters;
  EXPECT_EQ(parameters.region_radius_m, 50);
  EXPECT_EQ(parameters.hole_fill_bins, 10);
  EXPECT_EQ(parameters.touchdown_sigma_m, 1);
  EXPECT_EQ(parameters.limits.slope_deg, 10);
  EXPECT_EQ(parameters.limits.roughness_m, 0.3);
  EXPECT_EQ(parameters.sites.count, 5);
  EXPECT_EQ(parameters.sites.separation_m, 5);
  EXPECT_EQ(parameters.sites.divert_radius_m, 40);
  EXPECT_EQ(parameters.sites.divert_weight, 0.1);
  EXPECT_EQ(parameters.sites.min_p, 0.99);
}

// 21 x 21 bins; the lander reaches 3 bins.
TEST(MapHazards, LevelGroundIsSafeWhereTheLanderFits) {
  HazardInput input = level_terrain(1, 0.1);
  const HazardMap map = map_hazards(input, small_lander(), kAtOnce);
  const PlaceCounts counts = count_places(map.safe, map.region);
  EXPECT_EQ(counts.safe, 15 * 15);
  EXPECT_EQ(counts.hazard, 0);
  EXPECT_EQ(counts.unknown, 21 * 21 - 15 * 15);
  EXPECT_EQ(counts.all(), 21 * 21);
  EXPECT_FALSE(map.truth || map.p_safe);
  const LandingSite& best = map.sites.at(0);
  EXPECT_EQ(best.bin, (BinIndex{10, 10}));
  EXPECT_EQ(best.cost, 0);
  EXPECT_EQ(best.p_touchdown, 1);
  EXPECT_EQ(best.slope_deg, 0);
  EXPECT_EQ(best.roughness_m, 0);
  EXPECT_FLOAT_EQ(best.hazard_distance_m.value(), 0.8F);  // unknown places are not safe
  EXPECT_EQ(best.truth, Safety::unknown);
  EXPECT_EQ(map.sites.size(), 1U);  // others would be 5 m away
  EXPECT_EQ(map.p_touchdown.at({0, 0}), 0);
}

TEST(MapHazards, OnlyTheRegionIsJudged) {
  HazardParameters parameters = small_lander();
  parameters.region_radius_m = 0.2;  // i^2 + j^2 < 4
  HazardInput input = level_terrain(1, 0.1);
  const HazardMap map = map_hazards(input, parameters, kAtOnce);
  EXPECT_EQ(count_places(map.safe, map.region).safe, 9);
  EXPECT_EQ(count_places(map.safe, map.region).all(), 9);
  EXPECT_EQ(map.safe.at({10, 12}), 2);
  EXPECT_TRUE(std::isnan(map.measures.slope_deg.at({10, 12})));
  EXPECT_TRUE(std::isnan(map.p_touchdown.at({10, 12})));
  EXPECT_FALSE(map.sites.at(0).hazard_distance_m);
}

TEST(MapHazards, TruthIsJudgedByTheSameLimits) {
  HazardInput input = level_terrain(1, 0.1);
  input.z_true = input.z;
  input.z_true->at({10, 10}) = 0.31;  // a hazard wherever it lies under the body or a pad
  input.filled_truth.at({10, 10}) = 1;
  const HazardMap map = map_hazards(input, small_lander(), kAtOnce);
  const HazardScore& score = map.truth.value().score;
  EXPECT_EQ(score.counts.safe_hazard, 29 + 8);  // the disc of 3 bins, and pads at (3, 1)
  EXPECT_EQ(score.counts.safe_safe, 225 - 37);
  EXPECT_EQ(score.filled_truth_bins, 1);
  EXPECT_EQ(map.sites.at(0).truth, Safety::hazard);
  EXPECT_EQ(map.truth->outcome.at({10, 10}), 2);
}

TEST(MapHazards, FilledTruthCountsInTheRegionOnly) {
  HazardInput input = level_terrain(1, 0.1);
  input.z_true = input.z;
  input.filled_truth.at({10, 10}) = input.filled_truth.at({0, 0}) = 1;
  HazardParameters parameters = small_lander();
  parameters.region_radius_m = 1;
  EXPECT_EQ(map_hazards(input, parameters, kAtOnce).truth.value().score.filled_truth_bins, 1);
  parameters.region_radius_m = 2;
  EXPECT_EQ(map_hazards(input, parameters, kAtOnce).truth.value().score.filled_truth_bins, 2);
}

TEST(MapHazards, ALanderThatTheMapCannotHoldIsRefused) {
  HazardParameters parameters = small_lander();
  parameters.lander.body_radius_m = 1;  // 21 bins, all of the map
  EXPECT_EQ(level_refusal(parameters), "accepted");
  parameters.lander.body_radius_m = 1.1;
  EXPECT_EQ(level_refusal(parameters),
            "usage: lander/body_radius_m: a lander of 23 bins across is larger than the map of 21 x 21 bins "
            "of 0.1 m");
  parameters = small_lander();
  parameters.lander.leg_radius_m = 1;
  EXPECT_EQ(level_refusal(parameters), "accepted");  // pads of one bin
  parameters.lander.leg_radius_m = 1.05 - 0.5e-10;   // stand 11 bins away
  EXPECT_THAT(level_refusal(parameters), HasSubstr("usage: lander/leg_radius_m: a lander of 23"));
  parameters.lander.leg_radius_m = 1;
  parameters.lander.pad_diameter_m = 0.2;
  EXPECT_THAT(level_refusal(parameters), HasSubstr("usage: lander/leg_radius_m: a lander of 23"));
  parameters.method = HazardMethod::plane;  // has no legs
  EXPECT_EQ(level_refusal(parameters), "accepted");
  parameters.lander.body_radius_m = 1.1;
  EXPECT_THAT(level_refusal(parameters), HasSubstr("usage: lander/body_radius_m: a lander of 23"));
}

TEST(MapHazards, TheShorterSideOfTheMapHoldsTheLander) {
  HazardParameters parameters = small_lander();
  parameters.lander.body_radius_m = 1.1;
  for (const GridSpec& spec : {GridSpec{0.1, -10, -15, 22, 31}, GridSpec{0.1, -15, -10, 31, 22}})
    EXPECT_THAT(map_refusal({Grid<double>(spec), std::nullopt, BinMask(spec), std::nullopt}, parameters),
                HasSubstr("usage: lander/body_radius_m: a lander of 23 bins"));
}

TEST(MapHazards, TheBodyIsNamedIfOthersReachAsFar) {
  HazardParameters parameters = small_lander();
  parameters.lander.leg_radius_m = parameters.lander.body_radius_m = 1.1;
  EXPECT_THAT(level_refusal(parameters), HasSubstr("usage: lander/body_radius_m"));
  parameters.method = HazardMethod::range_difference;
  parameters.lander.body_radius_m = parameters.limits.roughness_m = 0.5;
  EXPECT_THAT(level_refusal(parameters), HasSubstr("usage: lander/body_radius_m"));
}

TEST(MapHazards, ALanderThatTheMapCannotResolveIsRefused) {
  HazardParameters parameters = small_lander();
  parameters.lander.leg_radius_m = 0.19;
  EXPECT_THAT(level_refusal(parameters), HasSubstr("usage: lander/leg_radius_m: 0.19 is less"));
  parameters.method = HazardMethod::plane;
  EXPECT_EQ(level_refusal(parameters), "accepted");
  parameters.lander.body_radius_m = 0.099;
  EXPECT_THAT(
      level_refusal(parameters),
      HasSubstr("usage: lander/body_radius_m: 0.099 is less than 1 bin of 0.1 m, and the method is plane"));
  parameters.method = HazardMethod::range_difference;
  EXPECT_THAT(level_refusal(parameters), HasSubstr("and the method is range_difference"));
  parameters.method = HazardMethod::plane;
  parameters.lander.body_radius_m = 0.1;
  EXPECT_EQ(level_refusal(parameters), "accepted");
  parameters.method = HazardMethod::lmeds;
  EXPECT_THAT(level_refusal(parameters), HasSubstr("usage: lander/body_radius_m: 0.1 is less than 2 bins"));
  parameters.lander.body_radius_m = 0.2;
  EXPECT_EQ(level_refusal(parameters), "accepted");
}

TEST(MapHazards, WindowsThatTheMapCannotHoldOrResolveAreRefused) {
  HazardParameters parameters = small_lander();
  parameters.method = HazardMethod::range_difference;
  EXPECT_EQ(level_refusal(parameters), "accepted");
  parameters.limits.roughness_m = 0.6;  // 3 + 6 + 1 bins to each side
  EXPECT_EQ(level_refusal(parameters), "accepted");
  parameters.limits.roughness_m = 0.7;
  EXPECT_EQ(level_refusal(parameters),
            "usage: limits/roughness_m: a window of 23 bins across is larger than the map of 21 x 21 bins of "
            "0.1 m");
  parameters.limits.roughness_m = 0.1;
  EXPECT_EQ(level_refusal(parameters), "accepted");
  parameters.limits.roughness_m = 0.09;
  EXPECT_THAT(level_refusal(parameters),
              HasSubstr("usage: limits/roughness_m: 0.09 is less than 1 bin of 0.1 m"));
  parameters.method = HazardMethod::contact;  // has no windows
  EXPECT_EQ(level_refusal(parameters), "accepted");
  parameters.method = HazardMethod::range_difference;
  parameters.limits.roughness_m = 0.3;
  parameters.lander.body_radius_m = 0.8;
  EXPECT_THAT(level_refusal(parameters), HasSubstr("usage: lander/body_radius_m: a window of 25 bins"));
}

TEST(MapHazards, EachMethodHasItsProbability) {
  HazardInput input = level_terrain(3, 0.1);
  input.z.at({35, 35}) = input.z.at({35, 36}) = input.z.at({36, 35}) = input.z.at({36, 36}) = 0.5;
  input.z.at({34, 35}) = 0.5;
  for (const HazardMethod method :
       {HazardMethod::contact, HazardMethod::plane, HazardMethod::range_difference, HazardMethod::lmeds}) {
    input.z_sigma = Grid<double>(input.z.spec(), 0.01);
    HazardParameters parameters = small_lander();
    parameters.method = method;
    const Grid<float> p = map_hazards(input, parameters, kAtOnce).p_safe.value();
    EXPECT_FALSE(input.z_sigma);
    EXPECT_GT(p.at({20, 20}), 0.99);
    EXPECT_LT(p.at({35, 35}), 0.01);
  }
}

// 8 sigma of noise are 9 deg or more with each method.
TEST(MapHazards, HalfADegreeFromTheLimitIsNotCertain) {
  HazardInput input = level_terrain(1, 0.1);
  HazardParameters parameters = small_lander();
  for (const auto [row, col] : Bins({0, 0}, {21, 21}))
    input.z.at({row, col}) = std::tan(10.5 * std::numbers::pi / 180) * input.z.spec().x(col);
  for (const HazardMethod method :
       {HazardMethod::contact, HazardMethod::plane, HazardMethod::range_difference, HazardMethod::lmeds})
    for (const double limit_deg : {10.0, 11.0}) {
      input.z_sigma = Grid<double>(input.z.spec(), 0.02);
      parameters.method = method;
      parameters.limits.slope_deg = limit_deg;
      const Grid<float> p = map_hazards(input, parameters, kAtOnce).p_safe.value();
      EXPECT_GT(p.at({10, 10}), 0) << static_cast<int>(method);
      EXPECT_LT(p.at({10, 10}), 1) << static_cast<int>(method);
    }
}

TEST(MapHazards, ARegionWithoutAKnownPlaceSaysWhy) {
  HazardInput input = level_terrain(1, 0.1);
  HazardParameters parameters = small_lander();
  input.z.at({10, 10}) = kNan;
  parameters.region_radius_m = 0.3;
  EXPECT_THAT(map_refusal(input, parameters),
              HasSubstr("format: nothing to judge: at each place within 0.3 m"));
  parameters.region_radius_m = 0.05;
  EXPECT_EQ(map_refusal(input, parameters),
            "format: nothing to judge: no bin within 0.05 m of the origin has an elevation");
  const GridSpec aside{.resolution_m = 0.1, .first_row = 100, .first_col = 0, .rows = 20, .cols = 20};
  EXPECT_EQ(map_refusal({Grid<double>(aside), std::nullopt, BinMask(aside), std::nullopt}, parameters),
            "format: nothing to judge: no bin of the map lies within 0.05 m of the origin");
}

// The only elevation lies in the first bin of the map.
TEST(MapHazards, ALoneElevationIsNamed) {
  HazardInput input = level_terrain(1, 0.1);
  for (double& z : input.z.values()) z = kNan;
  input.z.at({0, 0}) = 0;
  EXPECT_THAT(map_refusal(input, small_lander()), HasSubstr("nothing to judge: at each place within"));
}

TEST(MapHazards, ASiteHasTheValuesOfItsPlace) {
  HazardInput input = level_terrain(2, 0.1);
  for (const auto [row, col] : Bins({0, 0}, {41, 41}))
    input.z.at({row, col}) = 0.01 * static_cast<double>(row + (row * col) % 3);
  input.z.at({20, 20}) = 1;
  input.z_sigma = Grid<double>(input.z.spec(), 0.02);
  input.z_true = input.z;
  HazardParameters parameters = small_lander();
  parameters.touchdown_sigma_m = 0.1;
  parameters.sites = {.count = 3, .separation_m = 0.5, .divert_radius_m = 1.5};
  const HazardMap map = map_hazards(input, parameters, kAtOnce);
  ASSERT_EQ(map.sites.size(), 3U);
  for (const LandingSite& site : map.sites) {
    EXPECT_EQ(site.x_m, input.z.spec().x(site.bin.col));
    EXPECT_EQ(site.y_m, input.z.spec().y(site.bin.row));
    EXPECT_EQ(site.z_m, input.z.at(site.bin));
    EXPECT_EQ(site.cost, map.cost.at(site.bin));
    EXPECT_EQ(site.p_touchdown, map.p_touchdown.at(site.bin));
    EXPECT_EQ(site.p_safe, map.p_safe->at(site.bin));
    EXPECT_EQ(site.slope_deg, map.measures.slope_deg.at(site.bin));
    EXPECT_EQ(site.roughness_m, map.measures.roughness_m.at(site.bin));
    EXPECT_EQ(site.hazard_distance_m, map.hazard_distance.at(site.bin));
    EXPECT_EQ(site.truth, Safety::safe);
    EXPECT_NE(site.cost, 0);
    EXPECT_NE(site.slope_deg, 0);
    EXPECT_NE(site.roughness_m, 0);
  }
}

// The ring of the hole lies 1 bin around it: the truth there was taken 0.01 m east and 0.02 m south of the
// bins' centres on average.
TEST(TruthPositions, AreMovedByTheMeanOfTheRing) {
  const GridSpec spec = GridSpec::centered(1, 0.1);
  Grid<double> z_true(spec);
  Grid<double> x_true(spec);
  Grid<double> y_true(spec);
  for (const auto [row, col] : bins_of(spec)) {
    x_true.at({row, col}) = spec.x(col) + 0.01 + (col == 9 ? 0.03 : col == 11 ? -0.03 : 0);
    y_true.at({row, col}) = spec.y(row) - 0.02;
  }
  z_true.at({10, 10}) = x_true.at({10, 10}) = y_true.at({10, 10}) = kNan;
  const std::vector<FillableBin> holes = {{{10, 10}, 1}, {{5, 5}, 1}};  // the second has a true elevation
  const std::vector<TruthPosition> positions = truth_positions(z_true, x_true, y_true, holes);
  ASSERT_EQ(positions.size(), 1U);
  EXPECT_EQ(positions[0].bin, (BinIndex{10, 10}));
  EXPECT_NEAR(positions[0].x_m, 0.01, 1e-15);
  EXPECT_NEAR(positions[0].y_m, -0.02, 1e-15);
}

// A hole beside the corner, whose ring lies to one side of the axes.
TEST(TruthPositions, TakeTheFirstRowAndColumn) {
  const GridSpec spec{0.1, 5, 7, 3, 3};
  Grid<double> z_true(spec);
  Grid<double> x_true(spec);
  Grid<double> y_true(spec);
  for (const auto [row, col] : Bins({0, 0}, {3, 3})) {
    x_true.at({row, col}) = spec.x(col) + (col == 0 ? 0.04 : 0);
    y_true.at({row, col}) = spec.y(row) + (row == 0 ? 0.08 : 0);
  }
  z_true.at({1, 1}) = x_true.at({1, 1}) = y_true.at({1, 1}) = kNan;
  const std::vector<TruthPosition> positions = truth_positions(z_true, x_true, y_true, {{{1, 1}, 1}});
  ASSERT_EQ(positions.size(), 1U);
  EXPECT_NEAR(positions[0].x_m, spec.x(1) + 3 * 0.04 / 8, 1e-15);
  EXPECT_NEAR(positions[0].y_m, spec.y(1) + 3 * 0.08 / 8, 1e-15);
}

TEST(FillMap, FillsTheSmallHolesOfEachLayer) {
  const GridSpec spec = GridSpec::centered(1, 0.5);
  Grid<double> z(spec, 2);
  Grid<double> z_true(spec, 3);
  Grid<double> z_sigma(spec, 0.25);
  z.at({2, 2}) = z_true.at({2, 2}) = z_sigma.at({2, 2}) = kNan;
  HazardParameters parameters;
  parameters.z_sigma_m = 0.5;  // only of maps without their own
  const HazardInput input = fill_map({z, z_true, z_sigma}, parameters, fill_truth);
  EXPECT_EQ(input.z.at({2, 2}), 2);
  EXPECT_EQ(input.z_true.value().at({2, 2}), 3);
  EXPECT_TRUE(std::isnan(input.z_sigma.value().at({2, 2})));  // not measured
  EXPECT_EQ(input.z_sigma.value().at({1, 1}), 0.25);
  EXPECT_EQ(count_set(input.filled_truth), 1);
  EXPECT_EQ(input.filled_truth.at({2, 2}), 1);
  EXPECT_EQ(fill_map({z}, parameters, fill_truth).z_sigma.value().at({1, 1}), 0.5);
  parameters.z_sigma_m.reset();
  parameters.hole_fill_bins = 0;
  const HazardInput bare = fill_map({z}, parameters, fill_truth);
  EXPECT_TRUE(std::isnan(bare.z.at({2, 2})));
  EXPECT_FALSE(bare.z_true || bare.z_sigma);
  EXPECT_EQ(count_set(bare.filled_truth), 0);
}

// A bin with an elevation and without a sigma gets z_sigma_m; without that it is counted, and only a map
// without any sigma has none.
TEST(FillMap, CountsBinsWithoutSigma) {
  const GridSpec spec = GridSpec::centered(1, 0.5);
  Grid<double> z(spec, 2);
  z.at({0, 3}) = kNan;  // at the border: stays without an elevation
  Grid<double> z_sigma(spec, 0.25);
  z_sigma.at({0, 3}) = z_sigma.at({2, 2}) = z_sigma.at({4, 4}) = kNan;
  HazardParameters parameters;
  HazardInput input = fill_map({z, {}, z_sigma}, parameters, fill_truth);
  EXPECT_EQ(input.bins_without_sigma, 2);
  EXPECT_TRUE(std::isnan(input.z_sigma.value().at({2, 2})));
  parameters.z_sigma_m = 0.5;
  input = fill_map({z, {}, z_sigma}, parameters, fill_truth);
  EXPECT_EQ(input.bins_without_sigma, 0);
  EXPECT_EQ(input.z_sigma.value().at({4, 4}), 0.5);
  EXPECT_EQ(input.z_sigma.value().at({1, 1}), 0.25);
  parameters.z_sigma_m.reset();
  input = fill_map({z, {}, Grid<double>(spec, kNan)}, parameters, fill_truth);
  EXPECT_EQ(input.bins_without_sigma, 24);
  EXPECT_FALSE(input.z_sigma);
}

// Its elevation does not count: the place is known, and its probability that of a map without the bin.
TEST(MapHazards, ABinWithoutSigmaIsNotMeasured) {
  HazardInput input = level_terrain(2, 0.1);
  input.z_sigma = Grid<double>(input.z.spec(), 0.001);
  const BinIndex bare{20, 22};
  input.z.at(bare) = 1;
  input.z_sigma->at(bare) = kNan;
  input.bins_without_sigma = 1;
  const HazardMap map = map_hazards(input, small_lander(), kAtOnce);
  EXPECT_EQ(map.safe.at({20, 20}), 0);
  EXPECT_GT(map.p_safe.value().at({20, 20}), 0.99F);
  EXPECT_LT(map.p_safe.value().at({20, 20}), 1);
  EXPECT_EQ(map.p_safe.value().at({30, 30}), map.p_cap);
  EXPECT_EQ(map.p_capped.at({30, 30}), 1);
  EXPECT_NE(map.p_safe_origin.find("seed 1; a place depends on the bins within"), std::string::npos);
}

// An unknown place has a probability, counts nothing for a touchdown, and is left out of the score.
TEST(MapHazards, AnUnknownPlaceHasAProbability) {
  HazardInput input = level_terrain(2, 0.1);
  input.z_true = input.z;
  input.z_sigma = Grid<double>(input.z.spec(), 0.001);
  input.z.at({20, 20}) = input.z_sigma->at({20, 20}) = kNan;
  HazardParameters parameters = small_lander();
  parameters.touchdown_sigma_m = 0;
  const HazardMap map = map_hazards(input, parameters, kAtOnce);
  EXPECT_EQ(map.safe.at({20, 21}), 2);
  EXPECT_GT(map.p_safe.value().at({20, 21}), 0.99F);
  EXPECT_EQ(map.p_touchdown.at({20, 21}), 0);
  std::int64_t compared = 0;
  for (const HazardScore::ReliabilityBin& bin : map.truth->score.reliability) compared += bin.count;
  const PlaceCounts counts = count_places(map.safe, map.region);
  EXPECT_EQ(compared, counts.all() - counts.unknown);
}

TEST(FillTruth, FillsOnlyWhatIsMissing) {
  const GridSpec spec = GridSpec::centered(1, 0.5);
  Grid<double> z_true(spec, 2);
  z_true.at({2, 2}) = kNan;
  z_true.at({2, 3}) = 7;
  const BinMask filled = fill_truth(z_true, {{{2, 2}, 1}, {{2, 3}, 1}});
  EXPECT_EQ(z_true.at({2, 2}), (7 * 2 + 7) / 8.0);
  EXPECT_EQ(z_true.at({2, 3}), 7);
  EXPECT_EQ(count_set(filled), 1);
  EXPECT_EQ(filled.at({2, 2}), 1);
}

TEST(FillTruth, ARingWithoutTruthLeavesTheBinEmpty) {
  Grid<double> z_true(GridSpec::centered(1, 0.5), kNan);
  EXPECT_EQ(count_set(fill_truth(z_true, {{{2, 2}, 1}})), 0);
  EXPECT_TRUE(std::isnan(z_true.at({2, 2})));
}

TEST(MapHazards, ASiteHasThePosesOfItsMeasures) {
  HazardInput input = level_terrain(1, 0.1);
  input.z.at({11, 9}) = 0.05;
  HazardParameters parameters = small_lander();
  for (const HazardMethod method : {HazardMethod::contact, HazardMethod::plane}) {
    parameters.method = method;
    const HazardMap map = map_hazards(input, parameters, kAtOnce);
    const LandingSite& site = map.sites.at(0);
    const std::optional<WorstPoses> poses = worst_poses(input.z, parameters, site.bin);
    ASSERT_TRUE(poses);
    EXPECT_NEAR(poses->steepest.slope_deg, site.slope_deg, 1e-9);
    EXPECT_NEAR(poses->roughest.roughness_m, site.roughness_m, 1e-9);
    EXPECT_EQ(poses->roughest.highest, (BinIndex{11, 9}));
    EXPECT_EQ(poses->steepest.pads.size(), method == HazardMethod::contact ? 4U : 0U);
    EXPECT_FALSE(worst_poses(input.z, parameters, {0, 0}));
  }
}

}  // namespace
}  // namespace landfall
