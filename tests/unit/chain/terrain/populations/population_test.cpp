// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <vector>

#include "base/core/parallel.h"
#include "chain/terrain/populations/disc_packing.h"
#include "chain/terrain/populations/population.h"
#include "chain/terrain/populations/size_law.h"
#include "constants.h"
#include "populations/drawn.h"
#include "refusal.h"

namespace landfall {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const Population kRockPopulation{GolombekLaw{0.1}, {0.3, 3}};

/// All that a draw says, to compare exactly.
std::vector<std::array<double, 3>> listed(const std::vector<ScatteredObject>& objects) {
  std::vector<std::array<double, 3>> list;
  for (const ScatteredObject& o : objects) list.push_back({o.point.x_m, o.point.y_m, o.diameter_m});
  return list;
}

TEST(Population, TheSameObjectsForAnyNumberOfThreads) {
  const Population many{kViperRocks, {0.02, 3}, SiteRegion{}, 3};
  std::vector<ScatteredObject> one;
  {
    const ThreadLimit limit(1);
    one = drawn(many, hectare());
  }
  const ThreadLimit limit(4);
  EXPECT_GT(one.size(), 3 * 4096U);
  EXPECT_EQ(listed(one), listed(drawn(many, hectare())));
}

TEST(Population, SizesDescendAndKeysAreUnique) {
  const auto objects = drawn({kTraskCraters, {1, 50}}, hectare(), kTestCraters);
  EXPECT_TRUE(std::ranges::is_sorted(objects, std::greater{}, &ScatteredObject::diameter_m));
  std::set<std::uint64_t> keys;
  for (const ScatteredObject& o : objects) keys.insert(o.key);
  EXPECT_EQ(keys.size(), objects.size());
}

TEST(Population, OtherDiametersOnlyTakeAwayOrAdd) {
  for (const PopulationKind& kind : {kTestRocks, kTestCraters}) {
    const auto all = drawn({kHaworthRocks, {0.2, 6}}, hectare(), kind);
    auto some = all;
    std::erase_if(some, [](const ScatteredObject& o) { return o.diameter_m < 0.45 || o.diameter_m > 2.2; });
    const auto cut = drawn({kHaworthRocks, {0.45, 2.2}}, hectare(), kind);
    EXPECT_EQ(listed(cut), listed(some));
    EXPECT_LT(some.size(), all.size());
  }
}

TEST(Population, PatternsAndSeedsDrawApart) {
  const auto first = listed(drawn(kRockPopulation, hectare(1, 0)));
  EXPECT_NE(first, listed(drawn(kRockPopulation, hectare(1, 1))));
  EXPECT_NE(first, listed(drawn(kRockPopulation, hectare(2, 0))));
  PopulationKind other = kTestRocks;
  other.stream = RandomStream::ice_block_population;
  EXPECT_NE(first, listed(drawn(kRockPopulation, hectare(1, 0), other)));
}

TEST(Population, ASeedOfItsOwnFreesItFromThePlaceInTheList) {
  Population seeded = kRockPopulation;
  seeded.seed = 7;
  EXPECT_EQ(listed(drawn(seeded, hectare(1, 0))), listed(drawn(seeded, hectare(1, 3))));
  EXPECT_EQ(listed(drawn(seeded, hectare(1, 0))), listed(drawn(kRockPopulation, hectare(1, 7))));
}

TEST(Population, NothingReachesIntoTheClearCircle) {
  for (const PopulationKind& kind : {kTestRocks, kTestCraters}) {
    const Population all{kTraskCraters, {1, 20}};
    Population cleared = all;
    cleared.clear_radius_m = 15;
    auto expected = drawn(all, hectare(), kind);
    const std::size_t before = expected.size();
    std::erase_if(expected, [&](const ScatteredObject& o) {
      return std::hypot(o.point.x_m, o.point.y_m) - kind.reach * o.diameter_m < 15;
    });
    EXPECT_EQ(listed(drawn(cleared, hectare(), kind)), listed(expected));
    EXPECT_LT(expected.size(), before);
  }
}

std::size_t overlapping_pairs(const std::vector<ScatteredObject>& objects, double reach) {
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < objects.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double dx_m = objects[i].point.x_m - objects[j].point.x_m;
      const double dy_m = objects[i].point.y_m - objects[j].point.y_m;
      const double sum_m = reach * (objects[i].diameter_m + objects[j].diameter_m);
      pairs += dx_m * dx_m + dy_m * dy_m < sum_m * sum_m ? 1U : 0U;
    }
  return pairs;
}

