// SPDX-License-Identifier: GPL-3.0-or-later
#include "hazards/denoise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/parallel.h"
#include "base/random.h"

namespace landfall {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

void add_noise(Grid<double>& z, double sigma, std::uint64_t seed) {
  const RandomField field(seed, RandomStream::range_noise);
  for (std::size_t i = 0; i < z.spec().size(); ++i) z.values()[i] += sigma * field.normal(i);
}

TEST(Denoise, SmoothGroundIsAveragedAndAnEdgeStays) {
  const GridSpec spec = GridSpec::centered(5, 0.05);
  const double sigma = 0.01;
  Grid<double> truth(spec);
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      const double x = spec.x(col);
      const double y = spec.y(row);
      truth.at({row, col}) = 0.3 * x - 0.2 * y + 0.05 * x * y + 0.1 * y * y + (x > 0.02 ? 1 : 0);
    }
  Grid<double> z = truth;
  add_noise(z, sigma, 3);
  const Grid<double> found = denoise(z, Grid<double>(spec, sigma));
  double smooth = 0;
  int count = 0;
  for (std::int64_t row = 10; row < spec.rows - 10; ++row)
    for (std::int64_t col = 10; col < spec.cols - 10; ++col) {
      const double from_step = std::abs(spec.x(col) - 0.025);
      if (from_step < 0.06) {
        EXPECT_NEAR(found.at({row, col}), z.at({row, col}), 0.1 * sigma);
      }
      if (from_step < 0.3) continue;
      smooth += std::pow(found.at({row, col}) - truth.at({row, col}), 2);
      ++count;
    }
  // The sum of the squared weights is 1 / (25 / 6.4 - 1): a bin and its surface have 0.19 of the variance
  // left, if the misfit is known; with 9 bins' estimate of it somewhat more.
  EXPECT_LT(std::sqrt(smooth / count), 0.6 * sigma);
}

TEST(Denoise, WhereABinIsMissingTheMapStays) {
  const GridSpec spec = GridSpec::centered(1, 0.1);
  Grid<double> z(spec);
  add_noise(z, 0.01, 5);
  z.at({10, 10}) = std::numeric_limits<double>::quiet_NaN();
  const Grid<double> found = denoise(z, Grid<double>(spec, 0.01));
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      const bool is_near = std::max(std::abs(row - 10), std::abs(col - 10)) <= 3;
      const bool is_border = std::min({row, col, 20 - row, 20 - col}) < 3;
      if (row == 10 && col == 10) continue;
      EXPECT_EQ(found.at({row, col}) == z.at({row, col}), is_near || is_border) << row << ' ' << col;
    }
}

// The mean over a bin, by a fine grid, of ground that is linear between the bins' centres along x and along
// y.
TEST(Sharpen, TurnsMeansOfBinsIntoTheGroundAtTheirCentres) {
  const GridSpec spec = GridSpec::centered(2, 0.1);
  Grid<double> ground(spec);
  Grid<double> means(spec);
  const auto height = [](double x, double y) { return 0.2 * x - 0.1 * y - 0.3 * x * x - 0.2 * y * y; };
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      const double x = spec.x(col);
      const double y = spec.y(row);
      ground.at({row, col}) = height(x, y);
      // Over half a bin to each side the mean of a linear piece is its value a quarter of a bin away.
      const double s = spec.resolution_m;
      const auto quarter = [&](double dx, double dy) {
        return 0.75 * height(x, y) + 0.25 * height(x + dx, y + dy);
      };
      means.at({row, col}) =
          (quarter(s, 0) + quarter(-s, 0)) / 2 + (quarter(0, s) + quarter(0, -s)) / 2 - height(x, y);
    }
  const Grid<double> found = sharpen(means, Grid<double>(spec, 1));
  for (std::int64_t row = 3; row < spec.rows - 3; ++row)
    for (std::int64_t col = 3; col < spec.cols - 3; ++col) {
      EXPECT_NEAR(found.at({row, col}), ground.at({row, col}), 1e-12);
      EXPECT_GT(std::abs(means.at({row, col}) - ground.at({row, col})), 1e-3);
    }
}

