// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "base/numerics/random.h"
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
  for (std::int64_t y = -n; y <= n; ++y)
    for (std::int64_t x = -n; x <= n; ++x) {
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
    for (std::int64_t row = 0; row < z.spec().rows; ++row)
      for (std::int64_t col = 0; col < z.spec().cols; ++col) {
        const auto expected = fitted(z, lander, {row, col});
        ASSERT_EQ(std::isnan(found.slope_deg.at({row, col})), !expected);
        if (!expected) continue;
        ASSERT_NEAR(found.slope_deg.at({row, col}), expected->slope_deg, 1e-7);
        ASSERT_NEAR(found.roughness_m.at({row, col}), expected->roughness_m, 1e-9);
      }
  }
}

}  // namespace
}  // namespace landfall