TEST(Population, WithoutOverlapNoTwoOverlap) {
  for (const Region& region : {Region(SiteRegion{}), Region(AnnulusRegion{{3, 4}, 5, 40})})
    for (const PopulationKind& kind : {kTestRocks, kTestCraters}) {
      const Population loose{GolombekLaw{0.2}, {0.3, 3}, region, 2};
      Population packed = loose;
      packed.overlap = false;
      const auto before = drawn(loose, hectare(), kind);
      const auto after = drawn(packed, hectare(), kind);
      EXPECT_GT(overlapping_pairs(before, kind.reach), 300U);
      EXPECT_EQ(overlapping_pairs(after, kind.reach), 0U);
      ASSERT_EQ(after.size(), before.size());
      std::size_t moved = 0;
      for (std::size_t i = 0; i < before.size(); ++i) {
        EXPECT_EQ(after[i].diameter_m, before[i].diameter_m);
        EXPECT_GE(std::hypot(after[i].point.x_m, after[i].point.y_m), 2 + kind.reach * after[i].diameter_m);
        EXPECT_TRUE(contains(region, after[i].point));
        moved += after[i].point == before[i].point ? 0U : 1U;
      }
      EXPECT_GT(moved, 100U);
      EXPECT_LT(moved, before.size() / 2);  // only those that were in the way
    }
}

TEST(Population, RefusesWhatCannotBePacked) {
  Population dense{PowerLaw{1, 1}, {0.5, 10}};
  dense.overlap = false;
  EXPECT_THAT(
      refusal([&] { return drawn(dense, hectare(1, 3)); }),
      AllOf(HasSubstr("patterns/3/overlap: a rock of "), HasSubstr("no free position in 1000 draws")));
}

TEST(Population, RefusesMoreThanItCanHold) {
  const auto of = [](const Population& population, const PatternSite& site) {
    return refusal([&] { PopulationSampler(population, kTestRocks, site); });
  };
  EXPECT_EQ(of({PowerLaw{1, 2}, {0.01, 1}}, hectare(1, 2)),
            "patterns/2: about 99990000 rocks would be drawn, more than 1e+07; raise min_diameter_m");
  EXPECT_THAT(of({PowerLaw{1, 2}, {1e-300, 1}}, hectare()), HasSubstr("about inf rocks"));
  EXPECT_EQ(of({PowerLaw{1, 2}, {0.1, 1}}, hectare()), "accepted");
  EXPECT_EQ(of({kViperRocks, {0.1, 1}, AnnulusRegion{{80, 0}, 0, 20}}, hectare()),
            "patterns/0/region: does not meet the site");
}

TEST(Population, RefusesParametersWithoutSense) {
  const auto of = [](const auto& change) {
    Population population = kRockPopulation;
    change(population);
    return refusal([&] { population.validate("patterns/0"); });
  };
  EXPECT_EQ(of([](Population&) {}), "accepted");
  EXPECT_THAT(of([](Population& p) { p.law = GolombekLaw{2}; }), HasSubstr("patterns/0/k: 2"));
  EXPECT_THAT(of([](Population& p) { p.diameters.min_m = 0; }), HasSubstr("patterns/0/min_diameter_m: 0"));
  EXPECT_THAT(of([](Population& p) { p.diameters.max_m = 0.3; }), HasSubstr("max_diameter_m: 0.3 is not"));
  EXPECT_THAT(of([](Population& p) { p.diameters.max_m = 1e6; }), HasSubstr("max_diameter_m: 1e+06"));
  EXPECT_THAT(of([](Population& p) { p.clear_radius_m = -1; }), HasSubstr("clear_radius_m: -1"));
  EXPECT_THAT(of([](Population& p) { p.seed = 4294967296; }), HasSubstr("seed: 4294967296"));
  EXPECT_THAT(of([](Population& p) {
                p.region = RectangleRegion{{0, 0}, 0, 1};
              }),
              HasSubstr("patterns/0/region/width_m: 0"));
  EXPECT_THAT(of([](Population& p) { p.region = RectangleRegion{{0, 0}, 1, -1}; }), HasSubstr("length_m"));
  EXPECT_THAT(of([](Population& p) { p.region = AnnulusRegion{{0, 0}, 2, 2}; }), HasSubstr("inner_radius_m"));
  EXPECT_THAT(of([](Population& p) { p.region = AnnulusRegion{{0, 0}, 0, 0}; }), HasSubstr("outer_radius_m"));
  EXPECT_THAT(of([](Population& p) { p.region = AnnulusRegion{{std::nan(""), 0}, 0, 1}; }), HasSubstr("x_m"));
}

TEST(DiscPacking, IsBruteForce) {
  const RandomField random(20240607, RandomStream::fractal);
  DiscPacking packing;
  std::vector<Disc> kept;
  for (std::uint64_t i = 0; i < 4000; ++i) {  // in any order of sizes
    const Disc disc{40 * random.uniform(i, 0) - 20, 40 * random.uniform(i, 1) - 20,
                    std::exp2(7 * random.uniform(i, 2) - 6)};
    const bool is_free = std::ranges::none_of(kept, [&](const Disc& other) {
      return std::hypot(disc.x_m - other.x_m, disc.y_m - other.y_m) < disc.radius_m + other.radius_m;
    });
    ASSERT_EQ(packing.add_if_free(disc), is_free) << i;
    if (is_free) kept.push_back(disc);
  }
  EXPECT_GT(kept.size(), 300U);
  EXPECT_LT(kept.size(), 3000U);
}

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