TEST(Sharpen, ChangesABinByNoMoreThanItsReliefAndNotBesideAMissingOne) {
  const GridSpec spec = GridSpec::centered(1, 0.1);
  Grid<double> z(spec);
  add_noise(z, 1, 7);
  z.at({10, 10}) = kNan;
  Grid<double> relief(spec, 0.01);
  relief.at({4, 4}) = 0;
  const Grid<double> found = sharpen(z, relief);
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      if (row == 10 && col == 10) continue;
      const double change = std::abs(found.at({row, col}) - z.at({row, col}));
      const bool is_near = std::abs(row - 10) + std::abs(col - 10) <= 3 &&
                           std::max(std::abs(row - 10), std::abs(col - 10)) <= 2;
      const bool is_border = std::min({row, col, 20 - row, 20 - col}) < 2;
      if (is_near || is_border || (row == 4 && col == 4))
        EXPECT_EQ(change, 0) << row << ' ' << col;
      else
        EXPECT_LE(change, 0.01 + 1e-12) << row << ' ' << col;
    }
  EXPECT_NEAR(std::abs(found.at({15, 5}) - z.at({15, 5})), 0.01, 1e-12);
}

TEST(SplitSigma, EqualSigmasAreNoise) {
  const GridSpec spec = GridSpec::centered(1, 0.1);
  const SigmaParts parts = split_sigma(Grid<double>(spec, 0.02), Footprint::square(3));
  for (std::size_t i = 0; i < spec.size(); ++i) {
    EXPECT_EQ(parts.noise_m.values()[i], 0.02);
    EXPECT_NEAR(parts.relief_m.values()[i], 0, 1e-9);
  }
}

TEST(SplitSigma, AFewLargeSigmasAreRelief) {
  const GridSpec spec = GridSpec::centered(1, 0.1);
  Grid<double> sigma(spec, 0.01);
  sigma.at({10, 10}) = 0.05;
  sigma.at({3, 3}) = 0;
  sigma.at({17, 3}) = kNan;
  const SigmaParts parts = split_sigma(sigma, Footprint::square(3));
  const double typical = 1 / ((48 / 1e-4 + 1 / 25e-4) / 49);
  EXPECT_NEAR(parts.noise_m.at({10, 10}), std::sqrt(1.3 * typical), 1e-12);
  EXPECT_NEAR(parts.relief_m.at({10, 10}), std::sqrt(25e-4 - typical), 1e-12);
  EXPECT_NEAR(parts.noise_m.at({10, 11}), 0.01, 1e-12);
  EXPECT_EQ(parts.relief_m.at({10, 11}), 0);
  EXPECT_EQ(parts.noise_m.at({3, 3}), 0);
  EXPECT_TRUE(std::isnan(parts.noise_m.at({17, 3})));
}

double at_or_nan(const Grid<double>& map, std::int64_t row, std::int64_t col) {
  const GridSpec& spec = map.spec();
  return row < 0 || col < 0 || row >= spec.rows || col >= spec.cols ? kNan : map.at({row, col});
}

/// Of the square of 2 reach + 1 bins, row by row.
template <class Value>
double sum_about(std::int64_t row, std::int64_t col, std::int64_t reach, const Value& value) {
  double sum = 0;
  for (std::int64_t r = row - reach; r <= row + reach; ++r)
    for (std::int64_t c = col - reach; c <= col + reach; ++c) sum += value(r, c);
  return sum;
}

/// Of a surface 1, x^2, y^2 through the 24 bins around; the other terms of the surface do not matter there.
double weight_of(std::int64_t r, std::int64_t c) {
  return r == 0 && c == 0 ? 0 : (270 - 50 * static_cast<double>(r * r + c * c)) / (24 * 270 - 50 * 100);
}

double slow_denoised(const Grid<double>& z, const Grid<double>& noise, std::int64_t row, std::int64_t col) {
  const auto around = [&](std::int64_t r, std::int64_t c, auto value) {
    return sum_about(r, c, 2, [&](std::int64_t i, std::int64_t k) {
      return i == r && k == c ? 0 : value(weight_of(i - r, k - c), i, k);
    });
  };
  const auto surface = [&](std::int64_t r, std::int64_t c) {
    return around(r, c, [&](double w, std::int64_t i, std::int64_t k) { return w * at_or_nan(z, i, k); });
  };
  const auto variance = [&](std::int64_t r, std::int64_t c) {
    return around(r, c, [&](double w, std::int64_t i, std::int64_t k) {
      return std::pow(w * at_or_nan(noise, i, k), 2);
    });
  };
  const double departure = sum_about(row, col, 1, [&](std::int64_t r, std::int64_t c) {
    return (std::pow(at_or_nan(z, r, c) - surface(r, c), 2) - variance(r, c) -
            std::pow(at_or_nan(noise, r, c), 2)) /
           9;
  });
  const double here = z.at({row, col});
  const double own = std::pow(noise.at({row, col}), 2);
  const double other = variance(row, col) + std::max(departure, 0.0);
  if (!std::isfinite(departure) || other <= 0) return here;
  return here + (surface(row, col) - here) * own / (own + other);
}

