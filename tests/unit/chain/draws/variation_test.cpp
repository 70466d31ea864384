// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/draws/variation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "constants.h"
#include "refusal.h"

namespace landfall {
namespace {

const std::string kVelocity = "scan.navigation_error.velocity_mps.";
const std::string kKey = kVelocity + "0";

/// The values of one key in the draws of a run.
template <class Kind>
std::vector<double> values(const Kind& kind, const std::string& key, std::size_t draws,
                           std::uint64_t seed = 1) {
  std::vector<double> out(draws);
  for (std::size_t draw = 0; draw < draws; ++draw)
    out[draw] = value<double>(Variation<double>(kind), key, {seed, static_cast<std::uint32_t>(draw)});
  return out;
}

// Computed by numpy's Philox with libxxhash's hash of the key (docs/reference/draws.md).
TEST(Variation, IsThePublishedDraw) {
  EXPECT_EQ(value(UniformVariation{0, 1}, kKey, 0), 0.2575718245877253);
  EXPECT_EQ(value(UniformVariation{0, 1}, kKey, 307), 0.9993061341675762);
  EXPECT_EQ(value(UniformVariation{0, 1}, "x", 1), 0.08482973420581463);
  EXPECT_NEAR(value(NormalVariation{0, 1}, kKey, 0), 0.7656002815075067, 1e-15);
  EXPECT_NEAR(value(NormalVariation{0, 1}, kKey, 307), -2.852369886184269, 2e-15);
  EXPECT_NEAR(value(NormalVariation{0, 1}, "x", 1), -0.1155097610706916, 1e-15);
}

TEST(Variation, ScalesItsDraw) {
  const double z = value(NormalVariation{0, 1}, kKey, 4);
  const double u = value(UniformVariation{0, 1}, kKey, 4);
  EXPECT_EQ(value(NormalVariation{3, 0.5}, kKey, 4), 3 + 0.5 * z);
  EXPECT_EQ(value(UniformVariation{-2, 6}, kKey, 4), -2 + 8 * u);
  EXPECT_EQ(value(NormalVariation{3, 0}, kKey, 4), 3);
  EXPECT_EQ(value(UniformVariation{3, 3}, kKey, 4), 3);
}

TEST(Variation, DependsOnSeedAndDraw) {
  const Variation<double> normal = NormalVariation{0, 1};
  EXPECT_NE(value(normal, kKey, {5, 7}), value(normal, kKey, {12, 0}));
  EXPECT_EQ(value(normal, kKey, {12, 7}), value(NormalVariation{0, 1}, kKey, {12, 7}));
  EXPECT_NE(value(normal, kKey, {5, 7}), value(normal, kKey, {5, 8}));
  EXPECT_NE(value(normal, kKey, {5, 7}), value(normal, kVelocity + "1", {5, 7}));
}

TEST(Variation, UniformStaysWithinItsEnds) {
  for (const UniformVariation ends :
       {UniformVariation{-1, 1 + 0x3p-52}, {1, 1 + 0x1p-52}, {0.1, 0.3}, {-0.3, -0.1}, {0, 0x1p-1074}})
    for (const double x : values(ends, kKey, 2000)) {
      ASSERT_GE(x, ends.low);
      ASSERT_LE(x, ends.high);
    }
}

using NumberOrText = std::variant<double, std::string>;  // as JSON

TEST(Variation, ListHasOneElementADraw) {
  const Variation<NumberOrText> list = ListVariation<NumberOrText>{{"paper", 2.5, "wide"}};
  EXPECT_EQ(value(list, kKey, {9, 0}), NumberOrText("paper"));
  EXPECT_EQ(value(list, kKey, {9, 1}), NumberOrText(2.5));
  EXPECT_EQ(value(list, kKey, {10, 2}), NumberOrText("wide"));
  EXPECT_EQ(value(Variation<NumberOrText>(NormalVariation{1, 2}), kKey, {9, 1}),
            NumberOrText(value(NormalVariation{1, 2}, kKey, {9, 1})));
  EXPECT_EQ(values(ListVariation<double>{{4, 5, 6}}, kKey, 3), (std::vector<double>{4, 5, 6}));
}

/// The largest distance between the values' distribution and `cdf`, times the root of their number.
template <class Cdf>
double kolmogorov(std::vector<double> x, const Cdf& cdf) {
  std::ranges::sort(x);
  const double n = static_cast<double>(x.size());
  double maximum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double below = static_cast<double>(i) / n;
    maximum = std::max({maximum, cdf(x[i]) - below, below + 1 / n - cdf(x[i])});
  }
  return maximum * std::sqrt(n);
}

double mean_power(const std::vector<double>& x, int power) {
  double sum = 0;
  for (const double v : x) sum += std::pow(v, power);
  return sum / static_cast<double>(x.size());
}

const std::array<std::string, 4> kKeys = {kKey, kVelocity + "1", "scan.noise.dropout_frac", ""};

TEST(Variation, NormalIsNormal) {
  constexpr std::size_t kDraws = 20000;
  const double root = std::sqrt(static_cast<double>(kDraws));
  for (const std::string& key : kKeys) {
    std::vector<double> z = values(NormalVariation{5, 0.25}, key, kDraws);
    for (double& v : z) v = (v - 5) / 0.25;
    EXPECT_NEAR(mean_power(z, 1), 0, 4 / root) << key;  // 4 standard errors
    EXPECT_NEAR(mean_power(z, 2), 1, 4 * std::sqrt(2.0) / root) << key;
    EXPECT_NEAR(mean_power(z, 3), 0, 4 * std::sqrt(15.0) / root) << key;
    EXPECT_NEAR(mean_power(z, 4), 3, 4 * std::sqrt(96.0) / root) << key;
    // 1.95 is exceeded by 1 in 1,000 samples.
    EXPECT_LT(kolmogorov(z, [](double v) { return std::erfc(-v / std::sqrt(2.0)) / 2; }), 1.95) << key;
  }
}

TEST(Variation, UniformIsUniform) {
  constexpr std::size_t kDraws = 20000;
  const double root = std::sqrt(static_cast<double>(kDraws));
  for (const std::string& key : kKeys) {
    std::vector<double> u = values(UniformVariation{-3, -1}, key, kDraws);
    for (double& v : u) v = (v + 3) / 2;
    EXPECT_NEAR(mean_power(u, 1), 0.5, 4 * std::sqrt(1 / 12.0) / root) << key;
    EXPECT_NEAR(mean_power(u, 2), 1 / 3.0, 4 * std::sqrt(4 / 45.0) / root) << key;
    EXPECT_LT(kolmogorov(u, [](double v) { return v; }), 1.95) << key;
  }
}

/// The pairs' chi-square in 10 x 10 classes.
double chi_square(const std::vector<double>& x, const std::vector<double>& y) {
  std::array<double, 100> count{};
  for (std::size_t i = 0; i < x.size(); ++i)
    ++count[10 * static_cast<std::size_t>(10 * x[i]) + static_cast<std::size_t>(10 * y[i])];
  const double expected = static_cast<double>(x.size()) / 100;
  double sum = 0;
  for (const double n : count) sum += (n - expected) * (n - expected) / expected;
  return sum;
}

// 149.5 is exceeded by 1 in 1,000 samples of 99 degrees of freedom.
TEST(Variation, KeysAreIndependent) {
  const UniformVariation unit{0, 1};
  for (std::size_t a = 0; a < kKeys.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      for (const std::uint64_t lag : {0U, 1U, 2U}) {
        const double chi = chi_square(values(unit, kKeys[a], 20000), values(unit, kKeys[b], 20000, 1 + lag));
        EXPECT_LT(chi, 149.5) << kKeys[a] << ' ' << kKeys[b] << ' ' << lag;
      }
}

TEST(Variation, DrawsAreIndependent) {
  const UniformVariation unit{0, 1};
  for (const std::string& key : kKeys)
    for (const std::uint64_t lag : {1U, 2U, 7U, 1024U})
      EXPECT_LT(chi_square(values(unit, key, 20000), values(unit, key, 20000, 1 + lag)), 149.5) << key << lag;
}

TEST(Variation, ManyKeysHaveManyValues) {
  std::set<double> seen;
  for (int i = 0; i < 5000; ++i) seen.insert(value(UniformVariation{0, 1}, "key." + std::to_string(i), 1));
  EXPECT_EQ(seen.size(), 5000U);
}

std::string refusal_of(const Variation<double>& variation, std::size_t draws = 3) {
  return refusal([&] { check(variation, "scan.noise.range_bias_m", draws); });
}

TEST(Variation, ParametersAreChecked) {
  constexpr double kMax = std::numeric_limits<double>::max();
  EXPECT_EQ(refusal_of(NormalVariation{-1, 0}), "accepted");
  EXPECT_EQ(refusal_of(NormalVariation{0, -0.5}),
            "vary/scan.noise.range_bias_m/sigma: -0.5 is not finite and >= 0");
  EXPECT_EQ(refusal_of(NormalVariation{kNan, 1}), "vary/scan.noise.range_bias_m/mean: nan is not finite");
  EXPECT_EQ(refusal_of(NormalVariation{0, kInfinity}),
            "vary/scan.noise.range_bias_m/sigma: inf is not finite and >= 0");
  EXPECT_EQ(refusal_of(UniformVariation{2, 2}), "accepted");
  EXPECT_EQ(refusal_of(UniformVariation{2, 1}),
            "vary/scan.noise.range_bias_m/high: 1 is not finite and >= low");
  EXPECT_EQ(refusal_of(UniformVariation{-kInfinity, 1}),
            "vary/scan.noise.range_bias_m/low: -inf is not finite");
  for (const UniformVariation bad : {UniformVariation{0, kNan}, {0, kInfinity}, {-kMax, kMax}})
    EXPECT_NE(refusal_of(bad), "accepted");
}

TEST(Variation, ListsHaveAValueForEachDraw) {
  EXPECT_EQ(refusal_of(ListVariation<double>{{1, 2, 3}}), "accepted");
  EXPECT_EQ(refusal_of(ListVariation<double>{{1, 2, 3, 4}}), "accepted");
  EXPECT_EQ(refusal_of(ListVariation<double>{{1, 2}}),
            "vary/scan.noise.range_bias_m/values: 2 values are fewer than the 3 draws");
  EXPECT_EQ(refusal_of(ListVariation<double>{}, 0), "accepted");
}

}  // namespace
}  // namespace landfall
