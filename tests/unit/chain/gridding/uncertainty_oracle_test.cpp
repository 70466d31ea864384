// SPDX-License-Identifier: GPL-3.0-or-later
// The whole uncertainty map against its definition, return by return in double.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "base/core/error.h"
#include "bins.h"
#include "chain/gridding/uncertainty.h"
#include "return_columns.h"

namespace landfall {
namespace {

const GridSpec kSpec = GridSpec::centered(1.2, 0.1);  // 25 x 25
const UncertaintyParameters kParameters{.range_sigma_m = 0.02,
                                        .navigation = {.position_m = {{0.01, 0.02, 0.03}},
                                                       .velocity_mps = {{0.002, 0.001, 0.003}},
                                                       .rpy_rad = {1e-4, 3e-4, 2e-4},
                                                       .rpy_rate_radps = {2e-5, 1e-5, 4e-5}}};

/// About three returns per bin in the west; in the east a bin of two returns, and one of one.
std::vector<ReturnPoint> returns() {
  std::mt19937_64 random(31);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> noise(0, 0.03);
  std::vector<ReturnPoint> points;
  const auto add = [&](double x, double y) {
    points.push_back(
        {.x_est = x, .y_est = y, .z_est = 2 + 0.4 * x - 0.7 * y + noise(random), .t = 5 + 10 * unit(random)});
  };
  for (int i = 0; i < 1100; ++i) add(-1.25 + 1.5 * unit(random), -1.25 + 2.5 * unit(random));
  add(1.03, 0.02);
  add(0.98, -0.03);
  points.back().z_est += 0.3;  // rough, by one degree of freedom at most
  add(1.1, -0.9);
  return points;
}

/// Given, not fitted; unknown in some bins.
Grid<Slope> slopes() {
  Grid<Slope> layer(kSpec);
  for (const auto [row, col] : bins_of(kSpec))
    if ((3 * row + col) % 11 != 0)
      layer.at({row, col}) = {static_cast<float>(0.4 + 0.02 * static_cast<double>(row % 5)),
                              static_cast<float>(-0.7 + 0.03 * static_cast<double>(col % 7))};
  return layer;
}

/// From (30, -20, 100) at t = 4 s to (40, -14, 90) at 16 s, at a fixed attitude.
struct Flight {
  Eigen::Quaterniond attitude = Eigen::Quaterniond(rotation_matrix({0.1, -0.2, 0.6}));
  [[nodiscard]] PoseTrack track() const {
    return PoseTrack({{"a.h5", {4, 16}, {{30, -20, 100}, {40, -14, 90}}, {attitude, attitude}}});
  }
  [[nodiscard]] static Eigen::Vector3d position(double t) {
    return Eigen::Vector3d(30, -20, 100) + (t - 4) / 12 * Eigen::Vector3d(10, 6, -10);
  }
};

/// The sums of a bin that the definition needs.
struct BinOracle {
  double count = 0, weight = 0, w_w = 0, scatter = 0;
  Eigen::Vector3d centroid{0, 0, 0};
  Eigen::Vector3d J{0, 0, 0}, lever{0, 0, 0};
  double since_start = 0;

