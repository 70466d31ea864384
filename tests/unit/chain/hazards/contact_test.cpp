// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "base/numerics/random.h"
#include "bins.h"
#include "brute_force.h"
#include "chain/hazards/measures.h"
#include "constants.h"

namespace landfall {
namespace {

using testing_hazards::BruteForce;
using testing_hazards::random_map;

BinMask everywhere(const GridSpec& spec) { return BinMask(spec, 1); }

/// The measures at the origin of a map of 8 m, bins of 5 cm, with elevations z(x, y).
struct AtOrigin {
  double slope_deg, roughness_m;
};
AtOrigin at_origin(const Lander& lander, const std::function<double(double, double)>& z) {
  const GridSpec spec = GridSpec::centered(2, 0.05);
  const Grid<double> map = grid_of(spec, z);
  const PlaceMeasures found = measure_contact(map, LanderStencil(lander, 0.05), everywhere(spec));
  const BinIndex origin = spec.bin_of(0, 0);
  return {found.slope_deg.at(origin), found.roughness_m.at(origin)};
}

TEST(Contact, ATiltedPlaneIsItsOwnSlope) {
  for (const int legs : {3, 4})
    for (const double tilt_deg : {0.0, 5.0, 30.0}) {
      const double tangent = std::tan(tilt_deg * kDegree);
      Lander lander;
      lander.legs = legs;
      lander.pad_height = PadHeight::mean;
      const AtOrigin found =
          at_origin(lander, [&](double x, double y) { return tangent * (0.6 * x + 0.8 * y) + 7; });
      EXPECT_NEAR(found.slope_deg, tilt_deg, 1e-9);
      EXPECT_NEAR(found.roughness_m, 0, 1e-12);
    }
}

// A post of h under one pad tilts three legs about the line of the two others, 1.5 R away, and four legs by
// h / 2 over R along the diagonal with the post, which is the higher one, and by h / 2 over R across it.
TEST(Contact, APostUnderAPad) {
  const auto post = [](double x, double y) {
    return std::abs(x - 0.85) < 0.01 && std::abs(y) < 0.01 ? 0.2 : 0.0;
  };
  Lander lander;
  lander.legs = 3;
  const double slope_deg = at_origin(lander, post).slope_deg;  // pads lie in whole bins
  EXPECT_GT(slope_deg, std::atan(0.2 / (1.5 * 0.85 + 0.05)) / kDegree);
  EXPECT_LT(slope_deg, std::atan(0.2 / (1.5 * 0.85 - 0.05)) / kDegree);
  lander.legs = 4;
  EXPECT_NEAR(at_origin(lander, post).slope_deg, std::atan(std::hypot(0.1, 0.1) / 0.85) / kDegree, 1e-9);
}

// A post under the body, where no pad of any yaw reaches it, stands out of level terrain by its height.
TEST(Contact, APostUnderTheBody) {
  for (const int legs : {3, 4}) {
    Lander lander;
    lander.legs = legs;
    const AtOrigin found =
        at_origin(lander, [](double x, double y) { return std::hypot(x - 0.3, y) < 0.01 ? 0.25 : 0.0; });
    EXPECT_NEAR(found.slope_deg, 0, 1e-12);
    EXPECT_NEAR(found.roughness_m, 0.25, 1e-12);
  }
}

TEST(Contact, AHemisphereUnderTheBodyHasItsHeight) {
  const AtOrigin found = at_origin({}, [](double x, double y) {
    const double square = 0.4 * 0.4 - x * x - y * y;
    return square > 0 ? std::sqrt(square) : 0.0;
  });
  EXPECT_NEAR(found.slope_deg, 0, 1e-12);
  EXPECT_NEAR(found.roughness_m, 0.4, 1e-12);
}

// Two pads stand on the edge of a step of h. They are the higher diagonal, and the lander rocks down from it
// by h over R.
TEST(Contact, AStepTiltsTheLander) {
  const AtOrigin found = at_origin({}, [](double x, double /*y*/) { return x > 0.01 ? 0.1 : 0.0; });
  EXPECT_NEAR(found.slope_deg, std::atan(0.1 / 0.85) / kDegree, 1e-9);
  const AtOrigin beside = at_origin({}, [](double x, double /*y*/) { return x > 1.2 ? 0.1 : 0.0; });
  EXPECT_NEAR(beside.slope_deg, 0, 1e-12);
}

/// At the places asked for; elsewhere nothing is known.
void expect_as_brute_force(const Grid<double>& z, const Lander& lander, const BinMask& places,
                           double tolerance) {
  const GridSpec& spec = z.spec();
  const PlaceMeasures found = measure_contact(z, LanderStencil(lander, spec.resolution_m), places);
  const BruteForce slow{z, lander};
  for (const auto [row, col] : bins_of(spec)) {
    const BinIndex place{row, col};
    const auto expected = places.at(place) != 0 ? slow.contact(place) : std::optional<BruteForce::Measures>();
    ASSERT_EQ(std::isnan(found.slope_deg.at(place)), !expected) << row << ' ' << col;
    ASSERT_EQ(std::isnan(found.roughness_m.at(place)), !expected) << row << ' ' << col;
    if (!expected) continue;
    ASSERT_NEAR(found.slope_deg.at(place), expected->slope_deg, tolerance) << row << ' ' << col;
    ASSERT_NEAR(found.roughness_m.at(place), expected->roughness_m, tolerance) << row << ' ' << col;
  }
}

void expect_as_brute_force(const Grid<double>& z, const Lander& lander, double tolerance = 1e-11) {
  expect_as_brute_force(z, lander, everywhere(z.spec()), tolerance);
}

TEST(Contact, EqualsBruteForceOnRandomMaps) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const RandomField field(seed, RandomStream::range_noise);
    Lander lander;
    lander.legs = seed % 2 == 0 ? 3 : 4;
    lander.leg_radius_m = 0.2 + 0.3 * field.uniform(1);
    lander.pad_diameter_m = 0.05 + 0.3 * field.uniform(2);
    lander.body_radius_m = 0.1 + 0.4 * field.uniform(3);
    lander.pad_height = seed % 3 == 0 ? PadHeight::mean : PadHeight::max;
    const GridSpec spec{0.1, -12, -9, 22 + static_cast<std::int64_t>(seed % 5),
                        19 + static_cast<std::int64_t>(seed % 17)};
    expect_as_brute_force(random_map(spec, seed, seed % 4 == 0 ? 0 : 0.003), lander);
  }
}

