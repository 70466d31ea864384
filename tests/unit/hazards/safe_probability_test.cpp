// SPDX-License-Identifier: GPL-3.0-or-later
#include "hazards/safe_probability.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "base/random.h"
#include "hazards/denoise.h"

namespace landfall {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

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
  // The roughness of a site is that of a few rocks: at 30 deg, where it decides, shares vary more.
  for (const auto& [slope_limit_deg, tolerance] : {std::pair{10.0, 0.05}, std::pair{30.0, 0.08}}) {
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
        EXPECT_NEAR(safe[bin] / count[bin], sum[bin] / count[bin], tolerance)
            << slope_limit_deg << ' ' << bin;
      }
    EXPECT_GT(count[4], 500);
    EXPECT_LT(brier, 0.75 * decision_brier);
  }
}

/// The mean of the finite values in the square of 2 half + 1 bins about a place; NaN where there is none.
double mean_about(const Grid<double>& values, BinIndex place, std::int64_t half) {
  const GridSpec& spec = values.spec();
  double sum = 0;
  int count = 0;
  for (std::int64_t row = place.row - half; row <= place.row + half; ++row)
    for (std::int64_t col = place.col - half; col <= place.col + half; ++col) {
      if (row < 0 || col < 0 || row >= spec.rows || col >= spec.cols) continue;
      if (!std::isfinite(values.at({row, col}))) continue;
      sum += values.at({row, col});
      ++count;
    }
  return count == 0 ? kNan : sum / count;
}

constexpr std::uint64_t kReplicates = 3;

/// safe_probability() in plain loops.
struct SlowProbability {
  const Grid<double>& z;
  const Grid<double>& sigma;
  std::int64_t half;
  HazardLimits limits;
  double slope_base_m;
  const PlaceMeasures& measured;
  const MeasurePlaces& measure;
  int certain_count = 0, open_count = 0, fallback_count = 0;

  [[nodiscard]] bool is_open(BinIndex place, double& p) const {
    Grid<double> variance = sigma;
    for (double& value : variance.values()) value = value * value;
    const double eight = 8 * std::sqrt(mean_about(variance, place, half));
    const double rough = measured.roughness_m.at(place) - limits.roughness_m;
    const double steep = measured.slope_deg.at(place) - limits.slope_deg;
    const double eight_deg = eight / slope_base_m * 180 / std::numbers::pi;
    p = rough > eight || steep > eight_deg ? 0 : 1;
    return p == 1 && !(rough < -eight && steep < -eight_deg);
  }

  [[nodiscard]] Grid<double> operator()() {
    const GridSpec& spec = z.spec();
    const SigmaParts parts = split_sigma(sigma, Footprint::square(half));
    const Grid<double> denoised = denoise(z, parts.noise_m);
    const BinMask all(spec, 1);
    const PlaceMeasures expected = measure(denoised, all);
    Grid<double> p(spec, kNan);
    BinMask open(spec);
    for (std::int64_t row = 0; row < spec.rows; ++row)
      for (std::int64_t col = 0; col < spec.cols; ++col)
        if (!std::isnan(measured.roughness_m.at({row, col})))
          open.at({row, col}) = is_open({row, col}, p.at({row, col})) ? 1 : 0;
    const Moments spread = replicate(denoised, parts, open);
    const Moments bias = replicate(restored(denoised, parts.noise_m), parts, open);
    for (std::int64_t row = 0; row < spec.rows; ++row)
      for (std::int64_t col = 0; col < spec.cols; ++col) {
        const BinIndex place{row, col};
        if (std::isnan(p.at(place))) continue;
        ++(open.at(place) != 0 ? open_count : certain_count);
        if (open.at(place) == 0) continue;
        p.at(place) = phi(spread, bias, 0, place, limits.roughness_m - expected.roughness_m.at(place)) *
                      phi(spread, bias, 2, place, limits.slope_deg - expected.slope_deg.at(place));
      }
    return p;
  }

  /// Means over the replicates: of the error of roughness and its square, of that of slope and its square.
  using Moments = std::array<Grid<double>, 4>;