  BinOracle(const std::vector<ReturnPoint>& in, BinIndex bin, const Slope& g) : J(-g.x, -g.y, 1) {
    double w = 0;
    Eigen::Vector4d mean(0, 0, 0, 0);
    std::vector<double> weights;
    for (const ReturnPoint& p : in) {
      weights.push_back((1 - std::abs(p.x_est - kSpec.x(bin.col)) / kSpec.resolution_m) *
                        (1 - std::abs(p.y_est - kSpec.y(bin.row)) / kSpec.resolution_m));
      w += weights.back();
      mean += weights.back() * Eigen::Vector4d(p.x_est, p.y_est, p.z_est, p.t);
    }
    mean /= w;
    weight = w;
    centroid = mean.head<3>();
    for (std::size_t k = 0; k < in.size(); ++k) {
      w_w += weights[k] * weights[k] / (w * w);
      const double off = J.dot(Eigen::Vector3d(in[k].x_est, in[k].y_est, in[k].z_est) - mean.head<3>());
      scatter += weights[k] / w * off * off;
    }
    count = static_cast<double>(in.size());
    lever = Eigen::Vector3d(kSpec.x(bin.col), kSpec.y(bin.row), mean[2]) - Flight::position(mean[3]);
    since_start = mean[3] - 4;
  }
  [[nodiscard]] double noise() const { return kParameters.range_sigma_m * J.dot(lever.normalized()); }
  [[nodiscard]] double excess() const {
    return (count == 1 ? 0 : scatter - noise() * noise() * (1 - w_w)) / w_w;
  }
  [[nodiscard]] double navigation(const Eigen::Vector3d& direction) const {
    const NavigationSigma& sigma = kParameters.navigation;
    const auto square = [](double v) { return v * v; };
    const Eigen::Vector3d arm = Flight().attitude.toRotationMatrix().transpose() * lever.cross(direction);
    const double rates[] = {sigma.rpy_rate_radps.roll_rad, sigma.rpy_rate_radps.pitch_rad,
                            sigma.rpy_rate_radps.yaw_rad};
    const double angles[] = {sigma.rpy_rad.roll_rad, sigma.rpy_rad.pitch_rad, sigma.rpy_rad.yaw_rad};
    double variance = 0;
    for (int axis = 0; axis < 3; ++axis)
      variance += square(direction[axis] * sigma.position_m.v[axis]) +
                  square(direction[axis] * since_start * sigma.velocity_mps.v[axis]) +
                  square(arm[axis] * angles[axis]) + square(arm[axis] * since_start * rates[axis]);
    return variance;
  }
  [[nodiscard]] double horizontal() const {
    const Eigen::Vector3d n = lever.normalized();
    return 0.01 * quantisation_factor(count) / count + 4e-4 * w_w * (n.x() * n.x() + n.y() * n.y()) / 2 +
           (navigation(Eigen::Vector3d::UnitX()) + navigation(Eigen::Vector3d::UnitY())) / 2;
  }
};

class UncertaintyOracle : public testing::Test {
 protected:
  UncertaintyOracle() {
    moments_.add(ReturnColumns(returns()).view(), bins_);
    std::map<std::pair<std::int64_t, std::int64_t>, std::vector<ReturnPoint>> members;
    for (const ReturnPoint& p : returns()) {
      const BinIndex bin = kSpec.bin_of(p.x_est, p.y_est);
      if (kSpec.contains(bin)) members[{bin.row, bin.col}].push_back(p);
    }
    for (const auto& [at, in] : members)
      oracle_.emplace(at, BinOracle(in, {at.first, at.second}, slopes_.at({at.first, at.second})));
  }

  /// rho^2 over the 7 x 7 bins around.
  [[nodiscard]] double roughness(BinIndex middle) const {
    double excess = 0;
    double freedom = 0;
    for (const auto& [at, bin] : oracle_) {
      if (std::abs(at.first - middle.row) > 3 || std::abs(at.second - middle.col) > 3) continue;
      if (std::isnan(bin.J.x())) continue;
      excess += bin.excess();
      freedom += bin.count == 1 ? 0 : 1 / bin.w_w - 1;
    }
    return freedom > 0 ? std::max(0.0, excess / freedom) : 0;
  }

  /// The excess over noise of the centroids' mean square distance from the plane.
  [[nodiscard]] double misfit(BinIndex middle) const {
    const PlaneFit plane = fit_plane(bins_, middle);
    if (plane.bins < 4) return 0;
    std::vector<const BinOracle*> around;
    double w = 0;
    double w_noise = 0;
    Eigen::Vector3d mean(0, 0, 0);
    for (const auto& [at, bin] : oracle_) {
      if (std::abs(at.first - middle.row) > plane.radius || std::abs(at.second - middle.col) > plane.radius)
        continue;
      around.push_back(&bin);
      w += bin.weight;
      w_noise += bin.weight * bin.w_w;
      mean += bin.weight * bin.centroid;
    }
    mean /= w;
    double square = 0;
    for (const BinOracle* bin : around) {
      const Eigen::Vector3d off = bin->centroid - mean;
      square += bin->weight / w * std::pow(off.z() - plane.slope.x * off.x() - plane.slope.y * off.y(), 2);
    }
    const double freedom = static_cast<double>(around.size()) - 3;
    const double noise = std::pow(oracle_.at({middle.row, middle.col}).noise(), 2) * w_noise / w;
    const double excess = square * (freedom + 3) / freedom - noise;
    return excess > noise * (mean_square_ratio_p99(freedom) - 1) ? excess : 0;
  }

