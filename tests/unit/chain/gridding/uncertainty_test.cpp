// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/gridding/uncertainty.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>

#include "bins.h"
#include "chain/lidar/error_models/navigation_error.h"
#include "refusal.h"
#include "return_columns.h"

namespace landfall {
namespace {

using testing::HasSubstr;

// z = 1 + kG . (x, y)
const Eigen::Vector2d kG(0.25, -0.5);
constexpr double kStep = 0.05;

Eigen::Quaterniond attitude_of(const RollPitchYaw& rpy) { return Eigen::Quaterniond(rotation_matrix(rpy)); }

/// A DEM of returns on the plane, seen from one pose, and its uncertainty map.
struct Scene {
  explicit Scene(const std::vector<ReturnPoint>& points, const UncertaintyParameters& parameters,
                 const Eigen::Vector3d& body = {0, 0, 101}, const RollPitchYaw& rpy = {}, double start_s = 0)
      : bins(accumulated(spec, points)),
        moments(spec),
        poses({{"a.h5", {start_s, start_s + 10}, {body, body}, {attitude_of(rpy), attitude_of(rpy)}}}) {
    moments.add(ReturnColumns(points).view(), bins);
    slopes = slope_layer(bins);
    map.emplace(bins, moments, slopes, poses, parameters);
  }

