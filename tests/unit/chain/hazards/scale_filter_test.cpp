// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/scale_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "base/core/parallel.h"
#include "base/numerics/random.h"

namespace landfall {
namespace {

constexpr std::array<double, 11> kLowPass = {3, 0, -25, 0, 150, 256, 150, 0, -25, 0, 3};
constexpr std::array<double, 5> kBlur = {1, 4, 6, 4, 1};

Grid<double> noise(const GridSpec& spec) {
  const RandomField field(5, RandomStream::range_noise);
  Grid<double> map(spec);
  for (std::size_t i = 0; i < spec.size(); ++i) map.values()[i] = field.normal(i);
  return map;
}

/// A value of the map continued by point reflection, first along y, then along x.
double reflected(const Grid<double>& map, std::int64_t row, std::int64_t col) {
  const GridSpec& spec = map.spec();
  const auto mirrored = [](std::int64_t i, std::int64_t count) {
    return std::clamp<std::int64_t>(i < 0 ? -i : 2 * (count - 1) - i, 0, count - 1);
  };
  if (row < 0 || row >= spec.rows) {
    const std::int64_t edge = row < 0 ? 0 : spec.rows - 1;
    return 2 * reflected(map, edge, col) - reflected(map, mirrored(row, spec.rows), col);
  }
  if (col < 0 || col >= spec.cols) {
    const std::int64_t edge = col < 0 ? 0 : spec.cols - 1;
    return 2 * map.at({row, edge}) - map.at({row, mirrored(col, spec.cols)});
  }
  return map.at({row, col});
}

TEST(LowPass, EqualsItsDefinition) {
  const Grid<double> map = noise({0.1, -9, -7, 23, 19});
  for (const std::int64_t step : {1, 2, 8}) {  // at 8 the taps reach beyond the mirrored map
    const Grid<double> found = low_pass(map, step);
    for (std::int64_t row = 0; row < 23; ++row)
      for (std::int64_t col = 0; col < 19; ++col) {
        double sum = 0;
        for (std::int64_t r = -5; r <= 5; ++r)
          for (std::int64_t c = -5; c <= 5; ++c)
            sum += kLowPass[static_cast<std::size_t>(r + 5)] * kLowPass[static_cast<std::size_t>(c + 5)] /
                   (512.0 * 512) * reflected(map, row + r * step, col + c * step);
        ASSERT_NEAR(found.at({row, col}), sum, 1e-12) << step << ": " << row << ", " << col;
      }
  }
}

TEST(LowPass, KeepsAPlaneAndInsideAQuintic) {
  const GridSpec spec{0.1, -40, -40, 81, 81};
  Grid<double> plane(spec);
  Grid<double> quintic(spec);
  for (std::int64_t row = 0; row < 81; ++row)
    for (std::int64_t col = 0; col < 81; ++col) {
      plane.at({row, col}) = 3 + 0.2 * spec.x(col) - 0.1 * spec.y(row);
      quintic.at({row, col}) = std::pow(spec.x(col), 5) - std::pow(spec.y(row), 4) * spec.x(col);
    }
  const Grid<double> same = low_pass(plane, 4);
  const Grid<double> inside = low_pass(quintic, 2);
  for (std::int64_t row = 0; row < 81; ++row)
    for (std::int64_t col = 0; col < 81; ++col) {
      ASSERT_NEAR(same.at({row, col}), plane.at({row, col}), 1e-12);
      if (std::min({row, col, 80 - row, 80 - col}) < 10) continue;
      ASSERT_NEAR(inside.at({row, col}), quintic.at({row, col}), 1e-9);
    }
}

TEST(Blur, EqualsItsDefinition) {
  const Grid<double> map = noise({0.1, 4, -7, 13, 17});
  Grid<float> narrow(map.spec());
  std::ranges::transform(map.values(), narrow.values().begin(),
                         [](double v) { return static_cast<float>(v); });
  for (const std::int64_t step : {1, 4}) {
    const Grid<float> found = blur(narrow, step);
    for (std::int64_t row = 0; row < 13; ++row)
      for (std::int64_t col = 0; col < 17; ++col) {
        double sum = 0;
        for (std::int64_t r = -2; r <= 2; ++r)
          for (std::int64_t c = -2; c <= 2; ++c)
            sum += kBlur[static_cast<std::size_t>(r + 2)] * kBlur[static_cast<std::size_t>(c + 2)] / 256 *
                   map.at({std::clamp<std::int64_t>(row + r * step, 0, 12),
                           std::clamp<std::int64_t>(col + c * step, 0, 16)});
        ASSERT_NEAR(found.at({row, col}), sum, 1e-6) << step << ": " << row << ", " << col;
      }
  }
}

// The root of the sum of the squared response to a single bin.
TEST(NoiseGains, AreThoseOfAnImpulse) {
  const GridSpec spec{0.1, -80, -80, 161, 161};
  Grid<double> map(spec);
  map.at({80, 80}) = 1;
  const NoiseGains gains = noise_gains(3);
  const auto norm = [](const Grid<double>& values) {
    double sum = 0;
    for (const double value : values.values()) sum += value * value;
    return std::sqrt(sum);
  };
  for (std::int64_t j = 0; j < 3; ++j) {
    const Grid<double> smooth = low_pass(map, std::int64_t{1} << j);
    Grid<double> detail = map;
    for (std::size_t i = 0; i < spec.size(); ++i) detail.values()[i] -= smooth.values()[i];
    EXPECT_NEAR(gains.detail.at(static_cast<std::size_t>(j)), norm(detail), 1e-12);
    map = smooth;
  }
  EXPECT_NEAR(gains.rest, norm(map), 1e-12);
}

TEST(LowPass, DoesNotDependOnTheNumberOfThreads) {
  const Grid<double> map = noise({0.1, 0, 0, 70, 50});
  const Grid<double> found = low_pass(map, 2);
  for (const std::size_t threads : {1U, 2U, 7U}) {
    const ThreadLimit limit(threads);
    EXPECT_TRUE(std::ranges::equal(low_pass(map, 2).values(), found.values()));
  }
}

}  // namespace
}  // namespace landfall
