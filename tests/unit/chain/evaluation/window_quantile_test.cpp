// SPDX-License-Identifier: GPL-3.0-or-later
// The shared tails of neighbouring windows (Eq. 12) against a selection in each window, to the last bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "base/core/parallel.h"
#include "base/numerics/random.h"
#include "base/raster/masks.h"
#include "base/raster/window_mean.h"
#include "bins.h"
#include "chain/evaluation/quantile/window_quantile.h"
#include "constants.h"

namespace landfall {
namespace {

constexpr GridSpec kSpec{0.05, -60, -45, 96, 121};

std::size_t different_bits(const Grid<double>& a, const Grid<double>& b) {
  if (a.spec() != b.spec()) return std::max(a.spec().size(), b.spec().size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.spec().size(); ++i)
    count +=
        std::bit_cast<std::uint64_t>(a.values()[i]) != std::bit_cast<std::uint64_t>(b.values()[i]) ? 1U : 0U;
  return count;
}

/// Blocks of every size with one and two threads.
void expect_exact(const Grid<double>& error, const BinMask& region, const Footprint& footprint, double q) {
  const WindowMeans windows = window_means(error, footprint);
  const WindowQuantileInput input{
      .error = error, .windows = windows, .footprint = footprint, .region = region, .quantile = q};
  const Grid<double> naive = window_quantile_naive(input);
  for (const std::int64_t edge : {4, 16, 32, 64}) {
    for (const std::size_t threads : {1U, 2U}) {
      const ThreadLimit limit(threads);
      EXPECT_EQ(different_bits(window_quantile(input, {}, {edge, edge}), naive), 0U)
          << (footprint.is_square() ? "square" : "disc") << ", half " << footprint.half_bins()
          << ", quantile " << q << ", tiles of " << edge << ", " << threads << " threads";
    }
  }
}

/// The square of 2 half + 1 bins, and the disc of that diameter.
void expect_exact(const Grid<double>& error, const BinMask& region, std::int64_t half, double q) {
  expect_exact(error, region, Footprint::square(half), q);
  expect_exact(error, region, Footprint::disc(half * half + half / 2), q);
}

void expect_exact(const Grid<double>& error, std::int64_t half = 8, double q = 0.95) {
  expect_exact(error, BinMask(error.spec(), 1), half, q);
}

template <class ErrorAt>
Grid<double> grid_from(const GridSpec& spec, ErrorAt error_at) {
  Grid<double> grid(spec);
  for (const BinIndex bin : bins_of(spec)) grid.at(bin) = error_at(bin);
  return grid;
}

/// Chance values of one bin.
class RandomValues {
 public:
  explicit RandomValues(std::uint64_t seed)
      : normal_(seed, RandomStream::range_noise), uniform_(seed, RandomStream::dropout) {}

  [[nodiscard]] double normal(BinIndex bin) const {
    return normal_.normal(static_cast<std::uint64_t>(bin.row), static_cast<std::uint64_t>(bin.col));
  }
  [[nodiscard]] double uniform(BinIndex bin) const {
    return uniform_.uniform(static_cast<std::uint64_t>(bin.row), static_cast<std::uint64_t>(bin.col));
  }

