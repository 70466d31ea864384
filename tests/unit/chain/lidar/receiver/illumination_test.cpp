// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/receiver/link_budget.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/core/error.h"

namespace landfall {
namespace {

using std::numbers::pi;

Direction<LidarFrame> towards(double x_rad, double y_rad) {
  return Direction<LidarFrame>::of({{std::tan(x_rad), std::tan(y_rad), 1}});
}

TEST(Illumination, WithoutADivergenceItIsUniform) {
  const Illumination beam;
  EXPECT_EQ(beam.relative(towards(0.3, -0.7)), 1);
  EXPECT_FALSE(beam.peak_per_sr());
}

TEST(Illumination, GaussianFallsTo1OverESquareAtHalfTheDivergence) {
  const Illumination beam({BeamProfile::gaussian, 2e-3, 0.01, -0.02});
  EXPECT_NEAR(beam.relative(towards(0.01, -0.02)), 1, 1e-15);
  EXPECT_NEAR(beam.relative(towards(0.011, -0.02)), std::exp(-2),
              2e-4);  // across the offset the angle is a little less
  const Illumination centred({BeamProfile::gaussian, 2e-3});
  EXPECT_NEAR(centred.relative(towards(0, 1e-3)), std::exp(-2), 1e-12);
  EXPECT_NEAR(centred.relative(towards(5e-4, 0)), std::exp(-0.5), 1e-12);
}

TEST(Illumination, TopHatEndsAtHalfTheDivergence) {
  const Illumination beam({BeamProfile::top_hat, 2e-3});
  EXPECT_EQ(beam.relative(towards(0.99e-3, 0)), 1);
  EXPECT_EQ(beam.relative(towards(1.01e-3, 0)), 0);
}

TEST(Illumination, TheWholeSolidAngleHoldsTheWholePulse) {
  constexpr double kDivergence = 2e-3;
  for (const BeamProfile profile : {BeamProfile::gaussian, BeamProfile::top_hat}) {
    const Illumination beam({profile, kDivergence});
    double energy = 0;
    constexpr double kStep = 1e-6;
    for (double theta = kStep / 2; theta < 4 * kDivergence; theta += kStep)
      energy += 2 * pi * theta * kStep * beam.relative(towards(theta, 0)) * *beam.peak_per_sr();
    EXPECT_NEAR(energy, 1, 1e-3);
  }
}

TEST(Illumination, NamesABadParameter) {
  for (const double bad : {0.0, -1e-3, 3.2, std::nan("")})
    EXPECT_THROW(Illumination({BeamProfile::gaussian, bad}), UsageError) << bad;
  EXPECT_THROW(Illumination({BeamProfile::gaussian, 1e-3, 1.6}), UsageError);
  EXPECT_THROW(Illumination({BeamProfile::gaussian, 1e-3, 0, -1.6}), UsageError);
}

TEST(LinkBudget, ReferenceSignalHoldsAtItsRange) {
  EXPECT_DOUBLE_EQ(link_constant_pe_m2(ReferenceSignal{400, 500}) / (500.0 * 500), 400);
  EXPECT_THROW(static_cast<void>(link_constant_pe_m2(ReferenceSignal{0, 500})), UsageError);
  EXPECT_THROW(static_cast<void>(link_constant_pe_m2(ReferenceSignal{1, -1})), UsageError);
}

TEST(LinkBudget, DesignFollowsTheLidarEquation) {
  // by hand: 1 uJ at 1064 nm is 5.35628e12 photons; a pixel of (1e-4 rad)^2 in the middle of a Gaussian beam
  // of 2 mrad takes 8/(pi 4e-6) 1e-8 = 6.3662e-3 of them; a white Lambertian target at 500 m sends (pi
  // 0.025^2)/(pi 500^2) = 2.5e-9 of these into a telescope of 5 cm, of which 30 % are detected
  const LinkDesign design{1e-6, 1064e-9, 0.05, 0.3};
  const double constant = link_constant_pe_m2(design, 1e-8, Illumination({BeamProfile::gaussian, 2e-3}));
  EXPECT_NEAR(constant / (500.0 * 500), 5.35628e12 * 6.3662e-3 * 2.5e-9 * 0.3, 0.001);
}

TEST(LinkBudget, DesignNeedsADivergenceAndPositiveNumbers) {
  const Illumination beam({BeamProfile::top_hat, 2e-3});
  EXPECT_THROW(static_cast<void>(link_constant_pe_m2({1e-6, 1e-6, 0.1, 0.5}, 1e-8, Illumination())),
               UsageError);
  EXPECT_THROW(static_cast<void>(link_constant_pe_m2({0, 1e-6, 0.1, 0.5}, 1e-8, beam)), UsageError);
  EXPECT_THROW(static_cast<void>(link_constant_pe_m2({1e-6, 0, 0.1, 0.5}, 1e-8, beam)), UsageError);
  EXPECT_THROW(static_cast<void>(link_constant_pe_m2({1e-6, 1e-6, 0, 0.5}, 1e-8, beam)), UsageError);
  EXPECT_THROW(static_cast<void>(link_constant_pe_m2({1e-6, 1e-6, 0.1, 1.1}, 1e-8, beam)), UsageError);
  EXPECT_THROW(static_cast<void>(link_constant_pe_m2({1e-6, 1e-6, 0.1, 0}, 1e-8, beam)), UsageError);
}

}  // namespace
}  // namespace landfall
