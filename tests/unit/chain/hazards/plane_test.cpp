// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "base/numerics/random.h"
#include "bins.h"
#include "brute_force.h"
#include "chain/hazards/measures.h"

namespace landfall {
namespace {

using testing_hazards::BruteForce;
using testing_hazards::random_map;

/// By Eigen's QR of all bins under the body; none: unknown.
std::optional<BruteForce::Measures> fitted(const Grid<double>& z, const Lander& lander, BinIndex place) {
  const BruteForce slow{z, lander};
  const std::int64_t n = slow.within(lander.body_radius_m);
  std::vector<Eigen::Vector3d> rows;
  std::vector<double> heights;
  for (const auto [y, x] : Bins({-n, -n}, {n + 1, n + 1})) {
    if (!slow.covers(lander.body_radius_m, {x, y})) continue;
    const auto height = slow.at(place, {x, y});
    if (!height) return {};
    rows.emplace_back(1, static_cast<double>(x), static_cast<double>(y));
    heights.push_back(*height);
  }
  Eigen::MatrixXd design(static_cast<Eigen::Index>(rows.size()), 3);
  for (std::size_t i = 0; i < rows.size(); ++i) design.row(static_cast<Eigen::Index>(i)) = rows[i];
  const Eigen::Map<const Eigen::VectorXd> right(heights.data(), static_cast<Eigen::Index>(heights.size()));
  const Eigen::Vector3d plane = design.colPivHouseholderQr().solve(right);
  const double slope = slow.slope_of({plane[1], plane[2], plane[0]});
  return BruteForce::Measures{
      slope, (right - design * plane).cwiseAbs().maxCoeff() * std::cos(slope * std::numbers::pi / 180)};
}

TEST(Plane, EqualsALeastSquaresFit) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const RandomField field(seed, RandomStream::range_noise);
    Lander lander;
    lander.leg_radius_m = 0.5;
    lander.body_radius_m = 0.1 + 0.4 * field.uniform(3);
    Grid<double> z = random_map({0.1, -9, -8, 19, 26}, seed, seed % 2 == 0 ? 0 : 0.004);
    if (seed % 5 == 0)
      for (double& height : z.values()) height += 1e4;
    const PlaceMeasures found = measure_plane(z, LanderStencil(lander, 0.1), BinMask(z.spec(), 1));
    for (const auto [row, col] : bins_of(z.spec())) {
      const auto expected = fitted(z, lander, {row, col});
      ASSERT_EQ(std::isnan(found.slope_deg.at({row, col})), !expected);
      if (!expected) continue;
      ASSERT_NEAR(found.slope_deg.at({row, col}), expected->slope_deg, 1e-7);
      ASSERT_NEAR(found.roughness_m.at({row, col}), expected->roughness_m, 1e-9);
    }
  }
}

const GridSpec kLmedsSpec{.resolution_m = 0.1, .first_row = -15, .first_col = -15, .rows = 31, .cols = 31};
constexpr BinIndex kLmedsCentre{15, 15};
const Lander kLander{.leg_radius_m = 0.5, .body_radius_m = 0.8};

Grid<double> lmeds_terrain(const auto& height) { return grid_of(kLmedsSpec, height); }

PlaceMeasures lmeds_measures(const Grid<double>& z, const Lander& lander = kLander) {
  return measure_lmeds(z, LanderStencil(lander, z.spec().resolution_m), BinMask(z.spec(), 1));
}

TEST(Lmeds, APlaneIsItself) {
  const PlaceMeasures found =
      lmeds_measures(lmeds_terrain([](double x, double y) { return 0.3 * x - 0.1 * y + 1e4; }));
  EXPECT_NEAR(found.slope_deg.at(kLmedsCentre), std::atan(std::hypot(0.3, 0.1)) * 180 / std::numbers::pi,
              1e-7);
  EXPECT_NEAR(found.roughness_m.at(kLmedsCentre), 0, 1e-9);
}

TEST(Lmeds, APostDoesNotTiltThePlane) {
  const auto post = [](double x, double y) { return std::hypot(x - 0.3, y) < 0.25 ? 0.6 : 0; };
  const PlaceMeasures found =
      lmeds_measures(lmeds_terrain([&](double x, double y) { return 0.3 * x + post(x, y); }));
  EXPECT_NEAR(found.slope_deg.at(kLmedsCentre), std::atan(0.3) * 180 / std::numbers::pi, 1e-9);
  EXPECT_NEAR(found.roughness_m.at(kLmedsCentre), 0.6 / std::hypot(1, 0.3), 1e-12);
}

TEST(Lmeds, TheLargerSideOfAStepIsThePlane) {
  const PlaceMeasures found =
      lmeds_measures(lmeds_terrain([](double x, double) { return x > 0.25 ? 0.5 : 0; }));
  EXPECT_NEAR(found.slope_deg.at(kLmedsCentre), 0, 1e-12);
  EXPECT_NEAR(found.roughness_m.at(kLmedsCentre), 0.5, 1e-12);
}

