// SPDX-License-Identifier: GPL-3.0-or-later
#include "gridding/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/error.h"
#include "base/number_text.h"
#include "base/parallel.h"

namespace landfall {
namespace {

constexpr std::size_t kRowsPerPiece = 16;
constexpr std::int64_t kRoughnessRadius = 3;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Eigen::Vector3d squares(const Eigen::Vector3d& v) { return v.cwiseAbs2(); }

Eigen::Vector3d angles(const RollPitchYaw& rpy) { return {rpy.roll_rad, rpy.pitch_rad, rpy.yaw_rad}; }

void check_sigmas(const std::string& key, const Eigen::Vector3d& sigmas) {
  for (const double sigma : sigmas)
    if (!std::isfinite(sigma) || sigma < 0)
      throw UsageError(key + ": " + number_text(sigma) + " is not finite and at least 0");
}

/// value(bin) of every bin that holds a return; NaN in the others.
template <class Value>
Grid<float> filled_bins(const WeightedMeanAccumulator& bins, Value value,
                        const ProgressCallback& progress = {}) {
  const GridSpec& spec = bins.spec();
  Grid<float> layer(spec, std::numeric_limits<float>::quiet_NaN());
  const auto fill = [&](std::size_t begin, std::size_t end) {
    for (auto row = static_cast<std::int64_t>(begin); row < static_cast<std::int64_t>(end); ++row)
      for (std::int64_t col = 0; col < spec.cols; ++col)
        if (bins.bins()[spec.index({row, col})].count > 0)
          layer.at({row, col}) = static_cast<float>(value(BinIndex{row, col}));
  };
  parallel_for(static_cast<std::size_t>(spec.rows), kRowsPerPiece, fill, progress);
  return layer;
}

/// The sum over the bins within kRoughnessRadius; NaN is skipped.
double window_sum(const Grid<float>& layer, BinIndex middle) {
  double sum = 0;
  const GridSpec& spec = layer.spec();
  for (std::int64_t row = std::max<std::int64_t>(0, middle.row - kRoughnessRadius);
       row <= std::min(spec.rows - 1, middle.row + kRoughnessRadius); ++row)
    for (std::int64_t col = std::max<std::int64_t>(0, middle.col - kRoughnessRadius);
         col <= std::min(spec.cols - 1, middle.col + kRoughnessRadius); ++col) {
      const double value = layer.at({row, col});
      if (!std::isnan(value)) sum += value;
    }
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
  roughness_ = roughness(progress);
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

/// The returns of one bin scatter by (1 - sum w_k^2) of the variance of a single return, including range
/// noise (J . n)^2 sigma_r^2. The excess over this noise, pooled over the window with weights N_eff, is the
/// variance of the relief.
Grid<float> UncertaintyMap::roughness(const ProgressCallback& progress) const {
  const auto excess_of = [&](BinIndex bin) {
    const Slope g = slopes_.at(bin);
    const double noise = parameters_.range_sigma_m * Eigen::Vector3d(-g.x, -g.y, 1).dot(sight(bin).beam.v);
    const double w_w = sum_of_squared_weights(bin);
    return (scatter_about_slope(bin) - noise * noise * (1 - w_w)) / w_w;
  };
  const auto freedom_of = [&](BinIndex bin) {
    return std::isnan(slopes_.at(bin).x) ? kNan : 1 / sum_of_squared_weights(bin) - 1;
  };
  const Grid<float> excess = filled_bins(bins_, excess_of, [&](double done) { report(progress, done / 2); });
  const Grid<float> freedom = filled_bins(bins_, freedom_of);
  const auto pooled = [&](BinIndex bin) {
    const double returns = window_sum(freedom, bin);
    return returns > 0 ? std::max(0.0, window_sum(excess, bin) / returns) : 0;
  };
  return filled_bins(bins_, pooled, [&](double done) { report(progress, 0.5 + done / 2); });
}

double UncertaintyMap::navigation_variance(const Sight& sight, const Eigen::Vector3d& J) const {
  const NavigationSigma& sigma = parameters_.navigation;
  const double t2 = sight.pose.since_start_s * sight.pose.since_start_s;
  const Eigen::Vector3d arm = sight.pose.attitude.m.transpose() * sight.lever.v.cross(J);
  return squares(J).dot(squares(sigma.position_m.v) + t2 * squares(sigma.velocity_mps.v)) +
         squares(arm).dot(squares(angles(sigma.rpy_rad)) + t2 * squares(angles(sigma.rpy_rate_radps)));
}

BinVariances UncertaintyMap::variances(BinIndex bin) const {
  const Slope g = slopes_.at(bin);
  const Eigen::Vector3d J(-g.x, -g.y, 1);
  const Sight seen = sight(bin);
  const double s = bins_.spec().resolution_m;
  const double count = bins_.bins()[bins_.spec().index(bin)].count;
  const double w_w = sum_of_squared_weights(bin);
  const double noise = parameters_.range_sigma_m * J.dot(seen.beam.v);
  const double unknown = std::isnan(g.x) ? kNan : 0;
  return {.range = noise * noise * w_w,
          .quant = (double{g.x} * g.x + double{g.y} * g.y) * s * s * quantisation_factor(count) / count,
          .rough = roughness_.at(bin) * w_w + unknown,
          .navigation = navigation_variance(seen, J)};
}

double UncertaintyMap::horizontal_variance(BinIndex bin) const {
  const Sight seen = sight(bin);
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

bool UncertaintyMap::is_empty(BinIndex bin) const { return bins_.bins()[bins_.spec().index(bin)].count == 0; }

double UncertaintyMap::z_sigma_abs(BinIndex bin) const {
  if (is_empty(bin)) return kNan;
  const BinVariances v = variances(bin);
  return std::sqrt(v.range + v.quant + v.rough + v.navigation);
}

double UncertaintyMap::z_sigma_rel(BinIndex bin) const {
  if (is_empty(bin)) return kNan;
  const BinVariances v = variances(bin);
  return std::sqrt(v.range + v.quant + v.rough);
}

double UncertaintyMap::z_corrected_sigma_abs(BinIndex bin) const {
  if (is_empty(bin)) return kNan;
  const BinVariances v = variances(bin);
  return std::sqrt(v.range + v.rough + v.navigation);
}

double UncertaintyMap::z_corrected_sigma_rel(BinIndex bin) const {
  if (is_empty(bin)) return kNan;
  const BinVariances v = variances(bin);
  return std::sqrt(v.range + v.rough);
}

double UncertaintyMap::xy_sigma(BinIndex bin) const {
  return is_empty(bin) ? kNan : std::sqrt(horizontal_variance(bin));
}

}  // namespace landfall
