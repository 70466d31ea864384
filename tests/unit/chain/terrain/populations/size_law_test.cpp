// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/populations/size_law.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "constants.h"
#include "refusal.h"

namespace landfall {
namespace {

double per_hectare(const SizeLaw& law, double diameter_m) { return 1e4 * density_per_m2(law, diameter_m); }

TEST(SizeLaw, RocksPerHectare) {
  EXPECT_NEAR(per_hectare(GolombekLaw{0.02}, 0.3), 106, 0.5);
  EXPECT_NEAR(per_hectare(GolombekLaw{0.05}, 0.3), 804, 0.5);
  EXPECT_NEAR(per_hectare(GolombekLaw{0.10}, 0.3), 2108, 0.5);
  EXPECT_NEAR(per_hectare(GolombekLaw{0.20}, 0.3), 4590, 0.5);
  EXPECT_NEAR(per_hectare(GolombekLaw{0.02}, 1), 0.02, 0.005);
  EXPECT_NEAR(per_hectare(GolombekLaw{0.05}, 1), 3.7, 0.05);
  EXPECT_NEAR(per_hectare(GolombekLaw{0.10}, 1), 31, 0.5);
  EXPECT_NEAR(per_hectare(GolombekLaw{0.20}, 1), 121, 0.5);
  EXPECT_NEAR(per_hectare(kViperRocks, 0.3), 60, 0.5);
  EXPECT_NEAR(per_hectare(kLowBlockyRocks, 0.3), 8, 0.5);
  EXPECT_NEAR(per_hectare(kHaworthRocks, 0.3), 492, 0.5);
}

TEST(SizeLaw, CratersPerHectare) {
  EXPECT_NEAR(per_hectare(kTraskCraters, 1), 794, 0.5);
  EXPECT_NEAR(per_hectare(kTraskCraters, 5), 32, 0.5);
  EXPECT_NEAR(per_hectare(kTraskCraters, 10), 8, 0.5);
  EXPECT_NEAR(per_hectare(ViperCraterLaw{}, 1), 292, 0.5);
  EXPECT_NEAR(per_hectare(ViperCraterLaw{}, 5), 13, 0.5);
  EXPECT_NEAR(per_hectare(ViperCraterLaw{}, 10), 3.5, 0.05);
  EXPECT_DOUBLE_EQ(kTraskCraters.coefficient, std::pow(10, -1.1));
}

// VIPER's two crater laws, as published, per square metre.
double viper_small(double d) { return 29174e-6 * std::pow(d, -1.92); }
double viper_large(double d) { return 156228e-6 * std::pow(d, -2.389); }

TEST(ViperCraterLaw, IsTheSumOfWhatIsLarger) {
  const ViperCraterLaw law;
  EXPECT_NEAR(viper_small(80) / viper_large(80), 1.46, 0.005);  // the leap
  EXPECT_DOUBLE_EQ(law.density_per_m2(120), viper_large(120));
  EXPECT_DOUBLE_EQ(law.density_per_m2(80), viper_large(80));
  EXPECT_NEAR(law.density_per_m2(80 * (1 - 1e-12)), viper_large(80), 1e-16);
  // As many between two diameters as each formula says.
  EXPECT_NEAR(law.density_per_m2(3) - law.density_per_m2(50), viper_small(3) - viper_small(50), 1e-16);
  EXPECT_NEAR(law.density_per_m2(1) / viper_small(1), 1, 1e-4);
}

/// The integral of f from a to b by Gauss and Legendre's three points in n pieces, even in the logarithm.
template <class F>
double integral(double a, double b, int n, const F& f) {
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const double low = a * std::pow(b / a, static_cast<double>(i) / n);
    const double high = a * std::pow(b / a, static_cast<double>(i + 1) / n);
    const double middle = (low + high) / 2;
    const double half = (high - low) / 2;
    const double offset = half * std::sqrt(0.6);
    sum += half / 9 * (5 * f(middle - offset) + 8 * f(middle) + 5 * f(middle + offset));
  }
  return sum;
}

TEST(GolombekLaw, IsTheIntegralOfTheAreaThatRocksCover) {
  for (const double k : {0.005, 0.02, 0.1, 0.3, 1.0})
    for (const double d : {0.05, 0.3, 1.0, 3.0}) {
      const GolombekLaw law{k};
      const double q = 1.79 + 0.152 / k;
      const double expected = integral(
          d, d + 60 / q, 2000, [&](double x) { return 4 / (kPi * x * x) * k * q * std::exp(-q * x); });
      EXPECT_NEAR(law.density_per_m2(d) / expected, 1, 1e-11) << "k " << k << ", D " << d;
    }
}

const std::vector<SizeLaw> kLaws = {GolombekLaw{0.001}, GolombekLaw{0.02}, GolombekLaw{0.2},
                                    kViperRocks,        kLowBlockyRocks,   kTraskCraters,
                                    PowerLaw{7, 3},     ViperCraterLaw{}};

TEST(SizeLaw, TheInverseGivesTheDiameterBack) {
  for (std::size_t i = 0; i < kLaws.size(); ++i)
    for (const DiameterRange& range : {DiameterRange{0.01, 5}, DiameterRange{0.25, 0.5}})
      for (int step = 0; step <= 40; ++step) {
        const double d = range.min_m * std::pow(range.max_m / range.min_m, step / 40.0);
        const double density = density_per_m2(kLaws[i], d);
        if (density < std::numeric_limits<double>::min()) continue;
        EXPECT_NEAR(diameter_m(kLaws[i], density, range) / d, 1, 1e-12) << "law " << i << ", D " << d;
      }
  for (const double d : {1.0, 30.0, 79.999, 80.0, 80.001, 400.0})
    EXPECT_NEAR(diameter_m(ViperCraterLaw{}, density_per_m2(ViperCraterLaw{}, d), {1, 1000}) / d, 1, 1e-12);
}

// N itself is the oracle: the integral of pi D^2 / 4 |dN| by parts is pi / 4 (a^2 N(a) - b^2 N(b)) plus that
// of pi / 2 D N(D) dD.
TEST(SizeLaw, AreaFractionIsThatOfTheDiscs) {
  for (std::size_t i = 0; i < kLaws.size(); ++i) {
    const double a = 0.2;
    const double b = 100;
    const auto n = [&](double d) { return density_per_m2(kLaws[i], d); };
    const double expected = kPi / 4 * (a * a * n(a) - b * b * n(b)) +
                            integral(a, b, 4000, [&](double d) { return kPi / 2 * d * n(d); });
    EXPECT_NEAR(area_fraction(kLaws[i], {a, b}) / expected, 1, 1e-7) << "law " << i;
  }
}

TEST(GolombekLaw, CoveringIsTheLawOfThatAreaFraction) {
  for (const double diameter : {0.0, 0.1, 1.0})
    for (const double fraction : {1e-6, 0.01, 0.1}) {
      const GolombekLaw law = GolombekLaw::covering(fraction, diameter, "rocks");
      EXPECT_NEAR(law.area_fraction({diameter, 1e3}) / fraction, 1, 1e-12);
    }
  EXPECT_DOUBLE_EQ(GolombekLaw::covering(0.07, 0, "rocks").k, 0.07);
}

TEST(SizeLaw, RefusesParametersWithoutSense) {
  using testing::HasSubstr;
  const auto of = [](const SizeLaw& law) { return refusal([&] { validate(law, "patterns/0"); }); };
  EXPECT_EQ(of(GolombekLaw{0}), "patterns/0/k: 0 is not in (0, 1]");
  EXPECT_THAT(of(GolombekLaw{1.1}), HasSubstr("k: 1.1"));
  EXPECT_THAT(of(GolombekLaw{std::nan("")}), HasSubstr("k: nan"));
  EXPECT_THAT(of(PowerLaw{0, 2}), HasSubstr("coefficient: 0"));
  EXPECT_THAT(of(PowerLaw{1, -2}), HasSubstr("exponent: -2"));
  EXPECT_EQ(of(ViperCraterLaw{}), "accepted");
  EXPECT_THAT(refusal([] { return GolombekLaw::covering(0.5, 1, "patterns/0"); }),
              HasSubstr("patterns/0: rocks of 1 m and more cover at most 0.14"));
}

}  // namespace
}  // namespace landfall