// Bodies of many tiles, smooth and rough terrain, spikes: which planes and bins decide is found by bounds.
TEST(Contact, EqualsBruteForceUnderWideBodies) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const RandomField field(seed, RandomStream::range_noise);
    const GridSpec spec{0.05, -18, -18, 37, 37};
    Grid<double> z = random_map(spec, seed, 0);
    for (double& height : z.values()) height *= std::pow(4, -static_cast<double>(seed % 3));
    for (const auto [row, col] : bins_of(spec)) {
      z.at({row, col}) += (0.2 * field.uniform(1) - 0.1) * spec.x(col) + 0.3 * spec.x(col) * spec.y(row);
      if ((13 * row + 5 * col) % 97 == 0) z.at({row, col}) += 0.2 * field.uniform(2);
    }
    Lander lander;
    lander.legs = seed % 2 == 0 ? 3 : 4;
    lander.leg_radius_m = 0.35 + 0.02 * static_cast<double>(seed);
    lander.body_radius_m = 0.6 - 0.03 * static_cast<double>(seed);
    expect_as_brute_force(z, lander);
  }
}

// Elevations far from 0, and so far apart that float cannot tell planes from each other.
TEST(Contact, EqualsBruteForceOnHighAndOnSteepGround) {
  Grid<double> z = random_map({0.1, -10, -10, 21, 37}, 5, 0);
  for (double& height : z.values()) height += 1e5;
  Lander lander;
  lander.leg_radius_m = 0.5;
  lander.body_radius_m = 0.5;
  expect_as_brute_force(z, lander, 1e-9);
  for (double& height : z.values()) height = (height - 1e5) * 1e6;
  const GridSpec& spec = z.spec();
  const PlaceMeasures found = measure_contact(z, LanderStencil(lander, 0.1), everywhere(spec));
  const BruteForce slow{z, lander};
  const auto expected = slow.contact({10, 18});
  EXPECT_NEAR(found.roughness_m.at({10, 18}), expected->roughness_m, 1e-9 * std::abs(expected->roughness_m));
}

// Rough ground with spikes, from gentle to steep, at some places of a group: the bound of each plane decides.
TEST(Contact, EqualsBruteForceAtSomePlaces) {
  for (std::uint64_t seed = 1; seed <= 90; ++seed) {
    const RandomField field(seed, RandomStream::range_noise);
    Lander lander;
    lander.legs = seed % 2 == 0 ? 3 : 4;
    lander.leg_radius_m = 0.2 + 0.5 * field.uniform(1);
    lander.pad_diameter_m = 0.05 + 0.3 * field.uniform(2);
    lander.body_radius_m = 0.05 + 0.8 * field.uniform(3);
    lander.pad_height = seed % 3 == 0 ? PadHeight::mean : PadHeight::max;
    Grid<double> z(GridSpec{0.1, 0, 0, 21, 56});
    const double relief = 0.02 * std::pow(8, static_cast<double>(seed % 5));
    for (std::size_t i = 0; i < z.values().size(); ++i)
      z.values()[i] = relief * (field.uniform(10 + 2 * i) + (field.uniform(11 + 2 * i) < 0.03 ? 2 : 0));
    BinMask places(z.spec(), 0);
    for (std::uint64_t i = 0; i < 12; ++i)
      places.at({9 + static_cast<std::int64_t>(3 * field.uniform(5000 + 2 * i)),
                 9 + static_cast<std::int64_t>(38 * field.uniform(5001 + 2 * i))}) = 1;
    expect_as_brute_force(z, lander, places, 1e-9);
  }
}

