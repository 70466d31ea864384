// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/safe_probability.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include "base/numerics/random.h"
#include "bins.h"
#include "constants.h"
#include "map_noise.h"

namespace landfall {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr float kMin = 2.46e-4F;             // T(-8)
constexpr float kMax = 1 - 1 / (8 * 29.0F);  // of a body of 29 bins

/// Rocks, half ellipsoids of many sizes, on ground with waves of all lengths.
Grid<double> rocky(const GridSpec& spec, std::uint64_t seed) {
  const RandomField field(seed, RandomStream::rock_population);
  Grid<double> z(spec);
  for (std::uint64_t wave = 0; wave < 36; ++wave) {
    const double length = 5 * std::pow(0.88, static_cast<double>(wave));
    const double height = 0.05 * std::pow(length / 5, 0.8);
    const double angle = 2 * std::numbers::pi * field.uniform(1000 + 2 * wave);
    const double phase = 2 * std::numbers::pi * field.uniform(1001 + 2 * wave);
    for (const auto [row, col] : bins_of(spec)) {
      const double along = std::cos(angle) * spec.x(col) + std::sin(angle) * spec.y(row);
      z.at({row, col}) += height * std::sin(2 * std::numbers::pi * along / length + phase);
    }
  }
  for (std::uint64_t k = 0; k < 60; ++k) {
    const double radius = 0.1 + 0.45 * std::pow(field.uniform(4 * k), 2);
    const double x = 14 * field.uniform(4 * k + 1) - 7;
    const double y = 14 * field.uniform(4 * k + 2) - 7;
    const double height = radius * (0.6 + 0.6 * field.uniform(4 * k + 3));
    for (const auto [row, col] : bins_of(spec)) {
      const double u = std::hypot(spec.x(col) - x, spec.y(row) - y) / radius;
      if (u < 1) z.at({row, col}) += height * std::sqrt(1 - u * u);
    }
  }
  return z;
}

struct Judged {
  PlaceMeasures measured;
  Grid<float> p;
};

Judged judge(const Grid<double>& z, SigmaParts sigma, const HazardLimits& limits, const BinMask& region) {
  const LanderStencil lander({}, z.spec().resolution_m);
  Judged judged{measure_contact(z, lander, region), {}};
  judged.p = safe_probability({z, std::move(sigma), judged.measured, region}, lander, limits, 0.85,
                              [&](const Grid<double>& map, const BinMask& places) {
                                return measure_contact(map, lander, places);
                              })
                 .p;
  return judged;
}

/// Pooled over sites: in every tenth of probability the truly safe share is the mean probability. A bin is
/// the mean of four returns; bench/bench_probability.py has more kinds of terrain, and larger sites.
TEST(SafeProbability, IsCalibratedOnRocks) {
  const GridSpec spec = GridSpec::centered(8, 0.05);
  const GridSpec fine{0.025, 2 * spec.first_row - 1, 2 * spec.first_col - 1, 2 * spec.rows + 1,
                      2 * spec.cols + 1};
  const LanderStencil lander({}, 0.05);
  const BinMask region = circular_region(spec, 6.5);
  const double sigma = 0.01;
  const HazardLimits limits;
  std::array<double, 10> sum{};
  std::array<double, 10> safe{};
  std::array<double, 10> count{};
  double brier = 0;
  double decision_brier = 0;
  for (std::uint64_t site = 1; site <= 4; ++site) {
    const Grid<double> terrain = rocky(fine, site);
    Grid<double> truth(spec);
    Grid<double> z(spec);
    SigmaParts parts = noise_of(spec, sigma);
    for (std::int64_t row = 0; row < spec.rows; ++row)
      for (std::int64_t col = 0; col < spec.cols; ++col) {
        const auto at = [&](std::int64_t r, std::int64_t c) {
          return terrain.at({2 * row + 1 + r, 2 * col + 1 + c});
        };
        truth.at({row, col}) = at(0, 0);
        const double mean = (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)) / 4;
        z.at({row, col}) = mean;
        double square = 0;
        for (const double value : {at(0, 0), at(1, 0), at(0, 1), at(1, 1)})
          square += std::pow(value - mean, 2) / 3;
        parts.relief_m.at({row, col}) = static_cast<float>(std::sqrt(square / 4));
      }
    const Grid<std::int8_t> is_safe = judge_places(measure_contact(truth, lander, region), limits);
    add_noise(z, sigma, 100 + site);
    const Judged judged = judge(z, std::move(parts), limits, region);
    const Grid<std::int8_t> decided = judge_places(judged.measured, limits);
    for (std::size_t i = 0; i < spec.size(); ++i) {
      ASSERT_EQ(std::isnan(judged.p.values()[i]), region.values()[i] == 0);
      if (region.values()[i] == 0) continue;
      const double here = judged.p.values()[i];
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
      EXPECT_NEAR(safe[bin] / count[bin], sum[bin] / count[bin], 0.12) << bin;
    }
  EXPECT_GT(count[4], 300);
  EXPECT_LT(brier, 0.75 * decision_brier);
}

/// The mean over the places of a plane that rises in no direction of the lattice.
double mean_on_plane(double slope_deg, double sigma) {
  const GridSpec spec = GridSpec::centered(5, 0.05);
  const double rise = std::tan(slope_deg / kDegrees);
  Grid<double> z =
      grid_of(spec, [&](double x, double y) { return rise * (std::cos(0.4) * x + std::sin(0.4) * y); });
  add_noise(z, sigma, 21);
  const BinMask region = circular_region(spec, 3.5);
  const Grid<float> p = judge(z, noise_of(spec, sigma), {}, region).p;
  double sum = 0;
  for (const float value : p.values()) sum += std::isnan(value) ? 0 : value;
  return sum / static_cast<double>(count_set(region));
}

// With 3.2 returns of 1.67 and 5 cm.
TEST(SafeProbability, OnPlanes) {
  EXPECT_GE(mean_on_plane(9, 0.0093), 0.98);
  EXPECT_GE(mean_on_plane(9.5, 0.0093), 0.8);
  EXPECT_LE(mean_on_plane(10.5, 0.0093), 0.1);
  EXPECT_LE(mean_on_plane(11, 0.0093), 0.01);
  EXPECT_GE(mean_on_plane(8.5, 0.028), 0.95);
  EXPECT_LE(mean_on_plane(11.5, 0.028), 0.05);
}

// A place in a hole of the map is unknown, and has a probability: less than with a measured bin in a
// boulder field, no less on a plane.
TEST(SafeProbability, ABinThatWasNotMeasuredCounts) {
  const GridSpec spec = GridSpec::centered(5, 0.05);
  const BinMask region = circular_region(spec, 3.5);
  Grid<double> z(spec);
  add_noise(z, 0.01, 31);
  SigmaParts parts = noise_of(spec, 0.01);
  z.at({100, 100}) = kNan;
  parts.noise_m.at({100, 100}) = parts.relief_m.at({100, 100}) = std::numeric_limits<float>::quiet_NaN();
  const Judged judged = judge(z, std::move(parts), {}, region);
  EXPECT_TRUE(std::isnan(judged.measured.slope_deg.at({105, 100})));
  EXPECT_GT(judged.p.at({105, 100}), 0.99F);
  EXPECT_LT(judged.p.at({105, 100}), 1);
  EXPECT_TRUE(std::isnan(judged.p.at({5, 100})));  // outside the region
}

// The probability of a place by another way, that of US patent 9141113: the least-squares plane of the bins
// under the lander and the largest of their heights above it, each normal about what the map shows. Its parts
// are of one bin and of one plane, so that it agrees only where one of them decides.
class SecondReading {
 public:
  SecondReading(const Grid<double>& z, double sigma)
      : z_(z), sigma_(sigma), lander_({}, z.spec().resolution_m) {}