  GridSpec spec = GridSpec::centered(0.25, kStep);
  WeightedMeanAccumulator bins;
  MomentAccumulator moments;
  Grid<Slope> slopes;
  PoseTrack poses;
  std::optional<UncertaintyMap> map;
};

ReturnPoint on_plane(double x, double y, double t) {
  return {.x_est = x, .y_est = y, .z_est = 1 + kG.x() * x + kG.y() * y, .t = t};
}

/// One return in each bin's centre at t = 3 s.
std::vector<ReturnPoint> centred_returns() {
  const GridSpec spec = GridSpec::centered(0.25, kStep);
  std::vector<ReturnPoint> points;
  for (const auto [row, col] : bins_of(spec)) points.push_back(on_plane(spec.x(col), spec.y(row), 3));
  return points;
}

constexpr BinIndex kMiddle{5, 5};  // centre (0, 0)

TEST(Quantisation, FactorForOneAndForMany) {
  EXPECT_DOUBLE_EQ(quantisation_factor(1), 1.0 / 12);
  EXPECT_NEAR(quantisation_factor(1e9), 0.0615, 5e-5);
}

// The variance of the weighted centroid of N random returns, one axis of 400,000 draws: known to 0.3 % (1
// sigma, kurtosis below normal); the formula claims 0.3 %. 1.5 % is over 4 sigma.
TEST(Quantisation, FactorAgainstRandomReturns) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  for (const int count : {1, 2, 3, 5, 7}) {
    double sum = 0;
    constexpr int kDraws = 200000;
    for (int draw = 0; draw < kDraws; ++draw) {
      double w_sum = 0;
      double w_x = 0;
      double w_y = 0;
      for (int k = 0; k < count; ++k) {
        const double x = place(random);
        const double y = place(random);
        const double w = (1 - std::abs(x)) * (1 - std::abs(y));
        w_sum += w;
        w_x += w * x;
        w_y += w * y;
      }
      sum += (w_x * w_x + w_y * w_y) / (w_sum * w_sum);
    }
    EXPECT_NEAR(sum / (2 * kDraws) * count / quantisation_factor(count), 1, 0.015) << count;
  }
}

/// Elevations of 5 x 5 nodes at distance 1, and bilinear between them.
struct Nodes {
  double z[5][5];
  [[nodiscard]] double at(double x, double y) const {
    const int i = std::clamp(static_cast<int>(std::floor(x)) + 2, 0, 3);
    const int j = std::clamp(static_cast<int>(std::floor(y)) + 2, 0, 3);
    const double u = x + 2 - i;
    const double v = y + 2 - j;
    return (1 - u) * (1 - v) * z[j][i] + u * (1 - v) * z[j][i + 1] + (1 - u) * v * z[j + 1][i] +
           u * v * z[j + 1][i + 1];
  }
};

/// A step of height 1 along a line in any direction and at any distance at which it changes the nodes.
Nodes random_step(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  const double direction = 2 * std::numbers::pi * unit(random);
  const double distance = 3 * (2 * unit(random) - 1);
  Nodes nodes{};
  for (int j = 0; j < 5; ++j)
    for (int i = 0; i < 5; ++i)
      nodes.z[j][i] = (i - 2) * std::cos(direction) + (j - 2) * std::sin(direction) > distance ? 1 : 0;
  return nodes;
}

// The middle bin's error after the correction by the slope over the square misfit of 3 x 3 bins, both without
// noise. 60,000 steps know the ratio to 1 % (1 sigma, from repetitions); 4 % is 4 sigma.
TEST(Misfit, FactorAgainstRandomSteps) {
  constexpr int kSteps = 1000;  // side by side in one grid, 3 x 3 bins each
  const GridSpec spec{.resolution_m = 1, .first_row = -1, .first_col = 0, .rows = 3, .cols = 3 * kSteps};
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  for (const int count : {1, 2, 4, 10}) {
    double error = 0;
    double misfit = 0;
    for (int batch = 0; batch < 60; ++batch) {
      std::vector<Nodes> steps;
      std::vector<ReturnPoint> points;
      for (int step = 0; step < kSteps; ++step) {
        const Nodes& nodes = steps.emplace_back(random_step(random));
        for (int row = -1; row <= 1; ++row)
          for (int col = -1; col <= 1; ++col)
            for (int k = 0; k < count; ++k) {
              const double x = col + place(random);
              const double y = row + place(random);
              points.push_back({.x_est = x + 3 * step + 1, .y_est = y, .z_est = nodes.at(x, y)});
            }
      }
      const WeightedMeanAccumulator bins = accumulated(spec, points);
      for (int step = 0; step < kSteps; ++step) {
        const BinIndex middle{1, 3 * step + 1};
        const PlaneFit plane = fit_plane(bins, middle);
        if (plane.radius != 1) continue;
        const BinValues bin = values_of(bins.bins()[spec.index(middle)]);
        const double e = steps[static_cast<std::size_t>(step)].z[2][2] -
                         corrected_elevation(bin, spec, middle, plane.slope);
        error += e * e;
        misfit += plane.misfit_m2 * 9 / 6;
      }
    }
    EXPECT_NEAR(error / misfit / misfit_factor(count), 1, 0.04) << count;
  }
}

// chi^2 at 0.99 from tables: 6.635, 9.210, 16.812, 63.691 for 1, 2, 6, 40 degrees of freedom.
TEST(Misfit, LargestChanceRatioAgainstTables) {
  EXPECT_NEAR(mean_square_ratio_p99(1) / 6.635, 1, 0.01);
  EXPECT_NEAR(mean_square_ratio_p99(2) / (9.210 / 2), 1, 0.01);
  EXPECT_NEAR(mean_square_ratio_p99(6) / (16.812 / 6), 1, 0.01);
  EXPECT_NEAR(mean_square_ratio_p99(40) / (63.691 / 40), 1, 0.01);
}

// Seen from straight above, n = (0, 0, -1) and J . n = -1.
TEST(Uncertainty, RangeAndQuantisationByHand) {
  std::vector<ReturnPoint> points = centred_returns();
  points.push_back(on_plane(0.0125, 0, 3));  // weight 0.75 in the middle bin
  const Scene scene(points, {.range_sigma_m = 0.02});
  const BinVariances v = scene.map->variances(kMiddle);
  const double w_w = (1 + 0.5625) / (1.75 * 1.75);
  EXPECT_NEAR(v.range, 4e-4 * w_w, 1e-10);
  EXPECT_NEAR(v.quant, kG.squaredNorm() * kStep * kStep * quantisation_factor(2) / 2, 1e-10);
  EXPECT_EQ(v.rough, 0);  // noise was promised, the returns show none
  EXPECT_EQ(v.navigation, 0);
  const BinVariances one = scene.map->variances({2, 2});
  EXPECT_NEAR(one.quant, kG.squaredNorm() * kStep * kStep / 12, 1e-10);
}

// From the side: r = (0, 0, 1) - (3, 0, 5) = (-3, 0, -4), n = r / 5, J . n = 0.6 g_x - 0.8.
TEST(Uncertainty, RangeSeenFromTheSideByHand) {
  const Scene scene(centred_returns(), {.range_sigma_m = 0.02}, {3, 0, 5});
  const double projected = -0.8 + 0.6 * kG.x();
  EXPECT_NEAR(scene.map->variances(kMiddle).range, 4e-4 * projected * projected, 1e-9);
}

TEST(Uncertainty, PositionAndVelocityByHand) {
  UncertaintyParameters parameters;
  parameters.navigation.position_m = {{0.1, 0.2, 0.3}};
  parameters.navigation.velocity_mps = {{0.01, 0.02, 0.04}};
  const Scene scene(centred_returns(), parameters, {0, 0, 101}, {}, 1);  // 2 s after the start
  const double expected =
      kG.x() * kG.x() * (0.01 + 4 * 1e-4) + kG.y() * kG.y() * (0.04 + 4 * 4e-4) + (0.09 + 4 * 16e-4);
  EXPECT_NEAR(scene.map->variances(kMiddle).navigation, expected, 1e-7);
  const BinVariances v = scene.map->variances(kMiddle);
  const BinSigmas sigmas = scene.map->sigmas(kMiddle);
  EXPECT_DOUBLE_EQ(sigmas.z_abs, std::sqrt(v.range + v.quant + v.rough + v.misfit + v.navigation));
  EXPECT_DOUBLE_EQ(sigmas.z_rel, std::sqrt(v.quant + v.misfit));
  EXPECT_DOUBLE_EQ(sigmas.corrected_abs, std::sqrt(v.misfit + v.navigation));
  EXPECT_LT(sigmas.corrected_rel, 1e-8);  // the rounding of the plane's misfit
}

// r = (0.25, 0, z - 101) at the eastern edge, J = (-g_x, -g_y, 1): a = r x J = (r_y - r_z J_y, r_z J_x - r_x,
// ..).
TEST(Uncertainty, AttitudeByHand) {
  UncertaintyParameters parameters;
  parameters.navigation.rpy_rad = {1e-3, 0, 0};
  parameters.navigation.rpy_rate_radps = {0, 5e-4, 0};
  const Scene scene(centred_returns(), parameters);
  const double height = 101 - (1 + kG.x() * 0.25);
  const double a_x = height * -kG.y();
  const double a_y = -height * -kG.x() - 0.25;
  EXPECT_NEAR(scene.map->variances({5, 10}).navigation / (1e-6 * a_x * a_x + 9 * 25e-8 * a_y * a_y), 1, 1e-5);
  NavigationSigma turn;
  turn.rpy_rad = {1e-3, 0, 0};
  // A body turned by 90 degrees rolls about D's y axis.
  const Scene turned(centred_returns(), {.navigation = turn}, {0, 0, 101}, {0, 0, std::numbers::pi / 2});
  EXPECT_NEAR(turned.map->variances({5, 10}).navigation / (1e-6 * a_y * a_y), 1, 1e-5);
}

// The whole navigation term and the horizontal sigma against Eqs. 4-7 themselves: the bin's true point, seen
// with drawn errors. 20,000 draws know a variance to 1 %; 5 % is 5 sigma.
TEST(Uncertainty, NavigationAgainstDrawnErrors) {
  const NavigationSigma sigma{.position_m = {{0.05, 0.08, 0.03}},
                              .velocity_mps = {{0.02, 0.01, 0.03}},
                              .rpy_rad = {4e-4, 2e-4, 8e-4},
                              .rpy_rate_radps = {1e-4, 3e-4, 2e-4}};
  const Eigen::Vector3d body(20, -15, 101);
  const RollPitchYaw rpy{0.1, -0.2, 0.7};
  const Scene scene(centred_returns(), {.navigation = sigma}, body, rpy);
  const Transform<DemFrame, BodyFrame> truth{rotation_from<DemFrame, BodyFrame>(rpy), {body}};
  const Point<BodyFrame> seen = truth.inverse() * Point<DemFrame>{{0, 0, 1}};
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  const auto draw = [&](double s) { return s * normal(random); };
  double e_z = 0;
  double e_xy = 0;
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    NavigationErrorParameters error;
    for (int axis = 0; axis < 3; ++axis) {
      error.position_m.v[axis] = draw(sigma.position_m.v[axis]);
      error.velocity_mps.v[axis] = draw(sigma.velocity_mps.v[axis]);
    }
    error.rpy = {draw(4e-4), draw(2e-4), draw(8e-4)};
    error.rpy_rate_radps = {draw(1e-4), draw(3e-4), draw(2e-4)};
    const Eigen::Vector3d p = (LinearNavigationError(error).estimated(truth, 3) * seen).v;
    const double e = 1 + kG.dot(p.head<2>()) - p.z();  // H(x_est, y_est) - z_est
    e_z += e * e;
    e_xy += p.head<2>().squaredNorm() / 2;
  }
  EXPECT_NEAR(scene.map->variances(kMiddle).navigation / (e_z / kDraws), 1, 0.05);
  const double quant = kStep * kStep / 12;
  const double xy = scene.map->sigmas(kMiddle).xy;
  EXPECT_NEAR((xy * xy - quant) / (e_xy / kDraws), 1, 0.05);
}

