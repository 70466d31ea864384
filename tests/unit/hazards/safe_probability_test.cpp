// SPDX-License-Identifier: GPL-3.0-or-later
#include "hazards/safe_probability.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/random.h"

namespace landfall {
namespace {

void add_noise(Grid<double>& z, double sigma, std::uint64_t seed) {
  const RandomField field(seed, RandomStream::range_noise);
  for (std::size_t i = 0; i < z.spec().size(); ++i) z.values()[i] += sigma * field.normal(i);
}

/// Rocks, half ellipsoids of many sizes, on ground with waves of all lengths.
Grid<double> rocky(const GridSpec& spec, std::uint64_t seed) {
  const RandomField field(seed, RandomStream::rock_population);
  Grid<double> z(spec);
  for (std::uint64_t wave = 0; wave < 36; ++wave) {
    const double length = 5 * std::pow(0.88, static_cast<double>(wave));
    const double height = 0.05 * std::pow(length / 5, 0.8);
    const double angle = 2 * std::numbers::pi * field.uniform(1000 + 2 * wave);
    const double phase = 2 * std::numbers::pi * field.uniform(1001 + 2 * wave);
    for (std::int64_t row = 0; row < spec.rows; ++row)
      for (std::int64_t col = 0; col < spec.cols; ++col) {
        const double along = std::cos(angle) * spec.x(col) + std::sin(angle) * spec.y(row);
        z.at({row, col}) += height * std::sin(2 * std::numbers::pi * along / length + phase);
      }
  }
  for (std::uint64_t k = 0; k < 60; ++k) {
    const double radius = 0.1 + 0.45 * std::pow(field.uniform(4 * k), 2);
    const double x = 14 * field.uniform(4 * k + 1) - 7;
    const double y = 14 * field.uniform(4 * k + 2) - 7;
    const double height = radius * (0.6 + 0.6 * field.uniform(4 * k + 3));
    for (std::int64_t row = 0; row < spec.rows; ++row)
      for (std::int64_t col = 0; col < spec.cols; ++col) {
        const double u = std::hypot(spec.x(col) - x, spec.y(row) - y) / radius;
        if (u < 1) z.at({row, col}) += height * std::sqrt(1 - u * u);
      }
  }
  return z;
}

/// Pooled over sites and draws: in every bin of probability the truly safe share is the mean probability.
TEST(SafeProbability, IsCalibratedOnRocks) {
  const GridSpec spec = GridSpec::centered(8, 0.05);
  const LanderStencil lander({}, 0.05);
  const BinMask region = circular_region(spec, 6.5);
  const double sigma = 0.01;
  for (const double slope_limit_deg : {10.0, 30.0}) {
    const HazardLimits limits{slope_limit_deg, 0.3};
    std::array<double, 10> sum{};
    std::array<double, 10> safe{};
    std::array<double, 10> count{};
    double brier = 0;
    double decision_brier = 0;
    for (std::uint64_t site = 1; site <= 5; ++site) {
      const Grid<double> truth = rocky(spec, site);
      const Grid<std::int8_t> is_safe = judge_places(measure_contact(truth, lander, region), limits);
      Grid<double> z = truth;
      add_noise(z, sigma, 100 + site);
      const PlaceMeasures measured = measure_contact(z, lander, region);
      const Grid<float> p = safe_probability(z, Grid<double>(spec, sigma), lander, limits, 0.85, measured,
                                             [&](const Grid<double>& map, const BinMask& places) {
                                               return measure_contact(map, lander, places);
                                             });
      const Grid<std::int8_t> decided = judge_places(measured, limits);
      for (std::size_t i = 0; i < spec.size(); ++i) {
        ASSERT_EQ(std::isnan(p.values()[i]), std::isnan(measured.roughness_m.values()[i]));
        if (std::isnan(p.values()[i])) continue;
        const double here = p.values()[i];
        const double truly = is_safe.values()[i] == 1 ? 1 : 0;
        const auto bin = std::min(static_cast<std::size_t>(10 * here), std::size_t{9});
        sum[bin] += here;
        safe[bin] += truly;
        count[bin] += 1;
        brier += std::pow(here - truly, 2);
        decision_brier += std::abs(truly - (decided.values()[i] == 1 ? 1 : 0));
      }
    }
    for (std::size_t bin = 0; bin < 10; ++bin)
      if (count[bin] >= 500) {
        EXPECT_NEAR(safe[bin] / count[bin], sum[bin] / count[bin], 0.1) << slope_limit_deg << ' ' << bin;
      }
    EXPECT_GT(count[4], 500);
    EXPECT_LT(brier, 0.75 * decision_brier);
  }
}

}  // namespace
}  // namespace landfall