 private:
  RandomField normal_;
  RandomField uniform_;
};

Grid<double> noise(const GridSpec& spec, double nan_frac, std::uint64_t seed = 5) {
  const RandomValues random(seed);
  return grid_from(spec, [&](BinIndex bin) {
    return random.uniform(bin) < nan_frac ? kNan : 0.0333 * random.normal(bin);
  });
}

/// Six cones on a plane: no error on the plane, on a flank the slope times a place within the bin.
Grid<double> cones(const GridSpec& spec, double sigma_m) {
  const RandomValues random(7);
  return grid_from(spec, [&](BinIndex bin) {
    bool on_cone = false;
    for (int i = 0; i < 6; ++i)
      on_cone = on_cone || std::hypot(static_cast<double>(bin.row - 16 * i),
                                      static_cast<double>(bin.col - 37 * i % 121)) < 13;
    return (on_cone ? 0.165 * (random.uniform(bin) - 0.5) : 0.0) + sigma_m * random.normal(bin);
  });
}

/// Relief seen with a velocity error: long waves, a trend along the scan, and little noise.
Grid<double> relief(const GridSpec& spec, double sigma_m) {
  const RandomValues random(9);
  return grid_from(spec, [&](BinIndex bin) {
    const auto x = static_cast<double>(bin.col);
    const auto y = static_cast<double>(bin.row);
    double error = 0.004 * y + sigma_m * random.normal(bin);
    for (const double wave : {0.05, 0.12, 0.31})
      error += 0.004 / wave * std::sin(wave * x + 1) * std::sin(wave * y - 2);
    return error;
  });
}

// As the cases below, in a hundredth of their time.
TEST(WindowQuantileExact, SmallMaps) {
  constexpr GridSpec spec{0.1, -7, -9, 21, 26};
  const BinMask spots = testing_masks::random_mask(spec, 0.15, 8);
  for (const double q : {0.4, 0.95}) {
    expect_exact(noise(spec, 0.1), 5, q);
    expect_exact(noise(spec, 0.97), 2, q);
    expect_exact(relief(spec, 0.001), 2, q);
    expect_exact(cones(spec, 0), 2, q);
    expect_exact(cones(spec, 0.002), spots, 5, q);
  }
  for (const double q : {0.0, 1.0}) expect_exact(noise(spec, 0.1), 2, q);
  Grid<double> spike = noise(spec, 0.1);
  spike.at({10, 12}) = -1e6;
  expect_exact(spike, 3);
  expect_exact(Grid<double>(spec, 0.1), 3);
}

TEST(WindowQuantileExact, NoiseWithHoles) { expect_exact(noise(kSpec, 0.04)); }

TEST(WindowQuantileExact, TheFootprintOfThePaper) { expect_exact(noise(kSpec, 0.04), 17); }

TEST(WindowQuantileExact, ConesWithoutNoise) { expect_exact(cones(kSpec, 0)); }

TEST(WindowQuantileExact, ConesWithNoise) { expect_exact(cones(kSpec, 0.002)); }

TEST(WindowQuantileExact, ReliefWithVelocityBias) {
  expect_exact(relief(kSpec, 0));
  expect_exact(relief(kSpec, 0.002));
}

TEST(WindowQuantileExact, AllEqual) {
  expect_exact(Grid<double>(kSpec, 0));
  expect_exact(Grid<double>(kSpec, 0.1));  // the mean is rounded: deviations of about 1e-17
  Grid<double> with_holes = noise(kSpec, 0.3);
  for (double& e : with_holes.values()) e = std::isnan(e) ? kNan : -0.1;
  expect_exact(with_holes);
}

TEST(WindowQuantileExact, BothZeros) {
  const RandomValues random(3);
  expect_exact(grid_from(kSpec, [&](BinIndex bin) { return random.uniform(bin) < 0.5 ? 0.0 : -0.0; }));
}

TEST(WindowQuantileExact, FewDistinctValues) {
  const RandomValues random(3);
  expect_exact(grid_from(kSpec, [&](BinIndex bin) { return std::floor(3 * random.uniform(bin)); }));
  expect_exact(grid_from(kSpec, [&](BinIndex bin) { return random.uniform(bin) < 0.97 ? 0.0 : 1.0; }));
}

TEST(WindowQuantileExact, NoValidBin) { expect_exact(Grid<double>(kSpec, kNan)); }

TEST(WindowQuantileExact, OneValidBin) {
  Grid<double> error(kSpec, kNan);
  error.at({40, 77}) = 0.25;
  expect_exact(error);
}

TEST(WindowQuantileExact, FewValidBins) { expect_exact(noise(kSpec, 0.99)); }

TEST(WindowQuantileExact, OneLargeErrorAmongSmall) {
  Grid<double> error = noise(kSpec, 0);
  error.at({48, 60}) = 1e6;
  expect_exact(error);
}

TEST(WindowQuantileExact, SumsThatOverflow) {
  Grid<double> error = noise({1, 0, 0, 20, 24}, 0.1);
  for (double& e : error.values()) e *= 0x1p1023;
  expect_exact(error, 3);
}

TEST(WindowQuantileExact, StripsOneBinWide) {
  for (const std::int64_t half : {0, 1, 17, 500}) {
    expect_exact(noise({1, 0, 0, 1, 300}, 0.04), half);
    expect_exact(noise({1, 0, 0, 300, 1}, 0.04), half);
    expect_exact(noise({1, 0, 0, 1, 1}, 0), half);
  }
}

TEST(WindowQuantileExact, BordersOfRegions) {
  const Grid<double> error = cones(kSpec, 0.002);
  expect_exact(error, circular_region(kSpec, 1.8), 8, 0.95);
  expect_exact(error, testing_masks::random_mask(kSpec, 0.02, 4), 8, 0.95);
  expect_exact(error, BinMask(kSpec, 0), 8, 0.95);
  BinMask corner(kSpec);
  corner.at({95, 120}) = 1;
  expect_exact(error, corner, 8, 0.95);
}

TEST(WindowQuantileExact, EveryQuantile) {
  for (const double q : {0.0, 1e-9, 0.05, 0.5, 0.7, 0.9, 0.999, 1.0}) {
    expect_exact(noise({1, 0, 0, 50, 61}, 0.04), 4, q);
    expect_exact(cones({1, 0, 0, 50, 61}, 0), 4, q);
  }
}

TEST(WindowQuantileExact, RandomFootprintsAndQuantiles) {
  const RandomField draw(2024, RandomStream::fractal);
  for (std::uint64_t i = 0; i < 24; ++i) {
    const GridSpec spec{1, -3, 8, 1 + static_cast<std::int64_t>(70 * draw.uniform(i, 0)),
                        1 + static_cast<std::int64_t>(90 * draw.uniform(i, 1))};
    const auto half = static_cast<std::int64_t>(14 * draw.uniform(i, 2));
    const Grid<double> error = i % 3 == 0   ? noise(spec, draw.uniform(i, 3), i)
                               : i % 3 == 1 ? cones(spec, 0.01 * draw.uniform(i, 3))
                                            : relief(spec, 0.01 * draw.uniform(i, 3));
    expect_exact(error, testing_masks::random_mask(spec, draw.uniform(i, 4), i), half, draw.uniform(i, 5));
  }
}

TEST(WindowQuantileExact, ProgressRisesToOne) {
  const Grid<double> error = noise({1, 0, 0, 40, 5}, 0);
  const Footprint footprint = Footprint::square(1);
  const WindowMeans windows = window_means(error, footprint);
  const BinMask everywhere(error.spec(), 1);
  std::vector<double> fractions;
  static_cast<void>(window_quantile(
      {.error = error, .windows = windows, .footprint = footprint, .region = everywhere, .quantile = 0.5},
      [&](double f) { fractions.push_back(f); }));
  EXPECT_EQ(fractions.size(), 2U);
  EXPECT_TRUE(std::ranges::is_sorted(fractions));
  EXPECT_EQ(fractions.back(), 1);
}

}  // namespace
}  // namespace landfall
