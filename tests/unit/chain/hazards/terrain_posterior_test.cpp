// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/terrain_posterior.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "base/core/parallel.h"
#include "base/numerics/random.h"
#include "bins.h"
#include "map_noise.h"

namespace landfall {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr double kNoise = 0.01;

/// A plane of 9 deg, 2000 m high.
Grid<double> plane(const GridSpec& spec) {
  return grid_of(
      spec, [](double x, double y) { return 2000 + std::tan(std::numbers::pi / 20) * (0.6 * x + 0.8 * y); });
}

/// Waves of all lengths; `fall` is the power of the length that their heights follow.
Grid<double> rough(const GridSpec& spec, double height, double fall) {
  const RandomField field(7, RandomStream::fractal);
  Grid<double> z(spec);
  for (std::uint64_t wave = 0; wave < 60; ++wave) {
    const double length = 6 * std::pow(0.93, static_cast<double>(wave));
    const double angle = 2 * std::numbers::pi * field.uniform(2 * wave);
    const double phase = 2 * std::numbers::pi * field.uniform(2 * wave + 1);
    for (const auto [row, col] : bins_of(spec))
      z.at({row, col}) += height * std::pow(length / 6, fall) *
                          std::sin(2 * std::numbers::pi / length *
                                       (std::cos(angle) * spec.x(col) + std::sin(angle) * spec.y(row)) +
                                   phase);
  }
  return z;
}

/// The rms of the differences, less their mean, more than 1 m from the border.
double rms(const Grid<double>& a, const Grid<double>& b) {
  const GridSpec& spec = a.spec();
  double sum = 0;
  double square = 0;
  int count = 0;
  for (const auto [row, col] : Bins({20, 20}, {spec.rows - 20, spec.cols - 20})) {
    const double off = a.at({row, col}) - b.at({row, col});
    sum += off;
    square += off * off;
    ++count;
  }
  return std::sqrt(square / count - std::pow(sum / count, 2));
}

TEST(TerrainPosterior, APlaneIsAPlane) {
  const GridSpec spec = GridSpec::centered(5, 0.05);
  const Grid<double> truth = plane(spec);
  Grid<double> z = truth;
  add_noise(z, kNoise, 3);
  const Grid<double> terrain = TerrainPosterior(z, noise_of(spec, kNoise).noise_m, 1).draw(0);
  EXPECT_LT(rms(terrain, truth), 0.15 * kNoise);
}

// A draw is as far from the truth as from another draw: all come from one distribution.
TEST(TerrainPosterior, RoughGroundIsOneOfItsDraws) {
  const GridSpec spec = GridSpec::centered(5, 0.05);
  const Grid<double> truth = rough(spec, 0.05, 0.8);
  Grid<double> z = truth;
  add_noise(z, kNoise, 4);
  const TerrainPosterior posterior(z, noise_of(spec, kNoise).noise_m, 1);
  const Grid<double> first = posterior.draw(0);
  const double between = rms(first, posterior.draw(1));
  const double off = rms(first, truth);
  EXPECT_GT(between, 0.5 * kNoise);
  EXPECT_LT(off, 1.2 * kNoise);
  EXPECT_NEAR(off / between, 1, 0.2);
}

// Returns that lie off the centres alike in neighbouring bins, by up to 7 mm: on the slope that is no relief.
TEST(TerrainPosterior, ThePlacesOfReturnsAreNoReliefOfASlope) {
  const GridSpec spec = GridSpec::centered(5, 0.05);
  const Grid<double> truth = plane(spec);
  Grid<double> z = truth;
  ReturnCentroids centroids{Grid<float>(spec), Grid<float>(spec)};
  for (const auto [row, col] : bins_of(spec)) {
    const double off =
        0.007 * std::sin(2.0 * static_cast<double>(col)) * std::sin(1.5 * static_cast<double>(row));
    centroids.x.at({row, col}) = static_cast<float>(spec.x(col) + off);
    centroids.y.at({row, col}) = static_cast<float>(spec.y(row) - 2 * off);
    z.at({row, col}) += std::tan(std::numbers::pi / 20) * (0.6 - 2 * 0.8) * off;
  }
  const SigmaParts noise = noise_of(spec, 1e-5);
  EXPECT_GT(rms(TerrainPosterior(z, noise.noise_m, 1).draw(0), truth), 3e-4);
  EXPECT_LT(rms(TerrainPosterior(z, noise.noise_m, 1, centroids).draw(0), truth), 1e-4);
}

// On smooth ground the centre of a bin is that of the ground whose means the bins are.
TEST(TerrainPosterior, APointIsNotTheMeanOfItsBin) {
  const GridSpec spec = GridSpec::centered(4, 0.1);
  Grid<double> means(spec);
  Grid<double> truth(spec);
  const double side = std::sin(std::numbers::pi * 0.1 / 2) / (std::numbers::pi * 0.1 / 2);
  for (const auto [row, col] : bins_of(spec)) {
    truth.at({row, col}) =
        std::cos(std::numbers::pi * spec.x(col)) * std::cos(std::numbers::pi * spec.y(row));
    means.at({row, col}) = side * side * truth.at({row, col});
  }
  EXPECT_GT(rms(means, truth), 0.003);
  EXPECT_LT(rms(TerrainPosterior(means, noise_of(spec, 1e-5).noise_m, 1).draw(0), truth), 2e-4);
}

// Also without noise the ground departs from what the means tell, on rough terrain.
TEST(TerrainPosterior, ReliefWithinBinsFollowsFromReliefBetweenThem) {
  const GridSpec spec = GridSpec::centered(3, 0.05);
  const auto spread = [&](const Grid<double>& z) {
    const TerrainPosterior posterior(z, noise_of(spec, 1e-6).noise_m, 1);
    return rms(posterior.draw(0), posterior.draw(1));
  };
  EXPECT_LT(spread(plane(spec)), 1e-5);
  EXPECT_GT(spread(rough(spec, 0.08, 0.4)), 0.01);
  EXPECT_GT(spread(rough(spec, 0.08, 0.4)), 3 * spread(rough(spec, 0.08, 0.8)));
}

// Ground that was not measured is as rough as the ground around.
TEST(TerrainPosterior, AHoleHasTheReliefAround) {
  const GridSpec spec = GridSpec::centered(5, 0.05);
  const auto spread_in_hole = [&](Grid<double> z) {
    add_noise(z, kNoise, 6);
    SigmaParts parts = noise_of(spec, kNoise);
    for (const auto [row, col] : Bins({95, 95}, {106, 106})) {
      parts.noise_m.at({row, col}) = kUnknown;
      z.at({row, col}) = 777;  // does not count
    }
    const TerrainPosterior posterior(z, parts.noise_m, 1);
    double square = 0;
    for (std::uint64_t k = 0; k < 8; ++k)
      square +=
          std::pow(posterior.draw(2 * k).at({100, 100}) - posterior.draw(2 * k + 1).at({100, 100}), 2) / 16;
    return std::sqrt(square);
  };
  EXPECT_LT(spread_in_hole(plane(spec)), 0.3 * kNoise);
  EXPECT_GT(spread_in_hole(rough(spec, 0.08, 0.4)), kNoise);
}

TEST(TerrainPosterior, ThinMapOfAPlane) {
  const GridSpec spec = GridSpec::centered(5, 0.05);
  const Grid<double> truth = plane(spec);
  Grid<double> z = truth;
  add_noise(z, kNoise, 8);
  SigmaParts parts = noise_of(spec, kNoise);
  const RandomField field(9, RandomStream::dropout);
  for (std::size_t i = 0; i < spec.size(); ++i)
    if (field.uniform(i) < 0.25) parts.noise_m.values()[i] = kUnknown;
  EXPECT_LT(rms(TerrainPosterior(z, parts.noise_m, 1).draw(0), truth), 0.25 * kNoise);
}

TEST(TerrainPosterior, FarFromAnyReturnThereIsNone) {
  const GridSpec spec = GridSpec::centered(5, 0.05);
  SigmaParts parts = noise_of(spec, kUnknown);
  for (const BinIndex bin : Bins({0, 0}, {20, spec.cols})) parts.noise_m.at(bin) = 0.01F;
  const Grid<double> terrain = TerrainPosterior(plane(spec), parts.noise_m, 1).draw(0);
  EXPECT_TRUE(std::isfinite(terrain.at({60, 100})));
  EXPECT_TRUE(std::isnan(terrain.at({100, 100})));
}

// A wall of 1 m: beside it the ground of each side is even, but for the step that the means have at once.
TEST(TerrainPosterior, BesideAWallTheGroundIsEven) {
  const GridSpec spec = GridSpec::centered(4, 0.05);
  Grid<double> z(spec);
  for (const BinIndex bin : Bins({0, 80}, {spec.rows, spec.cols})) z.at(bin) = 1;
  add_noise(z, 0.001, 10);
  ReturnCentroids centroids{Grid<float>(spec), Grid<float>(spec)};
  for (const auto [row, col] : bins_of(spec)) {
    centroids.x.at({row, col}) = static_cast<float>(spec.x(col) + 0.02);
    centroids.y.at({row, col}) = static_cast<float>(spec.y(row) - 0.02);
  }
  for (const std::optional<ReturnCentroids>& places :
       {std::optional<ReturnCentroids>{}, std::optional{centroids}}) {
    const Grid<double> terrain = TerrainPosterior(z, noise_of(spec, 0.001).noise_m, 1, places).draw(0);
    for (const auto [row, col] : Bins({20, 20}, {spec.rows - 20, spec.cols - 20}))
      ASSERT_NEAR(terrain.at({row, col}),
                  (col < 80 ? 0 : 1) + (col == 79   ? -1.0
                                        : col == 80 ? 1.0
                                                    : 0.0) /
                                           24,
                  0.02)
          << row << ", " << col;
  }
}

// The same bins of a larger map: equal bits as far from the smaller map's border as a draw reaches.
TEST(TerrainPosterior, DependsOnNoMoreThanItsReach) {
  const double resolution_m = 0.2;
  const std::int64_t reach = TerrainPosterior::reach_bins(resolution_m);
  const std::int64_t inner = reach + 6;
  const GridSpec large{resolution_m, -2 * inner, -2 * inner, 4 * inner + 1, 4 * inner + 1};
  const GridSpec small{resolution_m, -inner, -inner, 2 * inner + 1, 2 * inner + 1};
  Grid<double> z = rough(large, 0.08, 0.6);
  add_noise(z, kNoise, 11);
  SigmaParts parts = noise_of(large, kNoise);
  const RandomField field(12, RandomStream::dropout);
  for (std::size_t i = 0; i < large.size(); ++i)
    if (field.uniform(i) < 0.2) parts.noise_m.values()[i] = kUnknown;
  Grid<double> cut(small);
  SigmaParts cut_parts = noise_of(small, kNoise);
  for (const auto [row, col] : bins_of(small)) {
    cut.at({row, col}) = z.at({row + inner, col + inner});
    cut_parts.noise_m.at({row, col}) = parts.noise_m.at({row + inner, col + inner});
  }
  const Grid<double> whole = TerrainPosterior(z, parts.noise_m, 3).draw(5);
  const Grid<double> part = TerrainPosterior(cut, cut_parts.noise_m, 3).draw(5);
  for (const auto [row, col] : Bins({reach, reach}, {small.rows - reach, small.cols - reach}))
    ASSERT_NEAR(part.at({row, col}), whole.at({row + inner, col + inner}), 1e-6) << row << ", " << col;
  for (const double s : {0.025, 0.05, 0.1, 0.2, 0.4})
    EXPECT_LE(static_cast<double>(TerrainPosterior::reach_bins(s)) * s, 15) << s;
}

TEST(TerrainPosterior, DoesNotDependOnTheNumberOfThreads) {
  const GridSpec spec = GridSpec::centered(3, 0.05);
  Grid<double> z = rough(spec, 0.05, 0.6);
  add_noise(z, kNoise, 13);
  const Grid<double> found = TerrainPosterior(z, noise_of(spec, kNoise).noise_m, 1).draw(2);
  for (const std::size_t threads : {1U, 2U, 7U}) {
    const ThreadLimit limit(threads);
    EXPECT_TRUE(std::ranges::equal(TerrainPosterior(z, noise_of(spec, kNoise).noise_m, 1).draw(2).values(),
                                   found.values()));
  }
  EXPECT_NE(TerrainPosterior(z, noise_of(spec, kNoise).noise_m, 2).draw(2).at({60, 60}), found.at({60, 60}));
}

}  // namespace
}  // namespace landfall
