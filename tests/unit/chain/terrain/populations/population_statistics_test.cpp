// SPDX-License-Identifier: GPL-3.0-or-later
// The draws against the model. The seeds are fixed; each bound fails a right sampler with another seed in at
// most one of 300 cases.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "populations/drawn.h"

namespace landfall {
namespace {

constexpr std::uint64_t kSeeds = 100;
constexpr std::uint64_t kFirstSeed = 20240607;
constexpr double kHectare_m2 = 1e4;

struct PopulationCase {
  std::string name;
  Population population;
  PopulationKind kind;
};

std::vector<PopulationCase> three_densities() {
  std::vector<PopulationCase> cases;
  for (const double k : {0.03, 0.05, 0.1})
    cases.push_back({"rocks of k " + std::to_string(k), {GolombekLaw{k}, {0.3, 3}}, kTestRocks});
  const PowerLaw rocks[] = {kLowBlockyRocks, kViperRocks, kHaworthRocks};
  for (const PowerLaw& law : rocks)
    cases.push_back({"rocks of exponent " + std::to_string(law.exponent), {law, {0.2, 5}}, kTestRocks});
  const SizeLaw craters[] = {kTraskCraters, ViperCraterLaw{}, PowerLaw{0.2, 2.9}};
  for (const SizeLaw& law : craters)
    cases.push_back({"craters of law " + std::to_string(law.index()), {law, {1.3, 40}}, kTestCraters});
  return cases;
}

/// The objects whose centre is on the site.
std::vector<ScatteredObject> inside(const PopulationCase& c, std::uint64_t seed) {
  std::vector<ScatteredObject> objects = drawn(c.population, hectare(seed), c.kind);
  std::erase_if(objects, [](const ScatteredObject& o) {
    return std::max(std::abs(o.point.x_m), std::abs(o.point.y_m)) > 50;
  });
  return objects;
}

double expected_count(const PopulationCase& c, const DiameterRange& range) {
  return kHectare_m2 *
         (density_per_m2(c.population.law, range.min_m) - density_per_m2(c.population.law, range.max_m));
}

TEST(PopulationStatistics, CountsArePoissonAtTheModelsDensity) {
  for (const PopulationCase& c : three_densities()) {
    const double expected = expected_count(c, c.population.diameters);
    double total = 0;
    double sum = 0;
    double squares = 0;
    int outside_3_sigma = 0;
    for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + kSeeds; ++seed) {
      const double count = static_cast<double>(inside(c, seed).size());
      const double z = (count - expected) / std::sqrt(expected);
      total += count;
      sum += z;
      squares += z * z;
      outside_3_sigma += std::abs(z) > 3 ? 1 : 0;
    }
    const double n = kSeeds;
    EXPECT_NEAR(total, n * expected, 3 * std::sqrt(n * expected)) << c.name;
    EXPECT_NEAR(sum / n, 0, 3 / std::sqrt(n)) << c.name;
    EXPECT_NEAR(squares / n, 1, 3 * std::sqrt(2 / n + 1 / (n * expected))) << c.name;
    EXPECT_LE(outside_3_sigma, 2) << c.name;
  }
}

/// Pearson's statistic of counts that are independent and Poisson.
double chi_square(const std::vector<double>& counts, const std::vector<double>& expected) {
  double sum = 0;
  for (std::size_t i = 0; i < counts.size(); ++i)
    sum += (counts[i] - expected[i]) * (counts[i] - expected[i]) / expected[i];
  return sum;
}

TEST(PopulationStatistics, SizesAreThoseOfTheModelInBins) {
  constexpr std::size_t kBins = 8;
  for (const PopulationCase& c : three_densities()) {
    const DiameterRange all = c.population.diameters;
    const auto edge = [&](std::size_t i) {
      return all.min_m * std::pow(all.max_m / all.min_m, static_cast<double>(i) / kBins);
    };
    std::vector<double> counts(kBins);
    std::vector<double> expected(kBins);
    for (std::size_t i = 0; i < kBins; ++i)
      expected[i] = static_cast<double>(kSeeds) * expected_count(c, {edge(i), edge(i + 1)});
    for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + kSeeds; ++seed)
      for (const ScatteredObject& o : inside(c, seed)) {
        ASSERT_TRUE(o.diameter_m >= all.min_m && o.diameter_m <= all.max_m);
        const double bin = std::log(o.diameter_m / all.min_m) / std::log(all.max_m / all.min_m) * kBins;
        counts[std::min(static_cast<std::size_t>(bin), kBins - 1)] += 1;
      }
    while (expected.back() < 10) {  // too few for the statistic: with the next larger bin
      expected[expected.size() - 2] += expected.back();
      counts[counts.size() - 2] += counts.back();
      expected.pop_back();
      counts.pop_back();
    }
    const double freedom = static_cast<double>(counts.size());
    EXPECT_LT(chi_square(counts, expected), freedom + 3.6 * std::sqrt(2 * freedom)) << c.name;
    EXPECT_GE(freedom, 4);
  }
}