  [[nodiscard]] double relative_count(BinIndex middle) const {
    double returns = 0;
    double filled = 0;
    for (const auto& [at, bin] : oracle_) {
      if (std::abs(at.first - middle.row) > 3 || std::abs(at.second - middle.col) > 3) continue;
      returns += bin.count;
      ++filled;
    }
    return oracle_.at({middle.row, middle.col}).count / (returns / filled);
  }

  WeightedMeanAccumulator bins_ = accumulated(kSpec, returns());
  MomentAccumulator moments_{kSpec};
  Grid<Slope> slopes_ = slopes();
  PoseTrack poses_ = Flight().track();
  std::map<std::pair<std::int64_t, std::int64_t>, BinOracle> oracle_;
};

void expect_close(double found, double expected) {
  if (std::isnan(expected))
    EXPECT_TRUE(std::isnan(found));
  else
    EXPECT_NEAR(found, expected, 1e-9 + 2e-4 * std::abs(expected));
}

TEST_F(UncertaintyOracle, EveryBinAsItIsDefined) {
  const UncertaintyMap map(bins_, moments_, slopes_, poses_, kParameters);
  std::size_t rough = 0;
  std::size_t uneven = 0;
  for (const auto& [at, expected] : oracle_) {
    SCOPED_TRACE(testing::Message() << at.first << ' ' << at.second);
    const BinIndex bin{at.first, at.second};
    const double noise = expected.noise();
    const double range = noise * noise * expected.w_w;
    const double quant =
        expected.J.head<2>().squaredNorm() * 0.01 * quantisation_factor(expected.count) / expected.count;
    const double roughness_here = roughness(bin) * expected.w_w;
    const double misfit_here =
        misfit(bin) * misfit_factor(expected.count) * std::pow(std::max(0.6, relative_count(bin)), 1.2);
    const double navigation = expected.navigation(expected.J);
    uneven += misfit_here > 0 ? 1U : 0U;
    rough += roughness_here > 1e-5 ? 1U : 0U;
    expect_close(map.variances(bin).range, range);
    expect_close(map.variances(bin).quant, quant);
    if (!std::isnan(noise)) expect_close(map.variances(bin).rough, roughness_here);
    expect_close(map.variances(bin).misfit, misfit_here);
    expect_close(map.variances(bin).navigation, navigation);
    const BinSigmas sigmas = map.sigmas(bin);
    const double local = range + roughness_here + misfit_here;
    expect_close(sigmas.z_abs, std::sqrt(local + quant + navigation));
    expect_close(sigmas.z_rel, std::sqrt(local + quant));
    expect_close(sigmas.corrected_abs, std::sqrt(local + navigation));
    expect_close(sigmas.corrected_rel, std::sqrt(local));
    expect_close(sigmas.xy, std::sqrt(expected.horizontal()));
  }
  EXPECT_GT(rough, 200U);
  EXPECT_GT(uneven, 20U);
  EXPECT_LT(uneven, 300U);
}

TEST_F(UncertaintyOracle, ProgressIsOneHalfAndAnother) {
  std::vector<double> fractions;
  const UncertaintyMap map(bins_, moments_, slopes_, poses_, kParameters,
                           [&](double f) { fractions.push_back(f); });
  ASSERT_EQ(fractions.size(), 4U);  // two pieces of 16 rows, twice
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_GT(fractions[0], 0.1);
  EXPECT_DOUBLE_EQ(fractions[1], 0.5);
  EXPECT_DOUBLE_EQ(fractions[2], 0.5 + fractions[0]);
  EXPECT_DOUBLE_EQ(fractions[3], 1);
}

TEST_F(UncertaintyOracle, RefusesParametersThatAreNone) {
  EXPECT_THROW(UncertaintyMap(bins_, moments_, slopes_, poses_, {.range_sigma_m = -1}), UsageError);
}

}  // namespace
}  // namespace landfall