// With few planes each may be the last whose bound is looked at.
TEST(Contact, EqualsBruteForceWithFewPlanes) {
  for (const int legs : {3, 4})
    for (const double body_bins : {0.5, 1.0, 1.5})
      expect_as_brute_force(
          random_map({0.1, 0, 0, 24, 60}, static_cast<std::uint64_t>(legs), 0),
          {.legs = legs, .leg_radius_m = 0.2, .pad_diameter_m = 0.1, .body_radius_m = 0.1 * body_bins});
}

// Level terrain with a post, which stands under the body of the places nearby and under no pad.
TEST(Contact, EachBinUnderTheBodyCounts) {
  const BinIndex post{26, 29};
  Grid<double> z(GridSpec{0.1, 0, 0, 53, 58});
  z.at(post) = 0.25;
  for (double bins = 0.5; bins < 12.6; bins += 0.5) {
    const LanderStencil lander({.leg_radius_m = 1.4, .pad_diameter_m = 0.1, .body_radius_m = 0.1 * bins},
                               0.1);
    const PlaceMeasures found = measure_contact(z, lander, everywhere(z.spec()));
    for (const auto [row, col] :
         Bins({post.row - 12, post.col - 12}, {post.row + 12 + 1, post.col + 12 + 1})) {
      const double away = std::hypot(row - post.row, col - post.col);
      if (away > 12.6) continue;
      ASSERT_EQ(found.roughness_m.at({row, col}), away <= bins ? 0.25 : 0)
          << bins << ' ' << row << ' ' << col;
    }
  }
}

// The pads of each yaw in turn stand in holes of the same depth, so that one plane lies below parallel ones.
TEST(Contact, OneOfParallelPlanesDecides) {
  const Lander lander{.legs = 3,
                      .leg_radius_m = 0.5,
                      .pad_diameter_m = 0.1,
                      .pad_height = PadHeight::max,
                      .body_radius_m = 0.3};
  Grid<double> level(GridSpec{0.1, 0, 0, 13, 13});
  for (const std::vector<BruteForce::Bin>& pads : BruteForce{level, lander}.yaws()) {
    Grid<double> z = level;
    for (const BruteForce::Bin& pad : pads) z.at({6 + pad.y, 6 + pad.x}) = -0.25;
    BinMask places(z.spec(), 0);
    places.at({6, 6}) = 1;
    expect_as_brute_force(z, lander, places, 1e-12);
  }
}

// A plane through 0: float and double leave next to no room for the bound of their rounding.
TEST(Contact, TiltedGroundThroughZero) {
  for (const auto& [east, north] : {std::pair{0.25, 0.0}, {0.0, 0.25}, {-0.2, 0.2}, {0.3, 0.1}}) {
    const GridSpec spec{0.1, -20, -8, 17, 40};
    const Grid<double> z =
        grid_of(spec, [east = east, north = north](double x, double y) { return east * x + north * y; });
    const LanderStencil lander({.leg_radius_m = 0.4, .pad_diameter_m = 0.1, .body_radius_m = 0.5}, 0.1);
    const PlaceMeasures found = measure_contact(z, lander, everywhere(spec));
    for (const auto [row, col] : Bins({5, 5}, {spec.rows - 5, spec.cols - 5}))
      ASSERT_NEAR(found.roughness_m.at({row, col}), 0, 1e-14) << row << ' ' << col;
  }
}

/// Ground on which the roughness of many planes is the same to the rounding of float.
enum class NearTie { far_above, tilted, in_a_pit };

