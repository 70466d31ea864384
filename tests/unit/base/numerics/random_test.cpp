// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/numerics/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

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

}  // namespace
}  // namespace landfall