  [[nodiscard]] double at(BinIndex place, const HazardLimits& limits) const {
    double count = 0;
    double square = 0;
    double sum = 0;
    double rise_x = 0;
    double rise_y = 0;
    const auto each = [&](const auto& work) {
      const Footprint& body = lander_.body;
      for (std::int64_t r = -body.half_bins(); r <= body.half_bins(); ++r)
        for (std::int64_t c = -body.half_width(r); c <= body.half_width(r); ++c)
          work(static_cast<double>(r), static_cast<double>(c), z_.at({place.row + r, place.col + c}));
    };
    each([&](double r, double c, double z) {
      ++count;
      square += c * c;
      sum += z;
      rise_x += c * z;
      rise_y += r * z;
    });
    const double s = z_.spec().resolution_m;
    const double slope = std::hypot(rise_x, rise_y) / square / s;
    const double slope_sigma = sigma_ / std::sqrt(square) / s;
    double height = -1;
    each([&](double r, double c, double z) {
      height = std::max(height, z - sum / count - (rise_x * c + rise_y * r) / square);
    });
    const auto normal = [](double t) { return 0.5 * std::erfc(-t / std::numbers::sqrt2); };
    return normal((std::tan(limits.slope_deg / kDegrees) - slope) / slope_sigma) *
           normal((limits.roughness_m - height) / sigma_);
  }

