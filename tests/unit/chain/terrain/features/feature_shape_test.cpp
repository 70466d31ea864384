// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "chain/terrain/features/feature.h"
#include "constants.h"
#include "refusal.h"

namespace landfall {
namespace {

using testing::HasSubstr;

std::string shape_refusal(const FeatureShape& shape) {
  return refusal([&] { validate(shape, "it"); });
}

TEST(Rock, ClosedForm) {
  const Rock rock{4, 3, 0.5, 0};
  EXPECT_EQ(rock.relief_m({0, 0}), 3);
  EXPECT_NEAR(rock.relief_m({1.2, 0}), 2.4, 1e-14);   // (1.2 / 2)^2 = 1 - 0.8^2
  EXPECT_NEAR(rock.relief_m({0, -0.8}), 1.8, 1e-14);  // (0.8 / 1)^2 = 1 - 0.6^2
  EXPECT_EQ(rock.relief_m({-2, 0}), 0);
  EXPECT_TRUE(std::isnan(rock.relief_m({0, 1.0000001})));
  EXPECT_TRUE(std::isnan(rock.relief_m({2.0000001, 0})));
  const FeatureSize size = Rock{4, 3, 0.5, 0.3}.size();
  EXPECT_EQ(size.diameter_m, 4);
  EXPECT_EQ(size.height_m, 3);
  EXPECT_EQ(size.yaw_rad, 0.3);
}

TEST(Rock, YawTurnsCounterClockwise) {
  const Rock rock{4, 3, 0.5, kPi / 6};
  const double c = std::cos(kPi / 6);
  EXPECT_NEAR(rock.relief_m({1.2 * c, 0.6}), 2.4, 1e-14);
  EXPECT_TRUE(std::isnan(rock.relief_m({1.2 * c, -0.6})));
}

TEST(Rock, Validates) {
  EXPECT_EQ(shape_refusal(Rock{}), "accepted");
  EXPECT_EQ(shape_refusal(Rock{0, 1, 1, 0}), "it/diameter_m: 0 is not finite and positive");
  EXPECT_THAT(shape_refusal(Rock{1, kNan, 1, 0}), HasSubstr("height_m"));
  EXPECT_THAT(shape_refusal(Rock{1, 1, 1.1, 0}), HasSubstr("axis_ratio: 1.1 is not in (0, 1]"));
  EXPECT_THAT(shape_refusal(Rock{1, 1, 0, 0}), HasSubstr("axis_ratio"));
  EXPECT_THAT(shape_refusal(Rock{1, 1, 1, kNan}), HasSubstr("yaw_rad"));
}

// The sums of the published coefficients at x = 0, 0.5, 1, 1.25.
TEST(Crater, ClosedForm) {
  const Crater deep{100, 100 * Crater::kDeepestPerDiameter, 1};
  EXPECT_NEAR(deep.relief_m({0, 0}), -22.8809953, 1e-12);
  EXPECT_NEAR(deep.relief_m({-25, 0}), 100 * (-0.228809953 + 0.113766941 + 0.02077919875 - 0.004937425875),
              1e-12);
  EXPECT_NEAR(deep.relief_m({0, 50}), 3.6822095, 1e-12);
  EXPECT_NEAR(deep.relief_m({37.5, 50}), 100 * (0.188253307 - 0.233813065 + 0.02882415625 + 0.02940716796875),
              1e-12);
  EXPECT_TRUE(std::isnan(deep.relief_m({75.0001, 0})));
}

TEST(Crater, PiecesMeetButForThePublishedStep) {
  const Crater crater{2, 2 * Crater::kDeepestPerDiameter, 1};  // x is r in metres
  const auto step_at = [&](double x) {
    return crater.relief_m({x + 1e-12, 0}) / 2 - crater.relief_m({x - 1e-12, 0}) / 2;
  };
  EXPECT_NEAR(step_at(0.98), 0, 1e-9);
  EXPECT_NEAR(step_at(1.02), -0.004189465, 1e-9);
  EXPECT_NEAR(crater.relief_m({1.5, 0}), 0, 1e-9);
}

// The rim is 0.036 / 0.196 of the depth (Pike 1977), but not higher than that of the published profile.
TEST(Crater, RimIsAConstantPartOfTheDepth) {
  for (const double depth_m : {0.2, 1.0, 1.9})
    for (const double freshness : {0.25, 1.0}) {
      const Crater crater{10, depth_m, freshness};
      EXPECT_NEAR(crater.relief_m({5, 0}), freshness * depth_m * 0.036 / 0.196, 1e-14);
      EXPECT_NEAR(crater.relief_m({5, 0}) - crater.relief_m({0, 0}), freshness * depth_m, 1e-14);
    }
  for (const double diameter_m : {1.0, 20.0, 60.0, 150.0, 300.0})
    EXPECT_NEAR((Crater{diameter_m, 0, 1}.relief_m({diameter_m / 2, 0})),
                Crater::fresh_depth_m(diameter_m) * 0.036 / 0.196, 1e-12);
  for (const double depth_m : {2.01, 2.6})
    EXPECT_NEAR((Crater{10, depth_m, 1}.relief_m({5, 0})), 0.36822095, 1e-14);
}

TEST(Crater, FloorIsLevelAtTheDepthBelowTheRim) {
  const Crater shallow{10, 1.5, 1};
  EXPECT_NEAR(shallow.relief_m({0, 0}), 1.5 * 0.036 / 0.196 - 1.5, 1e-14);
  EXPECT_EQ(shallow.relief_m({0.7, 0}), shallow.relief_m({0, 0}));
  EXPECT_EQ(shallow.size().height_m, -1.5);
  const Crater old{10, 1.5, 0.25};
  for (const double r_m : {0.0, 3.0, 5.0, 6.0})
    EXPECT_NEAR(old.relief_m({0, r_m}), shallow.relief_m({0, r_m}) / 4, 1e-15);
  EXPECT_EQ(old.size().height_m, -0.375);
}

TEST(Crater, FreshDepthByClasses) {
  const double expected[][2] = {{1, 0.1},  {9.999, 0.9999}, {10, 1.1}, {39, 4.29}, {40, 5.2},
                                {100, 15}, {199, 29.85},    {200, 34}, {400, 84},  {1000, 210}};
  for (const auto& [diameter_m, depth_m] : expected)
    EXPECT_NEAR(Crater::fresh_depth_m(diameter_m), depth_m, 1e-12) << diameter_m;
  EXPECT_NEAR((Crater{40, 0, 0.5}.size().height_m), -2.6, 1e-12);
  EXPECT_NEAR((Crater{40, 0, 1}.relief_m({0, 0})), -5.2 * 0.16 / 0.196, 1e-12);
}

TEST(Crater, Validates) {
  EXPECT_EQ(shape_refusal(Crater{}), "accepted");
  EXPECT_EQ(shape_refusal(Crater{10, 10 * Crater::kDeepestPerDiameter, 1}), "accepted");
  EXPECT_THAT(shape_refusal(Crater{-1, 0, 1}), HasSubstr("it/diameter_m: -1"));
  EXPECT_THAT(shape_refusal(Crater{10, 2.7, 1}), HasSubstr("it/depth_m: 2.7 is not in [0, 2.656"));
  EXPECT_THAT(shape_refusal(Crater{10, -1, 1}), HasSubstr("depth_m: -1"));
  EXPECT_THAT(shape_refusal(Crater{10, 1, 0}), HasSubstr("freshness: 0"));
  EXPECT_THAT(shape_refusal(Crater{10, 1, 1.5}), HasSubstr("freshness: 1.5"));
}

TEST(IceBlock, AnUprightBoxIsLevelOnTop) {
  const IceBlock block{4, 2, 1.5, 0, 0};
  EXPECT_EQ(block.relief_m({0, 0}), 1.5);
  EXPECT_EQ(block.relief_m({-2, 1}), 1.5);
  EXPECT_TRUE(std::isnan(block.relief_m({2.0000001, 0})));
  EXPECT_TRUE(std::isnan(block.relief_m({0, -1.0000001})));
  const IceBlock turned{4, 2, 1.5, kPi / 2, 0};
  EXPECT_EQ(turned.relief_m({0.5, 1.9}), 1.5);
  EXPECT_TRUE(std::isnan(turned.relief_m({1.9, 0.5})));
}

/// The highest point of the box over v, by walking up: inside is where all four half-planes of the turned
/// rectangle hold.
double top_of_turned_rectangle(double width_m, double height_m, double tilt_rad, double v_m) {
  double top = kNan;
  for (double z = -4; z < 4; z += 1e-4) {
    const double across = v_m * std::cos(tilt_rad) + z * std::sin(tilt_rad);
    const double up = -v_m * std::sin(tilt_rad) + z * std::cos(tilt_rad);
    if (std::abs(across) <= width_m / 2 && up >= 0 && up <= height_m) top = z;
  }
  return top;
}

TEST(IceBlock, ATiltedBoxIsTheTopOfATurnedRectangle) {
  for (const double tilt_rad : {0.2, -0.5, 1.2}) {
    const IceBlock block{6, 2, 1, 0, tilt_rad};
    const double span_m = std::cos(tilt_rad) + std::abs(std::sin(tilt_rad));
    for (double v_m = -2.4; v_m < 2.4; v_m += 0.013) {
      if (std::abs(std::abs(v_m) - span_m) < 1e-3) continue;  // thinner there than a step of the walk
      const double expected = top_of_turned_rectangle(2, 1, tilt_rad, v_m);
      const double relief = block.relief_m({1, v_m});
      if (std::isnan(expected))
        EXPECT_TRUE(std::isnan(relief)) << tilt_rad << " " << v_m;
      else
        EXPECT_NEAR(relief, expected, 2e-4) << tilt_rad << " " << v_m;
    }
    EXPECT_GE(block.reach_m(), std::hypot(3, span_m) - 1e-12);
  }
}

TEST(IceBlock, SizeIsTheLongerSideAndTheHighestEdge) {
  const FeatureSize along = IceBlock{4, 2, 1, 0.1, 0}.size();
  EXPECT_EQ(along.diameter_m, 4);
  EXPECT_EQ(along.height_m, 1);
  EXPECT_EQ(along.yaw_rad, 0.1);
  const FeatureSize across = IceBlock{1, 2, 1, 0.1, kPi / 6}.size();
  EXPECT_NEAR(across.diameter_m, std::sqrt(3.0) + 0.5, 1e-14);
  EXPECT_NEAR(across.height_m, std::sqrt(0.75) + 0.5, 1e-14);
  EXPECT_NEAR(across.yaw_rad, 0.1 + kPi / 2, 1e-15);
}

TEST(IceBlock, Validates) {
  EXPECT_EQ(shape_refusal(IceBlock{}), "accepted");
  EXPECT_EQ(shape_refusal(IceBlock{1, 1, 1, 0, -80 * kPi / 180}), "accepted");
  EXPECT_THAT(shape_refusal(IceBlock{0, 1, 1, 0, 0}), HasSubstr("length_m"));
  EXPECT_THAT(shape_refusal(IceBlock{1, 0, 1, 0, 0}), HasSubstr("width_m"));
  EXPECT_THAT(shape_refusal(IceBlock{1, 1, 0, 0, 0}), HasSubstr("height_m"));
  EXPECT_THAT(shape_refusal(IceBlock{1, 1, 1, kNan, 0}), HasSubstr("yaw_rad"));
  EXPECT_THAT(shape_refusal(IceBlock{1, 1, 1, 0, 1.5}), HasSubstr("tilt_rad"));
}

TEST(Pit, ClosedForm) {
  const Pit well{4, 3, kPi / 2};
  EXPECT_EQ(well.relief_m({0, 0}), -3);
  EXPECT_EQ(well.relief_m({1.999, 0}), -3);
  EXPECT_EQ(well.relief_m({0, 2}), 0);
  EXPECT_TRUE(std::isnan(well.relief_m({0, 2.0000001})));
  const Pit funnel{4, 3, std::atan(2.0)};
  EXPECT_NEAR(funnel.relief_m({0, -1.5}), -1, 1e-14);
  EXPECT_NEAR(funnel.relief_m({0.3, 0.4}), -3, 1e-14);
  EXPECT_NEAR((Pit{4, 3, kPi / 4}.size().height_m), -2, 1e-14);  // its walls meet
  EXPECT_EQ(shape_refusal(Pit{}), "accepted");
  EXPECT_THAT(shape_refusal(Pit{0, 1, 1}), HasSubstr("diameter_m"));
  EXPECT_THAT(shape_refusal(Pit{1, 0, 1}), HasSubstr("depth_m"));
  EXPECT_THAT(shape_refusal(Pit{1, 1, 0}), HasSubstr("wall_slope_rad"));
  EXPECT_THAT(shape_refusal(Pit{1, 1, 1.6}), HasSubstr("wall_slope_rad"));
}

TEST(Ridge, ClosedForm) {
  const Ridge single{100, 8, 4, 0, 20, 0};
  EXPECT_EQ(single.relief_m({30, 0}), 4);
  EXPECT_NEAR(single.relief_m({-30, 4}), 2, 1e-14);            // half the height at half the width
  EXPECT_NEAR(single.relief_m({0, -8}), 4.0 / 16, 1e-14);      // 2^-4
  EXPECT_NEAR(single.relief_m({40, 0}), 2, 1e-14);             // the middle of the end
  EXPECT_NEAR(single.relief_m({-45, 4}), 2 * 0.15625, 1e-14);  // 1/16 (3 - 1/2)
  EXPECT_EQ(single.relief_m({50, 0}), 0);
  EXPECT_TRUE(std::isnan(single.relief_m({50.001, 0})));
  EXPECT_NEAR(single.relief_m({0, 24}), 4 * std::exp2(-36), 1e-24);
  EXPECT_TRUE(std::isnan(single.relief_m({0, 24.001})));
}

TEST(Ridge, TwoCrests) {
  const Ridge pair{100, 8, 4, 12, 20, 0};
  EXPECT_EQ(pair.relief_m({0, 6}), 4);
  EXPECT_EQ(pair.relief_m({0, -6}), 4);
  EXPECT_NEAR(pair.relief_m({0, 0}), 4 * std::exp2(-2.25), 1e-14);
  EXPECT_NEAR(pair.relief_m({0, 10}), 2, 1e-14);
  const Ridge turned{100, 8, 4, 12, 20, kPi / 2};
  EXPECT_NEAR(turned.relief_m({-6, 20}), 4, 1e-14);
}

TEST(Ridge, Validates) {
  EXPECT_EQ(shape_refusal(Ridge{}), "accepted");
  EXPECT_THAT(shape_refusal(Ridge{0, 1, 1, 0, 0, 0}), HasSubstr("length_m"));
  EXPECT_THAT(shape_refusal(Ridge{9, 0, 1, 0, 0, 0}), HasSubstr("width_m"));
  EXPECT_THAT(shape_refusal(Ridge{9, 1, 0, 0, 0, 0}), HasSubstr("height_m"));
  EXPECT_THAT(shape_refusal(Ridge{9, 1, 1, -1, 0, 0}), HasSubstr("spacing_m"));
  EXPECT_THAT(shape_refusal(Ridge{9, 1, 1, 0, 5, 0}), HasSubstr("taper_m: 5 is not in [0, length_m / 2]"));
  EXPECT_THAT(shape_refusal(Ridge{9, 1, 1, 0, 0, kNan}), HasSubstr("yaw_rad"));
}

TEST(Shapes, DiameterIsTheGreatestExtent) {
  const auto expect = [](const FeatureSize& size, double diameter_m, double yaw_rad) {
    EXPECT_EQ(size.diameter_m, diameter_m);
    EXPECT_EQ(size.yaw_rad, yaw_rad);
  };
  expect((Ridge{100, 10, 3, 20, 10, 0.5}.size()), 100, 0.5);
  expect((Ridge{20, 10, 3, 30, 2, 0.5}.size()), 40, 0.5 + kPi / 2);
  expect((Fracture{100, 6, 2, 0, 0, 1.5, 20, 0.5}.size()), 100, 0.5);
  expect((Fracture{4, 6, 2, 0, 0, 1.5, 1, 0.5}.size()), 6, 0.5 + kPi / 2);
  expect((Fracture{4, 6, 2, 1, 10, 1.5, 1, 0.5}.size()), 13, 0.5 + kPi / 2);
}

TEST(Fracture, Trough) {
  const Fracture trough{100, 6, 2, 0, 0, std::atan(2.0), 20, 0};
  EXPECT_EQ(trough.relief_m({0, 0}), -2);
  EXPECT_EQ(trough.relief_m({0, -1.9}), -2);
  EXPECT_NEAR(trough.relief_m({0, 2.5}), -1, 1e-14);
  EXPECT_EQ(trough.relief_m({0, 3}), 0);
  EXPECT_TRUE(std::isnan(trough.relief_m({0, 3.001})));
  EXPECT_NEAR(trough.relief_m({-40, 0}), -1, 1e-14);
  EXPECT_TRUE(std::isnan(trough.relief_m({50.001, 0})));
  EXPECT_EQ(trough.size().height_m, -2);
  EXPECT_NEAR((Fracture{100, 6, 20, 0, 0, kPi / 4, 20, 0}.size().height_m), -3, 1e-14);  // a V
}

TEST(Fracture, Cliff) {
  const Fracture cliff{100, 0, 0, 3, 40, kPi / 2, 20, 0};
  EXPECT_EQ(cliff.relief_m({0, 0}), 0);
  EXPECT_NEAR(cliff.relief_m({0, 1e-6}), 3, 1e-12);
  EXPECT_NEAR(cliff.relief_m({0, 20}), 1.5, 1e-14);
  EXPECT_EQ(cliff.relief_m({0, 40}), 0);
  EXPECT_TRUE(std::isnan(cliff.relief_m({0, -1e-6})));
  EXPECT_TRUE(std::isnan(cliff.relief_m({0, 40.001})));
  EXPECT_EQ(cliff.size().height_m, 3);
  const Fracture down{100, 0, 0, -3, 40, kPi / 4, 20, 0};
  EXPECT_NEAR(down.relief_m({0, 1}), -(1 - (3 * 0.025 * 0.025 - 2 * std::pow(0.025, 3))), 1e-14);
}

TEST(Fracture, TroughAndCliffAdd) {
  const Fracture both{100, 6, 2, 3, 40, kPi / 2, 0, 0};
  EXPECT_EQ(both.relief_m({0, -1}), -2);
  EXPECT_NEAR(both.relief_m({0, 1e-6}), 1, 1e-12);
  EXPECT_NEAR(both.relief_m({0, 20}), 1.5, 1e-14);
}

TEST(Fracture, Validates) {
  EXPECT_EQ(shape_refusal(Fracture{}), "accepted");
  EXPECT_THAT(shape_refusal(Fracture{0, 1, 1, 0, 0, 1, 0, 0}), HasSubstr("length_m"));
  EXPECT_THAT(shape_refusal(Fracture{9, 0, 1, 0, 0, 1, 0, 0}),
              HasSubstr("width_m: 0 is not positive (a trough"));
  EXPECT_THAT(shape_refusal(Fracture{9, 1, 0, 1, 1, 1, 0, 0}),
              HasSubstr("width_m: 1 is not 0, where depth_m is 0"));
  EXPECT_THAT(shape_refusal(Fracture{9, 0, 0, 0, 0, 1, 0, 0}), HasSubstr("depth_m: 0 is not positive"));
  EXPECT_THAT(shape_refusal(Fracture{9, 0, 0, 1, 0, 1, 0, 0}), HasSubstr("fade_m: 0"));
  EXPECT_THAT(shape_refusal(Fracture{9, 0, 0, kNan, 1, 1, 0, 0}), HasSubstr("throw_m"));
  EXPECT_THAT(shape_refusal(Fracture{9, 1, 1, 0, 0, 2, 0, 0}), HasSubstr("wall_slope_rad"));
  EXPECT_THAT(shape_refusal(Fracture{9, 1, 1, 0, 0, 1, 5, 0}), HasSubstr("taper_m"));
  EXPECT_THAT(shape_refusal(Fracture{9, 1, 1, 0, 0, 1, 0, kNan}), HasSubstr("yaw_rad"));
}

TEST(PenitenteField, ClosedForm) {
  const PenitenteField blades{100, 60, 0, 3, 8, 0.5, 10, 0, 0, 1, 1};
  EXPECT_EQ(blades.relief_m({0, 0}), 0);
  EXPECT_EQ(blades.relief_m({30, 4}), 3);
  EXPECT_EQ(blades.relief_m({30, -12}), 3);
  EXPECT_NEAR(blades.relief_m({0, 9}), 1.5, 1e-14);   // sqrt(1 - 3/4)
  EXPECT_NEAR(blades.relief_m({45, 4}), 1.5, 1e-14);  // the middle of the edge
  EXPECT_NEAR(blades.relief_m({-45, 28}), 3 * 0.5 * (0.04 * 2.6), 1e-14);
  EXPECT_TRUE(std::isnan(blades.relief_m({50.001, 0})));
  EXPECT_TRUE(std::isnan(blades.relief_m({0, -30.001})));
  const PenitenteField disc{0, 0, 60, 3, 8, 1, 10, 0, 0, 1, 1};
  EXPECT_NEAR(disc.relief_m({15, 20}), 0.5 * 3, 1e-14);  // r = 25; 20 is half a wave past a trough
  EXPECT_TRUE(std::isnan(disc.relief_m({24, 18.001})));
  EXPECT_FALSE(std::isnan(disc.relief_m({24, 17.999})));
}

TEST(PenitenteField, YawTurnsTheBlades) {
  const PenitenteField blades{100, 60, 0, 3, 8, 1, 0, kPi / 2, 0, 1, 1};
  EXPECT_NEAR(blades.relief_m({-4, 40}), 3, 1e-12);
  EXPECT_TRUE(std::isnan(blades.relief_m({40, 0})));
}

// The wander is bounded, smooth, other for another seed, and moves a blade by no more than wobble_m.
TEST(PenitenteField, Wobble) {
  const PenitenteField still{100, 100, 0, 1, 8, 1, 0, 0, 0, 5, 1};
  PenitenteField wandering = still;
  wandering.wobble_m = 1;
  PenitenteField other = wandering;
  other.seed = 2;
  double maximum = 0;
  double differing = 0;
  for (double x_m = -49; x_m < 49; x_m += 0.25) {
    const double here = wandering.relief_m({x_m, 2});  // the middle of a flank: 1/4 m per metre of wander
    EXPECT_LE(std::abs(here - 0.5), 0.25);
    EXPECT_NEAR(here, wandering.relief_m({x_m + 1e-6, 2}), 1e-6);
    maximum = std::max(maximum, std::abs(here - 0.5));
    differing = std::max(differing, std::abs(here - other.relief_m({x_m, 2})));
  }
  EXPECT_GT(maximum, 0.1);
  EXPECT_GT(differing, 0.1);
}

TEST(PenitenteField, Validates) {
  const auto with = [](auto change) {
    PenitenteField field;
    change(field);
    return shape_refusal(field);
  };
  EXPECT_EQ(shape_refusal(PenitenteField{}), "accepted");
  EXPECT_EQ(with([](auto& f) { f.length_m = f.width_m = 0, f.diameter_m = 30; }), "accepted");
  EXPECT_THAT(with([](auto& f) { f.length_m = 0; }), HasSubstr("length_m: 0 is not finite and positive"));
  EXPECT_THAT(with([](auto& f) { f.diameter_m = 30; }),
              HasSubstr("length_m: 50 is not allowed with diameter_m"));
  EXPECT_THAT(with([](auto& f) { f.diameter_m = 30, f.length_m = 0; }),
              HasSubstr("width_m: 50 is not allowed with diameter_m"));
  EXPECT_THAT(with([](auto& f) { f.amplitude_m = 0; }), HasSubstr("amplitude_m"));
  EXPECT_THAT(with([](auto& f) { f.wavelength_m = kNan; }), HasSubstr("wavelength_m"));
  EXPECT_THAT(with([](auto& f) { f.exponent = 0; }), HasSubstr("exponent"));
  EXPECT_THAT(with([](auto& f) { f.edge_m = 26; }), HasSubstr("edge_m"));
  EXPECT_THAT(with([](auto& f) { f.yaw_rad = kNan; }), HasSubstr("yaw_rad"));
  EXPECT_THAT(with([](auto& f) { f.wobble_m = -1; }), HasSubstr("wobble_m"));
  EXPECT_EQ(with([](auto& f) { f.wobble_length_m = 1e-9; }), "accepted");  // nothing wobbles
  EXPECT_THAT(with([](auto& f) { f.wobble_m = 1, f.wobble_length_m = 1e-9; }), HasSubstr("wobble_length_m"));
}

/// No place beyond the reach has a relief.
TEST(Shapes, ReachHoldsTheFootprint) {
  const std::vector<FeatureShape> shapes = {Rock{3, 1, 0.6, 0.4},
                                            Crater{5, 0, 0.8},
                                            IceBlock{2, 1, 1, 0.3, 0.7},
                                            Ridge{9, 1, 1, 2, 1, 0.5},
                                            Fracture{7, 1, 2, 0.5, 3, 1.1, 2, -0.4},
                                            Pit{2, 1, 1.2},
                                            PenitenteField{6, 4, 0, 0.4, 1.3, 0.7, 0.5, 0.3, 0.2, 2, 9},
                                            PenitenteField{0, 0, 6, 0.4, 1.3, 0.7, 0.5, 0.3, 0.2, 2, 9}};
  for (const FeatureShape& shape : shapes)
    std::visit(
        [](const auto& s) {
          int inside = 0;
          for (double x_m = -9; x_m <= 9; x_m += 0.06)
            for (double y_m = -9; y_m <= 9; y_m += 0.06) {
              if (std::isnan(s.relief_m({x_m, y_m}))) continue;
              ++inside;
              EXPECT_LE(std::max(std::abs(x_m), std::abs(y_m)), s.reach_m()) << s.kName;
            }
          EXPECT_GT(inside, 100) << s.kName;
        },
        shape);
}

}  // namespace
}  // namespace landfall
