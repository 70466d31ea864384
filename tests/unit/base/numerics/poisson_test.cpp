// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/numerics/poisson.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "base/numerics/random.h"

namespace landfall {
namespace {

/// P(count <= n) for n = 0, 1, ..., until nothing is left.
std::vector<double> distribution(double mean) {
  std::vector<double> sums;
  double sum = 0;
  for (int n = 0; sum < 1 - 1e-15 && n < 10000; ++n) {
    sum += std::exp(n * std::log(mean) - mean - std::lgamma(n + 1.0));
    sums.push_back(sum);
  }
  return sums;
}

/// The standard normal value with this probability below it.
double normal_quantile(double p) {
  double low = -9;
  double high = 9;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (0.5 * std::erfc(-middle / std::numbers::sqrt2) < p ? low : high) = middle;
  }
  return low;
}

TEST(Poisson, InvertsTheDistribution) {
  for (const double mean : {0.01, 0.5, 3.0, 9.7, 15.9, 16.0, 40.0, 1000.0}) {
    const std::vector<double> sums = distribution(mean);
    constexpr int kDraws = 20000;
    int different = 0;
    for (int i = 0; i < kDraws; ++i) {
      const double u = (i + 0.5) / kDraws;
      std::size_t exact = 0;
      while (exact < sums.size() && sums[exact] <= u) ++exact;
      different += poisson_count(mean, {normal_quantile(u), u}) != static_cast<double>(exact) ? 1 : 0;
    }
    EXPECT_LE(different, mean < kLargePoissonMean ? 0 : kDraws / 2000) << mean;
  }
}

TEST(Poisson, NoMeanGivesNoCount) {
  EXPECT_EQ(poisson_count(0, {3, 0.999999}), 0);
  EXPECT_EQ(poisson_count(0, {3, 0}), 0);
}

TEST(Poisson, DrawsHaveTheMeanAndTheVariance) {
  const RandomField field(3, RandomStream::range_noise);
  for (const double mean : {0.3, 7.0, 16.0, 250.0}) {
    constexpr int kDraws = 200000;
    double sum = 0;
    double squares = 0;
    for (int i = 0; i < kDraws; ++i) {
      const double n = poisson_count(mean, {field.normal(1, static_cast<std::uint64_t>(i)),
                                            field.uniform(2, static_cast<std::uint64_t>(i))});
      sum += n - mean;
      squares += (n - mean) * (n - mean);
    }
    EXPECT_NEAR(sum / kDraws, 0, 4 * std::sqrt(mean / kDraws)) << mean;
    EXPECT_NEAR(squares / kDraws / mean, 1, 4 * std::sqrt((2 + 1 / mean) / kDraws)) << mean;
  }
}

}  // namespace
}  // namespace landfall
