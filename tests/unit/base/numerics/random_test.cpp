// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "base/numerics/box_muller.h"
#include "base/numerics/philox.h"
#include "base/numerics/poisson.h"
#include "base/numerics/random.h"
#include "targets.h"

namespace landfall {
namespace {

// Known answer of Philox4x64-10 for an all-zero counter and key (Random123's own kat_vectors).
TEST(RandomField, IsPhilox4x64) {
  const r123::Philox4x64 philox;
  const auto words = philox({{0, 0, 0, 0}}, {{0, 0}});
  EXPECT_EQ(words[0], 0x16554d9eca36314cULL);
  EXPECT_EQ(words[1], 0xdb20fe9d672d0fdcULL);
}

TEST(RandomField, SameCoordinatesGiveSameDraw) {
  const RandomField field(7, RandomStream::range_noise);
  EXPECT_EQ(field.normal(3, 4), RandomField(7, RandomStream::range_noise).normal(3, 4));
  EXPECT_NE(field.normal(3, 4), field.normal(4, 3));
  EXPECT_NE(field.normal(3, 4), RandomField(8, RandomStream::range_noise).normal(3, 4));
  EXPECT_NE(field.uniform(3, 4), RandomField(7, RandomStream::dropout).uniform(3, 4));
}

// The draws are part of the files' reproducibility: on any machine, by any compiler, these bits.
TEST(RandomField, NormalBitsAreKept) {
  const RandomField field(7, RandomStream::range_noise);
  EXPECT_EQ(field.normal(3, 4), 0x1.ee66fc1816ebfp-2);
  EXPECT_EQ(field.normal(39999, 323), -0x1.e77ec5db4f962p-7);
}

// Computed by numpy's Philox with the draw as the third word of the counter.
TEST(RandomField, DrawIsAWordOfTheCounter) {
  EXPECT_EQ(RandomField({7, 5}, RandomStream::range_noise).uniform(3, 4), 0x1.df5238ace91a0p-4);
  EXPECT_EQ(RandomField({7, 2147483647}, RandomStream::range_noise).uniform(3, 4), 0x1.ec2ef7c23ccdcp-3);
  const RandomField field(7, RandomStream::range_noise);
  EXPECT_EQ(RandomField({7, 0}, RandomStream::range_noise).uniform(3, 4), field.uniform(3, 4));
}

TEST(RandomField, NoTwoSeedsAndDrawsBeginAlike) {
  std::vector<double> first;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed)
    for (std::uint32_t draw = 0; draw < 1000; ++draw)
      first.push_back(RandomField({seed, draw}, RandomStream::range_noise).uniform(0));
  std::ranges::sort(first);
  EXPECT_EQ(std::ranges::adjacent_find(first), first.end());
}

TEST(RandomField, ManyNormalsAreTheSingleOnes) {
  const RandomField field(7, RandomStream::range_noise);
  for (const std::size_t count : {0U, 1U, 7U, 8U, 9U, 256U, 324U, 700U}) {
    std::vector<double> many(count);
    field.normals(5, 11, many);
    for (std::size_t k = 0; k < count; ++k) ASSERT_EQ(many[k], field.normal(5, 11 + k)) << count << ' ' << k;
    field.normals_along_i(5, 11, many);
    for (std::size_t k = 0; k < count; ++k) ASSERT_EQ(many[k], field.normal(5 + k, 11)) << count << ' ' << k;
  }
}

// Against Random123, one block at a time, also where j passes the end of its word.
TEST(Philox, EveryInstructionSetGivesTheWordsOfTheGenerator) {
  const PhiloxRow row{
      .key = {{0xfedcba9876543210, 2}}, .i = 5, .first_j = ~std::uint64_t{0} - 100, .draw = 77};
  on_every_target([&] {
    for (const std::size_t count : {0U, 1U, 15U, 16U, 17U, 32U, 324U, 1000U}) {
      std::vector<double> first(count);
      std::vector<double> second(count);
      std::vector<double> alone(count);
      philox_uniforms(row, first, second);
      philox_uniforms(row, alone, {});
      for (std::size_t k = 0; k < count; ++k) {
        const auto words = r123::Philox4x64()({{row.i, row.first_j + k, row.draw, 0}}, row.key);
        ASSERT_EQ(first[k], static_cast<double>(words[0] >> 11U) * 0x1p-53) << count << ' ' << k;
        ASSERT_EQ(second[k], static_cast<double>(words[1] >> 11U) * 0x1p-53) << count << ' ' << k;
        ASSERT_EQ(alone[k], first[k]) << count << ' ' << k;
      }
    }
  });
}

TEST(RandomField, LessIsBelowTheLimit) {
  const RandomField field({7, 3}, RandomStream::dropout);
  std::vector<std::int8_t> found(600);
  for (const double limit : {0.0, field.uniform(5, 300), 0.25, 1.0}) {
    field.find_less(5, 11, limit, found);
    for (std::size_t k = 0; k < found.size(); ++k)
      ASSERT_EQ(found[k], field.uniform(5, 11 + k) < limit ? 1 : 0) << limit << ' ' << k;
  }
}

TEST(RandomField, UniformMomentsAndBounds) {
  const RandomField field(1, RandomStream::dropout);
  constexpr int kCount = 100000;
  double sum = 0;
  for (int i = 0; i < kCount; ++i) {
    const double u = field.uniform(static_cast<std::uint64_t>(i));
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
  }
  EXPECT_NEAR(sum / kCount, 0.5, 5 / std::sqrt(12.0 * kCount));  // 5 sigma of the mean
}

TEST(RandomField, NormalMoments) {
  const RandomField field(1, RandomStream::range_noise);
  constexpr int kCount = 200000;
  double sum = 0;
  double squares = 0;
  int within_one_sigma = 0;
  for (int i = 0; i < kCount; ++i) {
    const double v = field.normal(static_cast<std::uint64_t>(i), 17);
    sum += v;
    squares += v * v;
    within_one_sigma += std::abs(v) < 1 ? 1 : 0;
  }
  const double root = std::sqrt(static_cast<double>(kCount));
  EXPECT_NEAR(sum / kCount, 0, 5 / root);
  EXPECT_NEAR(squares / kCount, 1, 5 * std::sqrt(2.0) / root);
  EXPECT_NEAR(static_cast<double>(within_one_sigma) / kCount, 0.682689, 5 * 0.466 / root);
}

struct Uniforms {
  std::vector<double> u, v;
};

/// Multiples of 2^-53, with the ends of [0, 1) and the borders of the quadrants in front.
Uniforms uniforms(std::size_t count) {
  std::mt19937_64 random(4);
  Uniforms result;
  for (const double v : {0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1 - 0x1p-53, 0x1p-53})
    for (const double u : {0.0, 0x1p-53, 1 - 0x1p-53, 0.5, 1 - std::numbers::sqrt2 / 2}) {
      result.u.push_back(u);
      result.v.push_back(v);
    }
  while (result.u.size() < count) {
    result.u.push_back(static_cast<double>(random() >> 11U) * 0x1p-53);
    result.v.push_back(static_cast<double>(random() >> 11U) * 0x1p-53);
  }
  return result;
}

/// In long double, from the library's functions; the angle within an eighth of a turn, so that its cosine
/// keeps all digits near zero.
long double reference(double u, double v) {
  const double quarter = std::floor(4 * v + 0.5);
  const long double t = 2 * std::numbers::pi_v<long double> * static_cast<long double>(v - quarter / 4);
  const long double radius = std::sqrt(-2 * std::log(1 - static_cast<long double>(u)));
  if (quarter == 1) return radius * -std::sin(t);
  if (quarter == 2) return radius * -std::cos(t);
  if (quarter == 3) return radius * std::sin(t);
  return radius * std::cos(t);
}

double ulp(double value) {
  return std::nextafter(std::abs(value), std::numeric_limits<double>::infinity()) - std::abs(value);
}

TEST(BoxMuller, IsWithinTwoAndAHalfUlp) {
  const Uniforms in = uniforms(2000000);
  std::vector<double> out(in.u.size());
  box_muller(in.u, in.v, out);
  double worst = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const long double exact = reference(in.u[i], in.v[i]);
    const auto error = static_cast<double>(std::abs(static_cast<long double>(out[i]) - exact));
    const double relative = error / ulp(static_cast<double>(exact));
    ASSERT_LE(relative, 2.5) << in.u[i] << ' ' << in.v[i];
    worst = std::max(worst, relative);
  }
  RecordProperty("worst_ulp", std::to_string(worst));
}

TEST(BoxMuller, EveryInstructionSetGivesTheSameBits) {
  const Uniforms in = uniforms(100003);
  std::vector<double> expected(in.u.size());
  box_muller(in.u, in.v, expected);
  int targets = 0;
  on_every_target([&] {
    std::vector<double> out(in.u.size());
    box_muller(in.u, in.v, out);
    for (std::size_t i = 0; i < out.size(); ++i)
      ASSERT_EQ(std::bit_cast<std::uint64_t>(out[i]), std::bit_cast<std::uint64_t>(expected[i])) << i;
    ++targets;
  });
  EXPECT_GE(targets, 1);
}

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
