// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/terrain_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "constants.h"
#include "refusal.h"

namespace landfall {
namespace {

TEST(Cone, ClosedForm) {
  const Cone cone{3, 10};
  EXPECT_EQ(cone.relief_m({0, 0}), 10);
  EXPECT_EQ(cone.relief_m({1.5, 0}), 5);
  EXPECT_NEAR(cone.relief_m({-1.2, 1.6}), 10.0 / 3, 1e-14);  // r = 2
  EXPECT_EQ(cone.relief_m({0, -3}), 0);
  EXPECT_TRUE(std::isnan(cone.relief_m({0, 3.0000001})));
}

TEST(Hemisphere, ClosedForm) {
  const Hemisphere ball{5};
  EXPECT_EQ(ball.relief_m({0, 0}), 5);
  EXPECT_EQ(ball.relief_m({0, -3}), 4);
  EXPECT_EQ(ball.relief_m({5, 0}), 0);
  EXPECT_TRUE(std::isnan(ball.relief_m({4, 3.0000001})));
}

TEST(Pyramid, ClosedForm) {
  const Pyramid pyramid{4, 6, 0};
  EXPECT_EQ(pyramid.relief_m({0, 0}), 6);
  EXPECT_EQ(pyramid.relief_m({1, 0.5}), 3);
  EXPECT_EQ(pyramid.relief_m({-0.5, -1}), 3);
  EXPECT_EQ(pyramid.relief_m({2, 2}), 0);  // a corner of the base
  EXPECT_TRUE(std::isnan(pyramid.relief_m({2.0000001, 0})));
}

// Turned by 45 deg, the corners point along the axes; 30 deg counter-clockwise brings the middle of the +x
// edge to azimuth 30 deg.
TEST(Pyramid, YawTurnsCounterClockwise) {
  const Pyramid diamond{4, 6, kPi / 4};
  EXPECT_NEAR(diamond.relief_m({std::sqrt(2.0), 0}), 3, 1e-14);
  EXPECT_NEAR(diamond.relief_m({0, 2 * std::sqrt(2.0) * (1 - 1e-12)}), 0, 1e-10);
  const Pyramid turned{4, 6, kPi / 6};
  EXPECT_NEAR(turned.relief_m({std::cos(kPi / 6), std::sin(kPi / 6)}), 3, 1e-14);
  EXPECT_NEAR(turned.relief_m({std::cos(kPi / 6), -std::sin(kPi / 6)}), 6 * (1 - std::sin(kPi / 3) / 2),
              1e-14);
}

TEST(RingPattern, CounterClockwiseFromPlusX) {
  const auto ring = RingPattern{4, 25, 0, Hemisphere{2}}.features({});
  ASSERT_EQ(ring.size(), 4U);
  const double expected[4][2] = {{25, 0}, {0, 25}, {-25, 0}, {0, -25}};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(ring[i].x_m, expected[i][0], 1e-13);
    EXPECT_NEAR(ring[i].y_m, expected[i][1], 1e-13);
    EXPECT_EQ(ring[i].shape, FeatureShape(Hemisphere{2}));
  }
  const auto turned = RingPattern{10, 25, kPi / 5, Cone{}}.features({});
  EXPECT_NEAR(turned[0].x_m, 25 * std::cos(kPi / 5), 1e-13);
  EXPECT_NEAR(turned[9].x_m, 25, 1e-13);  // the tenth of 36 deg steps from 36 deg is back on +x
}

template <class T>
TerrainModel model_of(const T& part) {
  TerrainModel model;
  if constexpr (std::is_constructible_v<Base, T>)
    model.bases = {part};
  else if constexpr (std::is_same_v<T, RingPattern>)
    model.patterns = {part};
  else
    model.features = {Feature{0, 0, part}};
  return model;
}

template <class T>
std::string model_refusal(const T& part) {
  return refusal([&] { validate(model_of(part)); });
}

TEST(Validate, DefaultsMakeSense) {
  EXPECT_NO_THROW(validate(TerrainModel{}));
  EXPECT_EQ(model_refusal(FractalBase{}), "accepted");
  EXPECT_EQ(model_refusal(RingPattern{}), "accepted");
  EXPECT_EQ(model_refusal(Pyramid{}), "accepted");
}

TEST(Validate, NamesPlaceKeyAndValue) {
  using testing::HasSubstr;
  EXPECT_EQ(model_refusal(Cone{-3, 10}), "features/0/radius_m: -3 is not finite and positive");
  EXPECT_THAT(model_refusal(Cone{3, 0}), HasSubstr("height_m"));
  EXPECT_THAT(model_refusal(Hemisphere{kNan}), HasSubstr("radius_m: nan"));
  EXPECT_THAT(model_refusal(Pyramid{0, 1, 0}), HasSubstr("base_width_m"));
  EXPECT_THAT(model_refusal(Pyramid{1, 0, 0}), HasSubstr("height_m"));
  EXPECT_THAT(model_refusal(Pyramid{1, 1, kNan}), HasSubstr("yaw_rad"));
  EXPECT_THAT(model_refusal(RingPattern{0, 25, 0, Cone{}}), HasSubstr("patterns/0/count: 0"));
  EXPECT_THAT(model_refusal(RingPattern{1000001, 25, 0, Cone{}}), HasSubstr("count"));
  EXPECT_THAT(model_refusal(RingPattern{1, -1, 0, Cone{}}), HasSubstr("patterns/0/radius_m"));
  EXPECT_THAT(model_refusal(RingPattern{1, 1, kNan, Cone{}}), HasSubstr("first_azimuth_rad"));
  EXPECT_THAT(model_refusal(RingPattern{1, 1, 0, Cone{0, 1}}), HasSubstr("patterns/0/feature/radius_m"));
  EXPECT_THAT(model_refusal(PlaneBase{kNan, 0, 0}), HasSubstr("base/0/elevation_m"));
  EXPECT_THAT(model_refusal(PlaneBase{0, kNan, 0}), HasSubstr("slope_x"));
  EXPECT_THAT(model_refusal(PlaneBase{0, 0, kNan}), HasSubstr("slope_y"));
  EXPECT_THAT(model_refusal(FractalBase{0, 1, 1}), HasSubstr("hurst_exponent"));
  EXPECT_THAT(model_refusal(FractalBase{1, 1, 1}), HasSubstr("hurst_exponent"));
  EXPECT_THAT(model_refusal(FractalBase{0.5, -1, 1}), HasSubstr("rms_deviation_m"));
  EXPECT_THAT(model_refusal(FractalBase{0.5, 1, 0}), HasSubstr("reference_length_m"));
  EXPECT_THAT(model_refusal(FractalBase{0.5, 1, 1, 0}), HasSubstr("longest_wavelength_m"));
  EXPECT_EQ(model_refusal(FractalBase{0.5, 1, 1, std::numeric_limits<double>::infinity()}), "accepted");
}

TEST(Validate, RefusesADemWithoutSense) {
  using testing::HasSubstr;
  DemBase dem;
  EXPECT_THAT(model_refusal(dem), HasSubstr("base/0/path"));
  dem.path = "a.tif";
  EXPECT_EQ(model_refusal(dem), "accepted");
  DemBase both = dem;
  both.center = {1, 2};
  both.center_pixel = {1, 2};
  EXPECT_THAT(model_refusal(both), HasSubstr("not both"));
  DemBase band = dem;
  band.band = 0;
  EXPECT_THAT(model_refusal(band), HasSubstr("band: 0"));
  DemBase scale = dem;
  scale.vertical_scale = 0;
  EXPECT_THAT(model_refusal(scale), HasSubstr("vertical_scale"));
  DemBase horizontal = dem;
  horizontal.horizontal_scale_m = -1;
  EXPECT_THAT(model_refusal(horizontal), HasSubstr("horizontal_scale_m: -1"));
  DemBase center = dem;
  center.center = {kNan, 0};
  EXPECT_THAT(model_refusal(center), HasSubstr("center"));
}

}  // namespace
}  // namespace landfall