/// About a place: pads on a wide ring, up to the last column, and a body of which the ring is no part.
Grid<double> near_tie(NearTie kind, const Lander& lander, BinIndex place, double scale, std::uint64_t seed) {
  const RandomField field(seed, RandomStream::range_noise);
  const auto nearly = [&](double value, std::size_t i) { return scale * (value + 2e-7 * field.uniform(i)); };
  Grid<double> z(GridSpec{0.1, 0, 0, 67, place.col + 33});
  const GridSpec& spec = z.spec();
  for (const auto [row, col] : bins_of(spec)) {
    const double away = std::hypot(row - place.row, col - place.col);
    const auto i = static_cast<std::size_t>(spec.index({row, col}));
    if (kind == NearTie::far_above) z.at({row, col}) = nearly(away > 30 ? 1 : 0, i);
    if (kind == NearTie::in_a_pit) z.at({row, col}) = nearly(away > 30 || away == 0 ? 0 : 1, i);
  }
  if (kind == NearTie::tilted) {
    const auto yaws = BruteForce{z, lander}.yaws();
    for (std::size_t yaw = 0; yaw < yaws.size(); ++yaw)
      for (std::size_t leg = 0; leg < 4; ++leg) {
        const BruteForce::Bin& pad = yaws[yaw][leg];
        const double tilt = 0.02 * static_cast<double>(pad.x) + 0.01999 * static_cast<double>(pad.y);
        z.at({place.row + pad.y, place.col + pad.x}) =
            (2 * yaw < yaws.size() ? 1 : -1) * tilt * nearly(1, 2 * yaw + leg % 2);
      }
  }
  return z;
}

// The bound on the error of float is as large as it needs to be, wherever that error comes from.
TEST(Contact, EqualsBruteForceNearTies) {
  const Lander lander{.leg_radius_m = 3.18, .pad_diameter_m = 0.1, .body_radius_m = 0.3};
  for (const auto& [kind, scale] : {std::pair{NearTie::far_above, 1.0},
                                    {NearTie::far_above, 1e5},
                                    {NearTie::tilted, 1.0},
                                    {NearTie::in_a_pit, 1.0},
                                    {NearTie::in_a_pit, 1e9}})
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const BinIndex place{33, seed % 2 == 0 ? 48 : 63};  // the first and the last of a group
      const Grid<double> z = near_tie(kind, lander, place, scale, seed);
      BinMask places(z.spec(), 0);
      places.at(place) = 1;
      expect_as_brute_force(z, lander, places, 1e-12 * scale);
    }
}

// Beyond float each plane and each bin is a candidate. The pads of a yaw stand level, lower than those
// before.
TEST(Contact, EqualsBruteForceBeyondFloat) {
  const Lander lander{.leg_radius_m = 0.5, .pad_diameter_m = 0.1, .body_radius_m = 0.3};
  Grid<double> z = random_map({0.1, 0, 0, 13, 13}, 3, 0);
  for (double& height : z.values()) height *= 1e40;
  z.at({6, 6}) = 0;
  double height = 2e40;
  for (const std::vector<BruteForce::Bin>& pads : BruteForce{z, lander}.yaws()) {
    height -= 1e39;
    for (const BruteForce::Bin& pad : pads) z.at({6 + pad.y, 6 + pad.x}) = height;
  }
  for (std::int64_t col = 4; col <= 8; ++col) z.at({5, col}) = 3e40 - 1e38 * static_cast<double>(col);
  BinMask places(z.spec(), 0);
  places.at({6, 6}) = 1;
  expect_as_brute_force(z, lander, places, 1e28);
}

TEST(Contact, LevelAndTiltedGroundWithoutNoise) {
  for (const double tangent : {0.0, 0.25}) {
    Grid<double> z(GridSpec{0.1, 0, 0, 20, 40});
    for (const auto [row, col] : Bins({0, 0}, {20, 40}))
      z.at({row, col}) = tangent * 0.1 * static_cast<double>(col);
    Lander lander;
    lander.leg_radius_m = 0.4;
    lander.body_radius_m = 0.4;
    expect_as_brute_force(z, lander);
  }
}

TEST(Contact, OnlyThePlacesAskedFor) {
  const Grid<double> z = random_map({0.1, -10, -10, 21, 37}, 5, 0);
  BinMask places(z.spec());
  places.at({9, 11}) = 1;
  Lander lander;
  lander.leg_radius_m = 0.4;
  lander.body_radius_m = 0.3;
  const PlaceMeasures found = measure_contact(z, LanderStencil(lander, 0.1), places);
  for (std::size_t i = 0; i < z.spec().size(); ++i)
    EXPECT_EQ(std::isnan(found.slope_deg.values()[i]), places.values()[i] == 0);
}

TEST(Contact, TheSameAtAnyNumberOfThreads) {
  const Grid<double> z = random_map({0.1, -30, -30, 61, 61}, 9, 0.001);
  const LanderStencil lander({.leg_radius_m = 0.5, .body_radius_m = 0.5}, 0.1);
  testing_hazards::expect_same_at_any_threads(
      [&] { return measure_contact(z, lander, everywhere(z.spec())); });
}

}  // namespace
}  // namespace landfall