/// The definitions, with the planes by Eigen.
class SlowLmeds {
 public:
  SlowLmeds(const Grid<double>& z, const Lander& lander) : slow_{z, lander} {
    const std::int64_t n = slow_.within(lander.body_radius_m);
    const auto half =
        static_cast<std::int64_t>(std::floor((lander.body_radius_m + 1e-9) / z.spec().resolution_m));
    const std::int64_t stride = std::max<std::int64_t>(1, half / 4);
    for (const auto [y, x] : Bins({-n, -n}, {n + 1, n + 1})) {
      if (!slow_.covers(lander.body_radius_m, {x, y})) continue;
      body_.push_back({x, y});
      if (x % stride == 0 && y % stride == 0) samples_.push_back({x, y});
    }
    const RandomField random(1, RandomStream::lmeds);
    const auto count = static_cast<double>(samples_.size());
    for (std::uint64_t draw = 0; triples_.size() < 35; ++draw) {
      std::array<BruteForce::Bin, 3> bins;
      for (std::uint64_t k = 0; k < 3; ++k)
        bins[k] = samples_[static_cast<std::size_t>(std::floor(random.uniform(draw, k) * count))];
      if ((bins[1].x - bins[0].x) * (bins[2].y - bins[0].y) !=
          (bins[2].x - bins[0].x) * (bins[1].y - bins[0].y))
        triples_.push_back(bins);
    }
  }
  [[nodiscard]] std::size_t samples() const { return samples_.size(); }

  /// None: unknown.
  [[nodiscard]] std::optional<BruteForce::Measures> at(BinIndex place) const {
    for (const BruteForce::Bin& bin : body_)
      if (!slow_.at(place, bin)) return {};
    double minimum = std::numeric_limits<double>::infinity();
    Eigen::Vector3d best = Eigen::Vector3d::Zero();
    for (const auto& bins : triples_) {
      Eigen::Matrix3d matrix;
      Eigen::Vector3d heights;
      for (int k = 0; k < 3; ++k) {
        const BruteForce::Bin& bin = bins[static_cast<std::size_t>(k)];
        matrix.row(k) << static_cast<double>(bin.x), static_cast<double>(bin.y), 1;
        heights[k] = *slow_.at(place, bin);
      }
      const Eigen::Vector3d plane = matrix.fullPivLu().solve(heights);
      const double median = std::sqrt(median_square(place, plane));
      if (median < minimum - 1e-9) {
        minimum = median;
        best = plane;
      }
    }
    const double slope = slow_.slope_of({best[0], best[1], best[2]});
    double maximum = 0;
    for (const BruteForce::Bin& bin : body_)
      maximum = std::max(maximum, std::abs(residual(place, bin, best)));
    return BruteForce::Measures{slope, maximum * std::cos(slope * std::numbers::pi / 180)};
  }

 private:
  [[nodiscard]] double residual(BinIndex place, BruteForce::Bin bin, const Eigen::Vector3d& plane) const {
    return *slow_.at(place, bin) -
           plane.dot(Eigen::Vector3d(static_cast<double>(bin.x), static_cast<double>(bin.y), 1));
  }
  [[nodiscard]] double median_square(BinIndex place, const Eigen::Vector3d& plane) const {
    std::vector<double> squares;
    for (const BruteForce::Bin& bin : samples_) squares.push_back(std::pow(residual(place, bin, plane), 2));
    std::ranges::sort(squares);
    return squares[squares.size() / 2];
  }

  BruteForce slow_;
  std::vector<BruteForce::Bin> body_, samples_;
  std::vector<std::array<BruteForce::Bin, 3>> triples_;
};

TEST(Lmeds, EqualsItsDefinitionOnRandomMaps) {
  int known = 0;
  int unknown = 0;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const RandomField field(seed, RandomStream::range_noise);
    Lander lander = kLander;
    lander.body_radius_m = 0.2 + 0.7 * field.uniform(3);
    const Grid<double> z = random_map({0.1, -9, -8, 19, 26}, seed, seed % 2 == 0 ? 0 : 0.004);
    const PlaceMeasures found = lmeds_measures(z, lander);
    const SlowLmeds slow(z, lander);
    for (const auto [row, col] : bins_of(z.spec())) {
      const auto expected = slow.at({row, col});
      ASSERT_EQ(std::isnan(found.slope_deg.at({row, col})), !expected);
      ++(expected ? known : unknown);
      if (!expected) continue;
      ASSERT_NEAR(found.slope_deg.at({row, col}), expected->slope_deg, 1e-9)
          << seed << " " << row << " " << col;
      ASSERT_NEAR(found.roughness_m.at({row, col}), expected->roughness_m, 1e-9);
    }
  }
  EXPECT_GT(known, 1000);
  EXPECT_GT(unknown, 1000);
}

TEST(Lmeds, SamplesThatTheHeaderStates) {
  const Grid<double> z(kLmedsSpec);
  const auto samples = [&](double radius_m) { return SlowLmeds(z, {.body_radius_m = radius_m}).samples(); };
  EXPECT_EQ(samples(0.2), 13U);
  EXPECT_EQ(samples(0.4), 49U);
  EXPECT_EQ(samples(0.7), 149U);
  EXPECT_EQ(samples(0.8), 49U);
}

TEST(Lmeds, TheSameAtAnyNumberOfThreads) {
  const Grid<double> z = random_map({0.1, -30, -30, 61, 61}, 9, 0.001);
  testing_hazards::expect_same_at_any_threads([&] { return lmeds_measures(z); });
}

}  // namespace
}  // namespace landfall