TEST(Uncertainty, HorizontalByHand) {
  const Scene scene(centred_returns(), {.range_sigma_m = 0.5}, {3, 0, 5});  // n_x = -0.6, n_y = 0
  EXPECT_DOUBLE_EQ(scene.map->sigmas(kMiddle).xy, std::sqrt(kStep * kStep / 12 + 0.25 * 0.36 / 2));
}

// Noise in the middle bin, 4 returns at fixed places, seen obliquely: the variance of z_est - plane over
// 20,000 draws (known to 1 %) is the range term; 5 % is 5 sigma.
TEST(Uncertainty, RangeAgainstDrawnNoise) {
  constexpr double kSigma = 0.002;
  const Eigen::Vector3d body(40, -30, 101);
  const std::vector<Eigen::Vector2d> places = {{0.01, 0.02}, {-0.02, 0.005}, {0, -0.015}, {0.022, -0.02}};
  std::vector<ReturnPoint> points = centred_returns();
  for (const Eigen::Vector2d& at : places) points.push_back(on_plane(at.x(), at.y(), 3));
  points.erase(points.begin() + 60);  // the centred return of the middle bin (row 5, column 5 of 11)
  const Scene scene(points, {.range_sigma_m = kSigma}, body);
  std::mt19937_64 random(9);
  std::normal_distribution<double> noise(0, kSigma);
  double sum = 0;
  constexpr int kDraws = 20000;
  for (int draw = 0; draw < kDraws; ++draw) {
    double weights = 0;
    double error = 0;
    for (const Eigen::Vector2d& at : places) {
      const Eigen::Vector3d p(at.x(), at.y(), 1 + kG.dot(at));
      const Eigen::Vector3d moved = p + noise(random) * (p - body).normalized();
      const double w = (1 - std::abs(moved.x()) / kStep) * (1 - std::abs(moved.y()) / kStep);
      weights += w;
      error += w * (moved.z() - 1 - kG.dot(moved.head<2>()));
    }
    sum += (error / weights) * (error / weights);
  }
  EXPECT_NEAR(scene.map->variances(kMiddle).range / (sum / kDraws), 1, 0.05);
}

