// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "base/parallel.h"
#include "base/random.h"
#include "brute_force.h"
#include "hazards/measures.h"

namespace landfall {
namespace {

using testing_hazards::BruteForce;
using testing_hazards::kNan;
using testing_hazards::random_map;

constexpr double kDegree = std::numbers::pi / 180;

BinMask everywhere(const GridSpec& spec) { return BinMask(spec, 1); }

/// The measures at the origin of a map of 8 m, bins of 5 cm, with elevations z(x, y).
struct AtOrigin {
  double slope_deg, roughness_m;
};
AtOrigin at_origin(const Lander& lander, const std::function<double(double, double)>& z) {
  const GridSpec spec = GridSpec::centered(2, 0.05);
  Grid<double> map(spec);
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col) map.at({row, col}) = z(spec.x(col), spec.y(row));
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

// A post under the body, where no pad of any yaw reaches it, stands out of level ground by its height.
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

void expect_as_brute_force(const Grid<double>& z, const Lander& lander, double tolerance = 1e-11) {
  const GridSpec& spec = z.spec();
  const PlaceMeasures found = measure_contact(z, LanderStencil(lander, spec.resolution_m), everywhere(spec));
  const BruteForce slow{z, lander};
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      const BinIndex place{row, col};
      const auto expected = slow.contact(place);
      ASSERT_EQ(std::isnan(found.slope_deg.at(place)), !expected) << row << ' ' << col;
      ASSERT_EQ(std::isnan(found.roughness_m.at(place)), !expected) << row << ' ' << col;
      if (!expected) continue;
      ASSERT_NEAR(found.slope_deg.at(place), expected->slope_deg, tolerance) << row << ' ' << col;
      ASSERT_NEAR(found.roughness_m.at(place), expected->roughness_m, tolerance) << row << ' ' << col;
    }
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

// Bodies of many tiles, smooth and rough ground, spikes: which planes and bins decide is found by bounds.
TEST(Contact, EqualsBruteForceUnderWideBodies) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const RandomField field(seed, RandomStream::range_noise);
    const GridSpec spec{0.05, -18, -18, 37, 37};
    Grid<double> z = random_map(spec, seed, 0);
    for (double& height : z.values()) height *= std::pow(4, -static_cast<double>(seed % 3));
    for (std::int64_t row = 0; row < spec.rows; ++row)
      for (std::int64_t col = 0; col < spec.cols; ++col) {
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

TEST(Contact, LevelAndTiltedGroundWithoutNoise) {
  for (const double tangent : {0.0, 0.25}) {
    Grid<double> z(GridSpec{0.1, 0, 0, 20, 40});
    for (std::int64_t row = 0; row < 20; ++row)
      for (std::int64_t col = 0; col < 40; ++col) z.at({row, col}) = tangent * 0.1 * static_cast<double>(col);
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
  const auto run = [&](std::size_t threads) {
    const ThreadLimit limit(threads);
    return measure_contact(z, lander, everywhere(z.spec()));
  };
  const PlaceMeasures one = run(1);
  const PlaceMeasures three = run(3);
  for (std::size_t i = 0; i < z.spec().size(); ++i) {
    if (std::isnan(one.slope_deg.values()[i])) continue;
    EXPECT_EQ(one.slope_deg.values()[i], three.slope_deg.values()[i]);
    EXPECT_EQ(one.roughness_m.values()[i], three.roughness_m.values()[i]);
  }
}

}  // namespace
}  // namespace landfall
