// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/numerics/box_muller.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace landfall {
namespace {

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
  hwy::SetSupportedTargetsForTest(0);
  std::vector<double> expected(in.u.size());
  box_muller(in.u, in.v, expected);
  int targets = 0;
  for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
    const std::int64_t target = rest & -rest;
    hwy::SetSupportedTargetsForTest(target);
    std::vector<double> out(in.u.size());
    box_muller(in.u, in.v, out);
    for (std::size_t i = 0; i < out.size(); ++i)
      ASSERT_EQ(std::bit_cast<std::uint64_t>(out[i]), std::bit_cast<std::uint64_t>(expected[i]))
          << hwy::TargetName(target) << ' ' << i;
    ++targets;
  }
  hwy::SetSupportedTargetsForTest(0);
  EXPECT_GE(targets, 1);
}

}  // namespace
}  // namespace landfall
