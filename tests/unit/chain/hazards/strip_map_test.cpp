// SPDX-License-Identifier: GPL-3.0-or-later
// Maps judged strip by strip, compared bit by bit with the same maps in one piece.
#include "chain/hazards/strip_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "base/core/error.h"
#include "base/numerics/random.h"
#include "base/raster/grid.h"
#include "bins.h"
#include "chain/hazards/site_search.h"
#include "constants.h"
#include "refusal.h"

namespace landfall {
namespace {

using testing::ElementsAreArray;
using testing::HasSubstr;

const PhaseRunner kPhases = [](const std::string& /*name*/, const auto& part) { part({}); };

/// Bumpy ground with rocks of 3 x 3 bins and missing bins, more of them at a lower `holes`.
Grid<double> rocky_terrain(const GridSpec& spec, double holes) {
  const RandomField field(5, RandomStream::range_noise);
  Grid<double> z(spec);
  for (const auto [row, col] : bins_of(spec)) {
    const std::size_t i = spec.index({row, col});
    const std::size_t block = static_cast<std::size_t>(row / 3 * spec.cols + col / 3) + spec.size();
    z.values()[i] = 0.3 * std::sin(0.4 * spec.x(col)) * std::cos(0.3 * spec.y(row)) + 0.004 * field.normal(i);
    if (field.normal(block) > 2.4) z.values()[i] += 0.4;
    if (field.normal(block) < -3) z.values()[i] = kNan;
    if (field.normal(i + 2 * spec.size()) > holes) z.values()[i] = kNan;
  }
  return z;
}

HazardParameters parameters_of(HazardMethod method) {
  HazardParameters parameters;
  parameters.lander = {.leg_radius_m = 0.4, .pad_diameter_m = 0.2, .body_radius_m = 0.5};
  parameters.method = method;
  parameters.region_radius_m = 5.5;
  parameters.limits = {.slope_deg = 14, .roughness_m = 0.15};
  parameters.hole_fill_bins = 3;
  parameters.touchdown_sigma_m = 0.3;
  parameters.sites = {.count = 8, .separation_m = 0.7, .divert_radius_m = 4};
  return parameters;
}

std::vector<std::uint64_t> bits(const Grid<double>& grid) {
  std::vector<std::uint64_t> result;
  for (const double value : grid.values()) result.push_back(std::bit_cast<std::uint64_t>(value));
  return result;
}

struct StripResult {
  HazardMap map;
  PlaceMeasures measures;
};

StripResult in_strips(const Grid<double>& z, const HazardParameters& parameters, std::int64_t rows,
                      const std::optional<BinMask>& region = std::nullopt) {
  StripResult result{{}, {Grid<double>(z.spec()), Grid<double>(z.spec())}};
  const StripSource source{z.spec(), rows, [&](const GridSpec& part) { return cut_out(z, part); }, region};
  const auto take = [&](const PlaceMeasures& strip) {
    put_in(strip.slope_deg, result.measures.slope_deg);
    put_in(strip.roughness_m, result.measures.roughness_m);
  };
  result.map = map_strips(source, parameters, take, kPhases);
  return result;
}

HazardMap in_one_piece(const Grid<double>& z, const HazardParameters& parameters,
                       const std::optional<BinMask>& region = std::nullopt) {
  HazardInput input = fill_map(
      {z}, parameters, [&](Grid<double>& /*z_true*/, const auto& /*holes*/) { return BinMask(z.spec()); });
  input.region = region;
  return map_hazards(input, parameters, kPhases);
}

void expect_same_sites(const std::vector<LandingSite>& got, const std::vector<LandingSite>& expected) {
  ASSERT_EQ(got.size(), expected.size());
  for (std::size_t i = 0; i < got.size(); ++i) {
    EXPECT_EQ(got[i].bin, expected[i].bin);
    const auto numbers = [](const LandingSite& s) {
      return std::vector<double>{s.x_m,         s.y_m,       s.z_m,         s.cost,
                                 s.p_touchdown, s.slope_deg, s.roughness_m, s.hazard_distance_m.value_or(-1)};
    };
    EXPECT_EQ(numbers(got[i]), numbers(expected[i]));
    EXPECT_FALSE(got[i].p_safe);
  }
}

class StripMap : public testing::TestWithParam<HazardMethod> {};

TEST_P(StripMap, AnyStripsGiveTheBitsOfOnePiece) {
  const HazardParameters parameters = parameters_of(GetParam());
  const Grid<double> z = rocky_terrain({0.1, -57, -60, 130, 121}, 3);
  const HazardMap expected = in_one_piece(z, parameters);
  const PlaceCounts counts = count_places(expected.safe, expected.region);
  ASSERT_GT(std::min({counts.safe, counts.hazard, counts.unknown}), 100);
  ASSERT_GE(expected.sites.size(), 3U);
  for (const std::int64_t rows : {1, 47}) {
    const StripResult got = in_strips(z, parameters, rows);
    EXPECT_EQ(bits(got.measures.slope_deg), bits(expected.measures.slope_deg)) << rows;
    EXPECT_EQ(bits(got.measures.roughness_m), bits(expected.measures.roughness_m)) << rows;
    EXPECT_THAT(got.map.safe.values(), ElementsAreArray(expected.safe.values())) << rows;
    EXPECT_THAT(got.map.region.values(), ElementsAreArray(expected.region.values())) << rows;
    expect_same_sites(got.map.sites, expected.sites);
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, StripMap,
                         testing::Values(HazardMethod::contact, HazardMethod::plane,
                                         HazardMethod::range_difference, HazardMethod::lmeds));

TEST(StripMap, RegionsAreThoseOfOnePiece) {
  const Grid<double> z = rocky_terrain({0.1, -57, -60, 130, 121}, 3);
  HazardParameters moved = parameters_of(HazardMethod::plane);
  moved.region_center_m = {1.2, -0.7};
  moved.region_radius_m = 2;
  HazardParameters masked = moved;
  masked.region_shape = RegionShape::polygon;
  BinMask mask(z.spec());
  for (std::int64_t row = 40; row < 90; ++row) std::fill_n(&mask.at({row, row / 2}), 50, 1);
  for (const HazardParameters& parameters : {moved, masked}) {
    const HazardMap expected = in_one_piece(z, parameters, mask);
    const StripResult got = in_strips(z, parameters, 11, mask);
    EXPECT_THAT(got.map.region.values(), ElementsAreArray(expected.region.values()));
    EXPECT_THAT(got.map.safe.values(), ElementsAreArray(expected.safe.values()));
    expect_same_sites(got.map.sites, expected.sites);
  }
}

TEST(StripMap, HolesAreThoseOfTheWholeMap) {
  HazardParameters parameters = parameters_of(HazardMethod::plane);
  parameters.lander = {.leg_radius_m = 0.2, .pad_diameter_m = 0.1, .body_radius_m = 0.1};
  const Grid<double> z =
      rocky_terrain({0.1, -30, -30, 61, 61}, 1.1);  // a seventh is missing, in winding groups
  for (const std::int64_t bins : {0, 1, 5, 40, 100000}) {
    parameters.hole_fill_bins = bins;
    const HazardMap expected = in_one_piece(z, parameters);
    const StripResult got = in_strips(z, parameters, 2);
    EXPECT_EQ(bits(got.measures.roughness_m), bits(expected.measures.roughness_m)) << bins;
  }
}

TEST(StripMap, WhatHasNoPlaceIsRefusedAsInOnePiece) {
  const GridSpec spec = GridSpec::centered(3, 0.1);
  const Grid<double> empty(spec, kNan);
  const auto refusal = [&](const auto& judged) -> std::string {
    return landfall::refusal<FormatError>([&] { return judged(); });
  };
  const HazardParameters parameters = parameters_of(HazardMethod::contact);
  const std::string expected = refusal([&] { return in_one_piece(empty, parameters); });
  EXPECT_THAT(expected, HasSubstr("has an elevation"));
  EXPECT_EQ(refusal([&] { return in_strips(empty, parameters, 20); }), expected);
}

TEST(FindSites, AnyTilesGiveTheSitesOfOnePiece) {
  const GridSpec spec{0.1, -25, -33, 55, 70};
  const RandomField field(3, RandomStream::range_noise);
  Grid<std::int8_t> safe(spec);
  for (std::size_t i = 0; i < spec.size(); ++i)
    safe.values()[i] = static_cast<std::int8_t>(field.normal(i) > -1.5 ? 1 : field.normal(i) > -2 ? 0 : 2);
  const BinMask region = clipped_circle(spec, 2.9);
  for (std::size_t i = 0; i < spec.size(); ++i)
    if (region.values()[i] == 0) safe.values()[i] = 2;
  for (const double sigma : {0.0, 0.25}) {
    const SiteParameters parameters{.count = 12, .separation_m = sigma * 2, .divert_radius_m = 2};
    Grid<float> counted(spec);
    for (std::size_t i = 0; i < spec.size(); ++i) counted.values()[i] = safe.values()[i] == 1 ? 1.0F : 0.0F;
    const Grid<float> p = touchdown_probability(counted, sigma, region);
    const Grid<float> cost = landing_cost(p, parameters);
    const Grid<float> distance = hazard_distance(safe, region);
    const std::vector<BinIndex> expected = choose_sites(cost, safe, parameters);
    ASSERT_EQ(expected.size(), 12U);
    const JudgedPlaces places{safe, region, sigma};
    for (const std::int64_t tile : {5, 16, 1000}) {
      const std::vector<FoundSite> found = find_sites(places, parameters, tile);
      ASSERT_EQ(found.size(), expected.size());
      for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].bin, expected[i]) << tile;
        EXPECT_EQ(found[i].cost, cost.at(expected[i]));
        EXPECT_EQ(found[i].p_touchdown, p.at(expected[i]));
        EXPECT_EQ(hazard_distance_at(places, expected[i]), distance.at(expected[i]));
      }
    }
  }
}

TEST(FindSites, WithoutAHazardThereIsNoDistance) {
  const GridSpec spec = GridSpec::centered(1, 0.1);
  const Grid<std::int8_t> safe(spec, 1);
  EXPECT_FALSE(hazard_distance_at({safe, BinMask(spec, 1), 0}, {3, 3}));
}

}  // namespace
}  // namespace landfall