/// Kolmogorov's statistic of samples whose distribution function is `share`, times the root of their number.
double kolmogorov(std::vector<double> samples, const std::function<double(double)>& share) {
  std::ranges::sort(samples);
  const double n = static_cast<double>(samples.size());
  double largest = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double f = share(samples[i]);
    largest = std::max({largest, f - static_cast<double>(i) / n, static_cast<double>(i + 1) / n - f});
  }
  return largest * std::sqrt(n);
}

constexpr double kKolmogorov = 1.83;  // exceeded in 1 of 400

TEST(PopulationStatistics, SizesAndPlacesFollowTheirDistributions) {
  for (const PopulationCase& c : three_densities()) {
    std::vector<double> sizes;
    std::vector<double> x;
    std::vector<double> y;
    std::vector<double> cells(25);
    for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + kSeeds; ++seed)
      for (const ScatteredObject& o : inside(c, seed)) {
        sizes.push_back(o.diameter_m);
        x.push_back(o.point.x_m);
        y.push_back(o.point.y_m);
        const auto cell = [](double place) {
          return std::min(static_cast<std::size_t>((place + 50) / 20), std::size_t{4});
        };
        cells[5 * cell(o.point.y_m) + cell(o.point.x_m)] += 1;
      }
    const double low = c.population.diameters.min_m;
    const double all = expected_count(c, c.population.diameters);
    EXPECT_LT(kolmogorov(sizes,
                         [&](double d) {
                           return expected_count(c, {low, d}) / all;
                         }),
              kKolmogorov)
        << c.name;
    const auto even = [](double place) { return (place + 50) / 100; };
    EXPECT_LT(kolmogorov(x, even), kKolmogorov) << c.name;
    EXPECT_LT(kolmogorov(y, even), kKolmogorov) << c.name;
    const std::vector<double> expected(25, static_cast<double>(kSeeds) * all / 25);
    EXPECT_LT(chi_square(cells, expected), 25 + 3.4 * std::sqrt(50)) << c.name;
  }
}

// N(>D) = c D^-2 on a square of side w, centres up to 0.75 D off it: the integral of
// (w + 1.5 D)^2 2 c D^-3 dD.
TEST(PopulationStatistics, CratersReachIntoTheSiteFromOutside) {
  const double a = 2;
  const double b = 60;
  const double c = kTraskCraters.coefficient;
  const double w = 100;
  const double expected =
      c * w * w * (1 / (a * a) - 1 / (b * b)) + 6 * c * w * (1 / a - 1 / b) + 4.5 * c * std::log(b / a);
  double total = 0;
  for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + kSeeds; ++seed)
    for (const ScatteredObject& o : drawn({kTraskCraters, {a, b}}, hectare(seed), kTestCraters)) {
      EXPECT_LE(std::max(std::abs(o.point.x_m), std::abs(o.point.y_m)), 50 + 0.75 * o.diameter_m);
      total += 1;
    }
  const double n = kSeeds;
  EXPECT_NEAR(total, n * expected, 3 * std::sqrt(n * expected));
}

TEST(PopulationStatistics, ARegionHasTheModelsDensity) {
  const Region regions[] = {RectangleRegion{{10, -5}, 30, 20}, AnnulusRegion{{-5, 5}, 0, 20},
                            AnnulusRegion{{0, 0}, 10, 30}};
  const double areas_m2[] = {600, 400 * std::numbers::pi, 800 * std::numbers::pi};
  for (std::size_t i = 0; i < 3; ++i) {
    const Population population{kHaworthRocks, {0.3, 3}, regions[i]};
    const double expected = static_cast<double>(kSeeds) * areas_m2[i] *
                            (kHaworthRocks.density_per_m2(0.3) - kHaworthRocks.density_per_m2(3));
    double total = 0;
    for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + kSeeds; ++seed)
      for (const ScatteredObject& o : drawn(population, hectare(seed))) {
        EXPECT_TRUE(contains(regions[i], o.point));
        total += 1;
      }
    EXPECT_NEAR(total, expected, 3 * std::sqrt(expected));
  }
}

}  // namespace
}  // namespace landfall