 private:
  const Grid<double>& z_;
  double sigma_;
  LanderStencil lander_;
};

TEST(SafeProbability, AgreesWithASecondReadingWhereOnePlaneOrOneBinDecides) {
  const GridSpec spec = GridSpec::centered(5, 0.05);
  const BinMask region = circular_region(spec, 3);
  constexpr double kSigma = 0.01;
  struct Terrain {
    const char* name;
    double slope_deg;          ///< along x
    double bend_m;             ///< height of a wave of 8 m
    double rock_m;             ///< height of a rock 0.8 m wide at the origin
    int min_safe, min_unsafe;  ///< places on which both are sure
  };
  for (const Terrain& terrain :
       {Terrain{"gentle plane", 8, 0, 0, 10000, 0}, Terrain{"steep plane", 12, 0, 0, 0, 10000},
        Terrain{"smooth slopes", 3, 0.25, 0, 2000, 300}, Terrain{"one rock", 0, 0, 0.5, 7000, 300},
        Terrain{"one stone", 0, 0, 0.1, 10000, 0}}) {
    SCOPED_TRACE(terrain.name);
    Grid<double> z(spec);
    for (const auto [row, col] : bins_of(spec)) {
      const double u = std::hypot(spec.x(col), spec.y(row)) / 0.4;
      z.at({row, col}) = std::tan(terrain.slope_deg / kDegrees) * spec.x(col) +
                         terrain.bend_m * std::sin(2 * std::numbers::pi * spec.x(col) / 8) +
                         (u < 1 ? terrain.rock_m * std::sqrt(1 - u * u) : 0);
    }
    add_noise(z, kSigma, 41);
    const Grid<float> p = judge(z, noise_of(spec, kSigma), {}, region).p;
    const SecondReading second(z, kSigma);
    int safe = 0;
    int unsafe = 0;
    int apart = 0;
    for (const auto [row, col] : bins_of(spec)) {
      if (region.at({row, col}) == 0) continue;
      const double one = p.at({row, col});
      const double other = second.at({row, col}, {});
      safe += one > 0.99 && other > 0.99 ? 1 : 0;
      unsafe += one < 0.01 && other < 0.01 ? 1 : 0;
      apart += (one > 0.99 && other < 0.01) ? 1 : 0;
    }
    EXPECT_GE(safe, terrain.min_safe);
    EXPECT_GE(unsafe, terrain.min_unsafe);
    EXPECT_EQ(apart, 0);
  }
}

// The measures of a place exactly 8 sigma from a limit do not decide: those of the terrains do.
TEST(SafeProbability, APlaceAtEightSigmaIsOpen) {
  const GridSpec spec{0.1, -5, -5, 11, 11};
  const BinMask region(spec, 1);
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
    const PlaceMeasures then{Grid<double>(spec, c.is_safe ? c.limits.slope_deg + 1 : -1),
                             Grid<double>(spec, 0)};
    const SafeProbability found =
        safe_probability({Grid<double>(spec), noise_of(spec, 0.125), measured, region}, lander, c.limits, 1,
                         [&](const Grid<double>& /*map*/, const BinMask& /*places*/) { return then; });
    for (const float value : found.p.values()) EXPECT_EQ(value, c.is_safe ? kMin : kMax);
  }
}