// A second return 2 m above the first: the lever ends at their mean, z = 2, and a roll of 1 mrad moves it by
// r_z J_y = (2 - 101) g_y.
TEST(Uncertainty, TheLeverEndsAtTheMeanElevation) {
  std::vector<ReturnPoint> points = centred_returns();
  points.push_back(on_plane(0, 0, 3));
  points.back().z_est += 2;
  UncertaintyParameters parameters;
  parameters.navigation.rpy_rad = {1e-3, 0, 0};
  const double moved = 1e-3 * 99 * kG.y();
  EXPECT_NEAR(Scene(points, parameters).map->variances(kMiddle).navigation, moved * moved, 1e-8);
}

/// Four returns per bin on the plane, each with normal noise of `scatter` in z.
std::vector<ReturnPoint> rough_returns(double scatter) {
  std::mt19937_64 random(13);
  std::normal_distribution<double> noise;  // of sigma 1: a sigma of 0 is not allowed
  std::vector<ReturnPoint> points;
  for (const ReturnPoint& centre : centred_returns())
    for (const auto& [dx, dy] : {std::pair{0.01, 0.01}, {-0.01, 0.01}, {0.01, -0.01}, {-0.01, -0.01}}) {
      points.push_back(on_plane(centre.x_est + dx, centre.y_est + dy, 3));
      points.back().z_est += scatter * noise(random);
    }
  return points;
}