  [[nodiscard]] Moments replicate(const Grid<double>& means, const SigmaParts& parts,
                                  const BinMask& open) const {
    const GridSpec& spec = z.spec();
    const BinMask all(spec, 1);
    const PlaceMeasures truth = measure(relief_ground(means, parts), all);
    Moments errors;
    for (Grid<double>& map : errors) map = Grid<double>(spec);
    const RandomField field(1, RandomStream::map_noise);
    for (std::uint64_t k = 0; k < kReplicates; ++k) {
      Grid<double> noisy = means;
      for (std::size_t i = 0; i < spec.size(); ++i)
        noisy.values()[i] += parts.noise_m.values()[i] * field.normal(k, i);
      const PlaceMeasures again = measure(denoise(noisy, parts.noise_m), all);
      for (std::int64_t row = 0; row < spec.rows; ++row)
        for (std::int64_t col = 0; col < spec.cols; ++col) {
          const BinIndex place{row, col};
          const double rough =
              is_sampled(open, place) ? again.roughness_m.at(place) - truth.roughness_m.at(place) : kNan;
          const double steep = again.slope_deg.at(place) - truth.slope_deg.at(place) + 0 * rough;
          const std::array<double, 4> found = {rough, rough * rough, steep, steep * steep};
          for (std::size_t i = 0; i < 4; ++i) errors[i].at(place) += found[i] / kReplicates;
        }
    }
    return errors;
  }

  [[nodiscard]] static Grid<double> restored(const Grid<double>& denoised, const Grid<double>& noise_m) {
    const Grid<double> again = denoise(denoised, noise_m);
    Grid<double> means = denoised;
    for (std::size_t i = 0; i < means.spec().size(); ++i)
      means.values()[i] += denoised.values()[i] - again.values()[i];
    return means;
  }

  [[nodiscard]] Grid<double> relief_ground(const Grid<double>& means, const SigmaParts& parts) const {
    Grid<double> ground = sharpen(means, parts.relief_m);
    const RandomField field(1, RandomStream::map_noise);
    for (std::size_t i = 0; i < ground.spec().size(); ++i) {
      const double beyond = std::pow(sigma.values()[i], 2) - std::pow(parts.noise_m.values()[i], 2);
      ground.values()[i] += std::sqrt(std::max(beyond, 0.0) / 3) * field.normal(kReplicates, i);
    }
    return ground;
  }

  [[nodiscard]] bool is_sampled(const BinMask& open, BinIndex place) const {
    if (half < 4) return open.at(place) != 0;
    if (place.row % 8 != 0) return false;
    for (std::int64_t row = std::max<std::int64_t>(place.row - 4, 0);
         row <= std::min(place.row + 4, open.spec().rows - 1); ++row)
      if (open.at({row, place.col}) != 0) return true;
    return false;
  }

  [[nodiscard]] double phi(const Moments& spread, const Moments& bias, std::size_t first, BinIndex place,
                           double room) {
    std::int64_t reach = half;
    if (std::isnan(mean_about(bias[first], place, reach))) {
      ++fallback_count;
      reach = z.spec().rows + z.spec().cols;
    }
    if (std::isnan(mean_about(bias[first], place, reach))) return room >= 0 ? 1 : 0;
    const double mean = mean_about(spread[first], place, reach);
    const double square = mean_about(spread[first + 1], place, reach);
    return 0.5 *
           std::erfc(-(room + mean_about(bias[first], place, reach)) / std::sqrt(2 * (square - mean * mean)));
  }
};

/// Ground that is rougher to the north and steeper to the east: all kinds of places. Some bins have relief.
void expect_as_slow(const Lander& lander_of, std::uint64_t seed) {
  const GridSpec spec{0.1, -20, -17, 43, 39};
  Grid<double> z(spec);
  Grid<double> sigma(spec, 0.004);
  add_noise(z, 0.05, seed);
  add_noise(sigma, 0.0008, seed + 1);
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      z.at({row, col}) *= static_cast<double>(row) / 43;
      z.at({row, col}) += 0.0004 * static_cast<double>(col * col);
      if ((row * 7 + col) % 11 == 0) sigma.at({row, col}) = 0.012;
    }
  z.at({30, 8}) = kNan;
  sigma.at({30, 8}) = kNan;
  const LanderStencil lander(lander_of, spec.resolution_m);
  // Every eighth row of some columns cannot be measured, so that places there have no errors near them.
  const MeasurePlaces measure = [&](const Grid<double>& map, const BinMask& places) {
    PlaceMeasures found = measure_contact(map, lander, places);
    for (std::int64_t row = 0; row < spec.rows; row += 8)
      for (std::int64_t col = 14; col < 24; ++col)
        found.slope_deg.at({row, col}) = found.roughness_m.at({row, col}) = kNan;
    return found;
  };
  const PlaceMeasures measured = measure(z, BinMask(spec, 1));
  const HazardLimits limits{14, 0.085};
  const Grid<float> found =
      safe_probability(z, sigma, lander, limits, lander_of.leg_radius_m, measured, measure);
  SlowProbability slow{z, sigma, lander.body.half_bins(), limits, lander_of.leg_radius_m, measured, measure};
  const Grid<double> expected = slow();
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      const BinIndex place{row, col};
      ASSERT_EQ(std::isnan(found.at(place)), std::isnan(expected.at(place))) << row << ' ' << col;
      if (std::isnan(expected.at(place))) continue;
      ASSERT_NEAR(found.at(place), expected.at(place), 1e-4) << row << ' ' << col;
    }
  EXPECT_GT(slow.open_count, 100);
  EXPECT_GT(slow.certain_count, 50);
  EXPECT_EQ(slow.fallback_count > 0, lander.body.half_bins() >= 4);
}

