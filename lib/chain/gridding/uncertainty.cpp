// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D55, D56, D57, D58, D378
#include "chain/gridding/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "base/numerics/non_finite.h"
#include "base/numerics/portable_math.h"
#include "base/text/number_text.h"

namespace landfall {
namespace {

constexpr std::size_t kRowsPerUncertaintyPiece = 16;
constexpr std::int64_t kRoughnessRadius = 3;

Eigen::Vector3d squares(const Eigen::Vector3d& v) { return v.cwiseAbs2(); }

Eigen::Vector3d angles(const RollPitchYaw& rpy) { return {rpy.roll_rad, rpy.pitch_rad, rpy.yaw_rad}; }

void check_sigmas(const std::string& key, const Eigen::Vector3d& sigmas) {
  for (const double sigma : sigmas)
    if (!std::isfinite(sigma) || sigma < 0)
      throw UsageError(key + ": " + number_text(sigma) + " is not finite and at least 0");
}

/// visit(bin) for every bin that holds a return.
template <class Visit>
void for_each_filled_bin(const WeightedMeanAccumulator& bins, Visit visit, const ProgressCallback& progress) {
  const GridSpec& spec = bins.spec();
  const auto visit_rows = [&](std::size_t begin, std::size_t end) {
    for (auto row = static_cast<std::int64_t>(begin); row < static_cast<std::int64_t>(end); ++row)
      for (std::int64_t col = 0; col < spec.cols; ++col)
        if (bins.bins()[spec.index({row, col})].count > 0) visit(BinIndex{row, col});
  };
  parallel_for(static_cast<std::size_t>(spec.rows), kRowsPerUncertaintyPiece, visit_rows, progress);
}

/// visit(bin) for the (2 radius + 1)^2 bins around one, as far as they are in the grid, row by row.
template <class Visit>
void for_each_in_window(const GridSpec& spec, BinIndex middle, std::int64_t radius, Visit visit) {
  for (std::int64_t row = std::max<std::int64_t>(0, middle.row - radius);
       row <= std::min(spec.rows - 1, middle.row + radius); ++row)
    for (std::int64_t col = std::max<std::int64_t>(0, middle.col - radius);
         col <= std::min(spec.cols - 1, middle.col + radius); ++col)
      visit(BinIndex{row, col});
}

/// The sum over the bins within kRoughnessRadius; NaN is skipped.
double window_sum(const Grid<float>& layer, BinIndex middle) {
  double sum = 0;
  for_each_in_window(layer.spec(), middle, kRoughnessRadius, [&](BinIndex bin) {
    const double value = layer.at(bin);
    if (!std::isnan(value)) sum += value;
  });
  return sum;
}

}  // namespace

void check(const UncertaintyParameters& parameters) {
  const NavigationSigma& navigation = parameters.navigation;
  check_sigmas("range_sigma_m", Eigen::Vector3d::Constant(parameters.range_sigma_m));
  check_sigmas("navigation_sigma/position_m", navigation.position_m.v);
  check_sigmas("navigation_sigma/velocity_mps", navigation.velocity_mps.v);
  check_sigmas("navigation_sigma/rpy_rad", angles(navigation.rpy_rad));
  check_sigmas("navigation_sigma/rpy_rate_radps", angles(navigation.rpy_rate_radps));
}

double quantisation_factor(double count) {
  constexpr double kMany = 1792.0 / 29160.0;
  return kMany + (1.0 / 12.0 - kMany) / count;
}

double misfit_factor(double count) { return 0.41 + 0.175 / count; }

double crowding_factor(double relative_count) { return portable::pow(std::max(0.6, relative_count), 1.2); }

double mean_square_ratio_p99(double freedom) {
  constexpr double kQuantile = 2.3263478740408408;  // of the standard normal distribution
  const double variance = 2 / (9 * freedom);
  const double root = 1 - variance + kQuantile * std::sqrt(variance);
  return root * root * root;
}

/// The geometry under which the body saw a bin.
struct UncertaintyMap::Sight {
  Vector<DemFrame> lever;    ///< from the body's origin to (X, Y, z_est)
  Direction<DemFrame> beam;  ///< the same direction, of length 1
  TimedPose pose;
};

UncertaintyMap::UncertaintyMap(const WeightedMeanAccumulator& bins, const MomentAccumulator& moments,
                               const Grid<Slope>& slopes, const PoseTrack& poses,
                               const UncertaintyParameters& parameters, const ProgressCallback& progress)
    : bins_(bins), moments_(moments), slopes_(slopes), poses_(poses), parameters_(parameters) {
  check(parameters_);
  const auto empty = [&] { return Grid<float>(bins.spec(), std::numeric_limits<float>::quiet_NaN()); };
  misfit_ = empty();
  Grid<float> scatter = empty();
  Grid<float> freedom = empty();
  const auto compare_with_noise = [&](BinIndex bin) {
    const double noise = noise_variance(bin);
    misfit_.at(bin) = static_cast<float>(misfit_beyond(noise, bin));
    scatter.at(bin) = static_cast<float>(scatter_beyond(noise, bin));
    if (!std::isnan(noise)) freedom.at(bin) = static_cast<float>(1 / sum_of_squared_weights(bin) - 1);
  };
  for_each_filled_bin(bins_, compare_with_noise, [&](double done) { report(progress, done / 2); });
  roughness_ = empty();
  const auto pool = [&](BinIndex bin) {
    const double returns = window_sum(freedom, bin);
    roughness_.at(bin) =
        returns > 0 ? static_cast<float>(std::max(0.0, window_sum(scatter, bin) / returns)) : 0.0F;
    if (misfit_.at(bin) > 0) misfit_.at(bin) *= static_cast<float>(crowding_factor(relative_count(bin)));
  };
  for_each_filled_bin(bins_, pool, [&](double done) { report(progress, 0.5 + done / 2); });
}

UncertaintyMap::Sight UncertaintyMap::sight(BinIndex bin) const {
  const GridSpec& spec = bins_.spec();
  const BinSums& sums = bins_.bins()[spec.index(bin)];
  Sight sight;
  sight.pose = poses_.at(sums.w_t / sums.weight);
  const Point<DemFrame> point{{spec.x(bin.col), spec.y(bin.row), sums.z_first + sums.w_dz / sums.weight}};
  sight.lever = point - sight.pose.position;
  sight.beam = Direction<DemFrame>::of(sight.lever);
  return sight;
}

double UncertaintyMap::sum_of_squared_weights(BinIndex bin) const {
  const std::size_t i = bins_.spec().index(bin);
  const BinSums& sums = bins_.bins()[i];
  return sums.count == 1 ? 1 : moments_.bins()[i].w_w / (sums.weight * sums.weight);
}

/// The variance that range noise gives the elevation of a single return.
double UncertaintyMap::noise_variance(BinIndex bin) const {
  const Slope g = slopes_.at(bin);
  const double noise = parameters_.range_sigma_m * Eigen::Vector3d(-g.x, -g.y, 1).dot(sight(bin).beam.v);
  return noise * noise;
}

/// tau^2. Range noise gives the centroid of a bin of weight W the variance noise sum w_k^2, and the centroids
/// together, weighted by W, the mean square noise sum (W sum w_k^2) / sum W; the fit of a plane to n
/// centroids leaves (n - 3) / n of it.
double UncertaintyMap::misfit_beyond(double noise, BinIndex bin) const {
  const PlaneFit plane = fit_plane(bins_, bin);
  const int freedom = plane.bins - 3;
  if (freedom < 1) return 0;  // three centroids always lie in a plane
  double weight = 0;
  double weighted = 0;
  for_each_in_window(bins_.spec(), bin, plane.radius, [&](BinIndex other) {
    const BinSums& sums = bins_.bins()[bins_.spec().index(other)];
    if (sums.count == 0) return;
    weight += sums.weight;
    weighted += sums.weight * sum_of_squared_weights(other);
  });
  const double expected = noise * weighted / weight;
  const double misfit = plane.misfit_m2 * plane.bins / freedom;
  return misfit > expected * mean_square_ratio_p99(freedom) ? misfit - expected : 0;
}

/// sum w_k (z_k - plane)^2 over the normalised weights; the plane goes through the centroid with the slope.
double UncertaintyMap::scatter_about_slope(BinIndex bin) const {
  const GridSpec& spec = bins_.spec();
  const BinSums& sums = bins_.bins()[spec.index(bin)];
  if (sums.count == 1) return 0;  // rounding must not give a single return a scatter
  const BinMoments& m = moments_.bins()[spec.index(bin)];
  const double w = sums.weight;
  const double dx = sums.w_x_est / w - spec.x(bin.col);
  const double dy = sums.w_y_est / w - spec.y(bin.row);
  const double dz = sums.w_dz / w;
  const double gx = slopes_.at(bin).x;
  const double gy = slopes_.at(bin).y;
  const double zz = sums.w_dz_dz / w - dz * dz;
  const double along = gx * (m.w_dx_dz / w - dx * dz) + gy * (m.w_dy_dz / w - dy * dz);
  const double plane = gx * gx * (m.w_dx_dx / w - dx * dx) + 2 * gx * gy * (m.w_dx_dy / w - dx * dy) +
                       gy * gy * (m.w_dy_dy / w - dy * dy);
  return zz - 2 * along + plane;
}

double UncertaintyMap::relative_count(BinIndex bin) const {
  double count = 0;
  double filled = 0;
  for_each_in_window(bins_.spec(), bin, kRoughnessRadius, [&](BinIndex other) {
    const auto returns = static_cast<double>(bins_.bins()[bins_.spec().index(other)].count);
    count += returns;
    filled += returns > 0 ? 1 : 0;
  });
  return static_cast<double>(bins_.bins()[bins_.spec().index(bin)].count) * filled / count;
}

/// The returns of one bin scatter by (1 - sum w_k^2) of the variance of a single return, including noise. The
/// excess over noise, pooled over the window with weights N_eff, is rho^2.
double UncertaintyMap::scatter_beyond(double noise, BinIndex bin) const {
  const double w_w = sum_of_squared_weights(bin);
  return (scatter_about_slope(bin) - noise * (1 - w_w)) / w_w;
}

double UncertaintyMap::navigation_variance(const Sight& sight, const Eigen::Vector3d& J) const {
  const NavigationSigma& sigma = parameters_.navigation;
  const double t2 = sight.pose.since_start_s * sight.pose.since_start_s;
  const Eigen::Vector3d arm = sight.pose.attitude.m.transpose() * sight.lever.v.cross(J);
  return squares(J).dot(squares(sigma.position_m.v) + t2 * squares(sigma.velocity_mps.v)) +
         squares(arm).dot(squares(angles(sigma.rpy_rad)) + t2 * squares(angles(sigma.rpy_rate_radps)));
}

BinVariances UncertaintyMap::variances(BinIndex bin) const { return variances(bin, sight(bin)); }

BinVariances UncertaintyMap::variances(BinIndex bin, const Sight& seen) const {
  const Slope g = slopes_.at(bin);
  const Eigen::Vector3d J(-g.x, -g.y, 1);
  const double s = bins_.spec().resolution_m;
  const double count = bins_.bins()[bins_.spec().index(bin)].count;
  const double w_w = sum_of_squared_weights(bin);
  const double noise = parameters_.range_sigma_m * J.dot(seen.beam.v);
  const double unknown = std::isnan(g.x) ? kNan : 0;
  return {.range = noise * noise * w_w,
          .quant = (double{g.x} * g.x + double{g.y} * g.y) * s * s * quantisation_factor(count) / count,
          .rough = roughness_.at(bin) * w_w + unknown,
          .misfit = misfit_.at(bin) * misfit_factor(count),
          .navigation = navigation_variance(seen, J)};
}

double UncertaintyMap::horizontal_variance(BinIndex bin, const Sight& seen) const {
  const double s = bins_.spec().resolution_m;
  const double count = bins_.bins()[bins_.spec().index(bin)].count;
  const Eigen::Vector3d n = seen.beam.v;
  const double noise = parameters_.range_sigma_m * parameters_.range_sigma_m * sum_of_squared_weights(bin) *
                       (n.x() * n.x() + n.y() * n.y()) / 2;
  return s * s * quantisation_factor(count) / count + noise +
         (navigation_variance(seen, Eigen::Vector3d::UnitX()) +
          navigation_variance(seen, Eigen::Vector3d::UnitY())) /
             2;
}

BinSigmas UncertaintyMap::sigmas(BinIndex bin) const {
  if (bins_.bins()[bins_.spec().index(bin)].count == 0) return {};
  const Sight seen = sight(bin);
  const BinVariances v = variances(bin, seen);
  const double local = v.range + v.rough + v.misfit;
  return {.z_abs = std::sqrt(local + v.quant + v.navigation),
          .z_rel = std::sqrt(local + v.quant),
          .z_noise = std::sqrt(v.range + (v.misfit > 0 ? 0 : v.quant)),
          .corrected_abs = std::sqrt(local + v.navigation),
          .corrected_rel = std::sqrt(local),
          .xy = std::sqrt(horizontal_variance(bin, seen))};
}

}  // namespace landfall