// 49 bins of 3 degrees of freedom each: rho^2 is known to sqrt(2 / 147) = 12 %; and the slopes' noise adds
// 2 / 6 sigma_z^2 of 0.01^2 / 0.05^2: below 1 %. The seed is fixed; 40 % is over 3 sigma.
TEST(Uncertainty, RoughnessIsTheScatterBeyondRangeNoise) {
  const double scatter = 0.01;
  const Scene silent(rough_returns(scatter), {});
  EXPECT_NEAR(silent.map->variances(kMiddle).rough / (scatter * scatter / 4), 1, 0.4);
  EXPECT_EQ(silent.map->variances(kMiddle).range, 0);
  // Scatter that range noise explains is not counted again.
  const Scene noisy(rough_returns(scatter), {.range_sigma_m = 0.8 * scatter});
  EXPECT_NEAR(silent.map->variances(kMiddle).rough - noisy.map->variances(kMiddle).rough,
              0.64 * scatter * scatter / 4, 1e-7);
  EXPECT_EQ(Scene(rough_returns(scatter), {.range_sigma_m = 2 * scatter}).map->variances(kMiddle).rough, 0);
}

// A step of 0.2 m beside the middle bin, in the plane of slope kG, a return in each centre: of the nine
// elevations about their plane remain 0.2 m (-1/6, 1/3, -1/6) in each row.
TEST(Uncertainty, MisfitOfAStepByHand) {
  std::vector<ReturnPoint> points = centred_returns();
  for (ReturnPoint& point : points) point.z_est += point.x_est > -0.5 * kStep ? 0.2 : 0;
  const double tau2 = 0.04 / 18 * 9 / 6;
  EXPECT_NEAR(Scene(points, {}).map->variances(kMiddle).misfit, tau2 * misfit_factor(1), 1e-9);
  // Noise of 3 cm, seen from above, explains 9e-4 of 3.3e-3; the threshold is 2.8 times the noise.
  EXPECT_NEAR(Scene(points, {.range_sigma_m = 0.03}).map->variances(kMiddle).misfit,
              (tau2 - 9e-4) * misfit_factor(1), 1e-9);
  // 3.5 cm explain 1.2e-3: more than a third.
  EXPECT_EQ(Scene(points, {.range_sigma_m = 0.035}).map->variances(kMiddle).misfit, 0);
}

TEST(Uncertainty, APlaneHasNoMisfit) {
  EXPECT_LT(Scene(rough_returns(0), {}).map->variances(kMiddle).misfit, 1e-16);
}

TEST(Uncertainty, APlaneHasNoRoughness) {
  EXPECT_LT(Scene(rough_returns(0), {}).map->variances(kMiddle).rough, 1e-12);
}

TEST(Uncertainty, SingleReturnsTellNoRoughness) {
  std::vector<ReturnPoint> points = centred_returns();
  for (std::size_t i = 0; i < points.size(); i += 2) points[i].z_est += 0.01;
  EXPECT_EQ(Scene(points, {}).map->variances(kMiddle).rough, 0);
}

TEST(Uncertainty, NanWhereEmptyOrWithoutSlope) {
  const Scene scene({on_plane(0, 0, 3)}, {.range_sigma_m = 0.02});
  for (const BinIndex bin : {kMiddle, BinIndex{0, 0}}) {
    const BinSigmas sigmas = scene.map->sigmas(bin);
    for (const double value : {sigmas.z_abs, sigmas.z_rel, sigmas.corrected_abs, sigmas.corrected_rel})
      EXPECT_TRUE(std::isnan(value));
  }
  EXPECT_FALSE(std::isnan(scene.map->sigmas(kMiddle).xy));
  EXPECT_TRUE(std::isnan(scene.map->sigmas({0, 0}).xy));
}

TEST(Uncertainty, RefusesSigmasThatAreNone) {
  const auto refusal = [](const UncertaintyParameters& parameters) -> std::string {
    return landfall::refusal([&] { check(parameters); });
  };
  EXPECT_EQ(refusal({}), "accepted");
  EXPECT_THAT(refusal({.range_sigma_m = -1}), HasSubstr("range_sigma_m: -1"));
  UncertaintyParameters bad;
  bad.navigation.position_m.v.y() = -0.5;
  EXPECT_THAT(refusal(bad), HasSubstr("navigation_sigma/position_m: -0.5"));
  bad = {};
  bad.navigation.velocity_mps.v.x() = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusal(bad), HasSubstr("navigation_sigma/velocity_mps: inf"));
  bad = {};
  bad.navigation.rpy_rad.yaw_rad = -2;
  EXPECT_THAT(refusal(bad), HasSubstr("navigation_sigma/rpy_rad: -2"));
  bad = {};
  bad.navigation.rpy_rate_radps.pitch_rad = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal(bad), HasSubstr("navigation_sigma/rpy_rate_radps: nan"));
}

}  // namespace
}  // namespace landfall