TEST(SafeProbability, EqualsItsDefinition) {
  expect_as_slow({.leg_radius_m = 0.4, .body_radius_m = 0.4}, 3);
  expect_as_slow({.leg_radius_m = 0.4, .body_radius_m = 0.2}, 5);
  expect_as_slow({.leg_radius_m = 0.4, .body_radius_m = 0.1}, 7);
}

/// The height of each bin is its measure, so that those at the border of the map are places, too. Where
/// `without_errors` is not 0, a place has no measure.
void expect_bins_as_slow(const BinMask& without_errors, bool has_fallbacks) {
  const GridSpec& spec = without_errors.spec();
  Grid<double> z(spec, 0.08);
  Grid<double> sigma(spec, 0.004);
  add_noise(z, 0.05, 11);
  add_noise(sigma, 0.0008, 12);
  for (const BinIndex corner : {BinIndex{0, 0}, BinIndex{0, 38}, BinIndex{42, 0}, BinIndex{42, 38}}) {
    z.at(corner) = 0.079;
    sigma.at(corner) = 0.012;
  }
  const MeasurePlaces measure = [&](const Grid<double>& map, const BinMask& places) {
    PlaceMeasures found{Grid<double>(spec, kNan), Grid<double>(spec, kNan)};
    for (std::size_t i = 0; i < spec.size(); ++i) {
      if (places.values()[i] == 0 || without_errors.values()[i] != 0) continue;
      found.slope_deg.values()[i] = 200 * map.values()[i];
      found.roughness_m.values()[i] = map.values()[i];
    }
    return found;
  };
  const PlaceMeasures measured = measure(z, BinMask(spec, 1));
  const HazardLimits limits{16, 0.078};
  const LanderStencil lander({.leg_radius_m = 0.4, .body_radius_m = 0.4}, spec.resolution_m);
  const Grid<float> found = safe_probability(z, sigma, lander, limits, 0.4, measured, measure);
  SlowProbability slow{z, sigma, lander.body.half_bins(), limits, 0.4, measured, measure};
  const Grid<double> expected = slow();
  for (std::size_t i = 0; i < spec.size(); ++i) {
    ASSERT_EQ(std::isnan(found.values()[i]), std::isnan(expected.values()[i])) << i;
    if (std::isnan(expected.values()[i])) continue;
    ASSERT_NEAR(found.values()[i], expected.values()[i], 1e-4) << i;
  }
  EXPECT_GT(slow.open_count, 100);
  EXPECT_GT(slow.certain_count, 50);
  EXPECT_EQ(slow.fallback_count > 0, has_fallbacks);
}

// Errors are those of every eighth row. Without any, p is that of the measures alone.
TEST(SafeProbability, EqualsItsDefinitionUpToTheBorder) {
  BinMask without_errors(GridSpec{0.1, -20, -17, 43, 39});
  expect_bins_as_slow(without_errors, false);
  for (std::int64_t row = 0; row < 43; row += 8)
    for (std::int64_t col = 0; col < 39; ++col) without_errors.at({row, col}) = 1;
  expect_bins_as_slow(without_errors, true);
  without_errors.at({16, 20}) = 0;  // one place alone
  expect_bins_as_slow(without_errors, true);
}