double slow_sharpened(const Grid<double>& z, const Grid<double>& relief, std::int64_t row, std::int64_t col) {
  const double curvature = sum_about(row, col, 1, [&](std::int64_t r, std::int64_t c) {
    return (at_or_nan(z, r + 1, c) + at_or_nan(z, r - 1, c) + at_or_nan(z, r, c + 1) +
            at_or_nan(z, r, c - 1) - 4 * at_or_nan(z, r, c)) /
           9;
  });
  const double most = relief.at({row, col});
  if (!std::isfinite(curvature)) return z.at({row, col});
  return z.at({row, col}) - std::clamp(curvature / 8, -most, most);
}

// More rows than one task takes; a missing elevation, a missing sigma, and bins without noise.
TEST(Denoise, EqualsItsDefinition) {
  const GridSpec spec{0.1, -8, -30, 71, 19};
  Grid<double> z(spec);
  Grid<double> noise(spec, 0.05);
  add_noise(z, 0.06, 11);
  add_noise(noise, 0.008, 12);
  z.at({20, 9}) = kNan;
  noise.at({45, 4}) = kNan;
  for (std::int64_t row = 58; row < 71; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col) noise.at({row, col}) = z.at({row, col}) = 0;
  const Grid<double> denoised = denoise(z, noise);
  const Grid<double> sharp = sharpen(z, noise);
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      if (std::isnan(z.at({row, col}))) continue;
      EXPECT_NEAR(denoised.at({row, col}), slow_denoised(z, noise, row, col), 1e-12) << row << ' ' << col;
      if (std::isnan(noise.at({row, col}))) continue;
      EXPECT_NEAR(sharp.at({row, col}), slow_sharpened(z, noise, row, col), 1e-12) << row << ' ' << col;
    }
}

// The window's mean counts the bins that have a precision.
TEST(SplitSigma, EqualsItsDefinition) {
  const GridSpec spec{0.1, -8, -20, 41, 17};
  Grid<double> sigma(spec, 0.02);
  add_noise(sigma, 0.004, 13);
  sigma.at({7, 7}) = 0;
  sigma.at({8, 7}) = kNan;
  const SigmaParts parts = split_sigma(sigma, Footprint::square(2));
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      const double here = sigma.at({row, col});
      if (!(here > 0)) continue;
      int count = 0;
      const double sum = sum_about(row, col, 2, [&](std::int64_t r, std::int64_t c) {
        const double value = at_or_nan(sigma, r, c);
        if (!(value > 0)) return 0.0;
        ++count;
        return 1 / (value * value);
      });
      EXPECT_NEAR(parts.noise_m.at({row, col}), std::min(here, std::sqrt(1.3 * count / sum)), 1e-12);
      EXPECT_NEAR(parts.relief_m.at({row, col}), std::sqrt(std::max(here * here - count / sum, 0.0)), 1e-9);
    }
}

TEST(Denoise, DoesNotDependOnTheNumberOfThreads) {
  const GridSpec spec = GridSpec::centered(5, 0.1);
  Grid<double> z(spec);
  add_noise(z, 0.1, 9);
  const Grid<double> sigma(spec, 0.05);
  const Grid<double> found = denoise(z, sigma);
  const Grid<double> sharp = sharpen(z, sigma);
  for (const std::size_t threads : {1U, 2U, 7U}) {
    const ThreadLimit limit(threads);
    EXPECT_TRUE(std::ranges::equal(denoise(z, sigma).values(), found.values()));
    EXPECT_TRUE(std::ranges::equal(sharpen(z, sigma).values(), sharp.values()));
  }
}

}  // namespace
}  // namespace landfall