// Without noise a place beside its limit leaves no doubt but that of a hazard that no terrain shows.
TEST(SafeProbability, WithoutNoiseTheMapDecides) {
  const GridSpec spec{0.1, -5, -5, 11, 11};
  const BinMask region(spec, 1);
  const LanderStencil lander({.leg_radius_m = 0.3, .body_radius_m = 0.3}, 0.1);
  for (const double above : {-1e-6, 1e-6}) {
    const PlaceMeasures measured{Grid<double>(spec, 9), Grid<double>(spec, 0.25 + above)};
    const SafeProbability found =
        safe_probability({Grid<double>(spec), noise_of(spec, 0), measured, region}, lander, {10, 0.25}, 0.3,
                         [&](const Grid<double>& map, const BinMask& /*places*/) {
                           ADD_FAILURE() << "measured again";
                           return PlaceMeasures{Grid<double>(map.spec()), Grid<double>(map.spec())};
                         });
    for (const float value : found.p.values()) EXPECT_EQ(value, above > 0 ? kMin : kMax);
    for (const std::int8_t value : found.capped.values()) EXPECT_EQ(value, above > 0 ? 0 : 1);
    EXPECT_EQ(found.cap, kMax);
  }
}

// The fewer bins under the body have a sigma, the less is P at most.
TEST(SafeProbability, IsNoMoreCertainThanTheBinsUnderTheBody) {
  const GridSpec spec{0.1, -5, -5, 11, 11};
  const BinMask region(spec, 1);
  const LanderStencil lander({.leg_radius_m = 0.3, .body_radius_m = 0.3}, 0.1);
  SigmaParts parts = noise_of(spec, 0.001);
  for (const BinIndex bin : Bins({0, 0}, {4, spec.cols}))
    parts.noise_m.at(bin) = std::numeric_limits<float>::quiet_NaN();
  const PlaceMeasures level{Grid<double>(spec), Grid<double>(spec)};
  const SafeProbability found =
      safe_probability({Grid<double>(spec), parts, level, region}, lander, {}, 0.3,
                       [&](const Grid<double>& /*map*/, const BinMask& /*places*/) { return level; });
  EXPECT_EQ(found.cap, kMax);
  EXPECT_EQ(found.p.at({7, 5}), kMax);                 // 29 bins
  EXPECT_EQ(found.p.at({5, 5}), 1 - 1 / (8 * 23.0F));  // 23 of them
  EXPECT_EQ(found.capped.at({5, 5}), 1);
}

// Eight values of each place, whose distances to the limit are given: Student's distribution by hand.
TEST(SafeProbability, IsThePredictiveDistributionOfOneMoreGround) {
  const GridSpec spec{0.1, -5, -5, 11, 11};
  const BinMask region(spec, 1);
  const LanderStencil lander({.leg_radius_m = 0.3, .body_radius_m = 0.3}, 0.1);
  const std::array<double, 8> slopes = {9.1, 10.2, 9.6, 9.9, 9.4, 10.4, 9.7, 9.3};
  std::size_t call = 0;
  std::vector<BinMask> masks;
  const PlaceMeasures measured{Grid<double>(spec, 9.5), Grid<double>(spec, 0.1)};
  const SafeProbability result = safe_probability(
      {Grid<double>(spec), noise_of(spec, 0.1), measured, region}, lander, {10, 0.3}, 0.3,
      [&](const Grid<double>& map, const BinMask& places) {
        masks.push_back(places);
        PlaceMeasures found{Grid<double>(map.spec(), slopes.at(call++)), Grid<double>(map.spec(), -5)};
        found.slope_deg.at({0, 0}) = 50;  // clear after three terrains
        return found;
      });
  ASSERT_EQ(call, slopes.size());
  // mean 9.7, s = 0.44721, t = 0.63246, T(t; 5) = 0.72256; roughness leaves no doubt.
  EXPECT_NEAR(result.p.at({5, 5}), 0.72256, 1e-5);
  EXPECT_EQ(result.p.at({0, 0}), kMin);
  EXPECT_EQ(masks[2].at({0, 0}), 1);
  EXPECT_EQ(masks[3].at({0, 0}), 0);
  EXPECT_EQ(masks[3].at({5, 5}), 1);
}

}  // namespace
}  // namespace landfall