// Where only one measure has errors, the other one leaves its probability.
TEST(SafeProbability, OneMeasureWithoutErrors) {
  const GridSpec spec{0.1, -8, -8, 17, 17};
  const LanderStencil lander({.leg_radius_m = 0.3, .body_radius_m = 0.3}, 0.1);
  const MeasurePlaces measure = [&](const Grid<double>& map, const BinMask& places) {
    PlaceMeasures found = measure_contact(map, lander, places);
    for (double& roughness : found.roughness_m.values()) roughness = 0.25;
    return found;
  };
  const Grid<double> z(spec);
  const PlaceMeasures measured = measure(z, BinMask(spec, 1));
  const Grid<float> p =
      safe_probability(z, Grid<double>(spec, 0.01), lander, {2, 0.25}, 0.3, measured, measure);
  EXPECT_GT(p.at({8, 8}), 0);
}

// A place is open up to 8 sigma from its limits, and errors are measured in every eighth row near one.
TEST(SafeProbability, MeasuresErrorsNearOpenPlaces) {
  const GridSpec spec{0.1, -16, -16, 33, 33};
  const LanderStencil lander({.leg_radius_m = 0.4, .body_radius_m = 0.4}, 0.1);
  const HazardLimits limits{30, 0.3};
  PlaceMeasures measured{Grid<double>(spec), Grid<double>(spec)};
  for (const BinIndex open : {BinIndex{11, 5}, BinIndex{12, 9}, BinIndex{13, 12}})
    measured.roughness_m.at(open) = limits.roughness_m;
  std::vector<BinMask> masks;
  const Grid<float> p = safe_probability(Grid<double>(spec), Grid<double>(spec, 0.01), lander, limits, 0.4,
                                         measured, [&](const Grid<double>& /*map*/, const BinMask& places) {
                                           masks.push_back(places);
                                           return measured;
                                         });
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      const bool is_measured = (row == 8 && (col == 5 || col == 9)) || (row == 16 && (col == 9 || col == 12));
      ASSERT_EQ(masks.front().at({row, col}) != 0, is_measured) << row << ' ' << col;
    }
}

// The measures of a place exactly 8 sigma from a limit do not decide: those of the replicates do.
TEST(SafeProbability, APlaceAtEightSigmaIsOpen) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  const GridSpec spec{0.1, -5, -5, 11, 11};
  const LanderStencil lander({.leg_radius_m = 0.3, .body_radius_m = 0.3}, 0.1);
  struct Case {
    HazardLimits limits;
    double slope_deg, roughness_m;  // measured
    bool is_safe;                   // by these
  };
  // 8 sigma are 1 m, and over a base of 1 m a radian.
  for (const Case& c : {Case{{10, 2}, 10, 3, false}, Case{{0, 2}, kDegrees, 2, false},
                        Case{{200, 1}, 0, 0, true}, Case{{kDegrees, 5}, 0, 0, true}}) {
    const PlaceMeasures measured{Grid<double>(spec, c.slope_deg), Grid<double>(spec, c.roughness_m)};
    const PlaceMeasures then{Grid<double>(spec, c.is_safe ? c.limits.slope_deg + 1 : 0),
                             Grid<double>(spec, 0)};
    const Grid<float> p =
        safe_probability(Grid<double>(spec), Grid<double>(spec, 0.125), lander, c.limits, 1, measured,
                         [&](const Grid<double>& /*map*/, const BinMask& /*places*/) { return then; });
    for (const float value : p.values()) EXPECT_EQ(value, c.is_safe ? 0 : 1);
  }
}

// Without noise a place at its limit is open, and its measures decide.
TEST(SafeProbability, WithoutNoiseTheMeasuresDecide) {
  const GridSpec spec{0.1, -5, -5, 11, 11};
  const LanderStencil lander({.leg_radius_m = 0.3, .body_radius_m = 0.3}, 0.1);
  const HazardLimits limits{10, 0.25};  // exact in float
  for (const double above : {-0.125, 0.0, 0.125}) {
    const PlaceMeasures measured{Grid<double>(spec, 10), Grid<double>(spec, 0.25)};
    const Grid<float> p = safe_probability(
        Grid<double>(spec), Grid<double>(spec), lander, limits, 0.3, measured,
        [&](const Grid<double>& map, const BinMask& /*places*/) {
          return PlaceMeasures{Grid<double>(map.spec(), 10), Grid<double>(map.spec(), 0.25 + above)};
        });
    for (const float value : p.values()) EXPECT_EQ(value, above > 0 ? 0 : 1);
  }
}

}  // namespace
}  // namespace landfall
