// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <limits>

#include "base/core/progress.h"
#include "base/geometry/frames.h"
#include "base/geometry/rotation.h"
#include "chain/gridding/moment_accumulator.h"
#include "chain/gridding/pose_track.h"
#include "chain/gridding/slope.h"

namespace landfall {

/// One sigma of each navigation error of Eq. 6, per axis; the axes are independent.
struct NavigationSigma {
  Vector<DemFrame> position_m{};
  Vector<DemFrame> velocity_mps{};
  RollPitchYaw rpy_rad{};  ///< about the body's axes
  RollPitchYaw rpy_rate_radps{};
};

/// The errors that the uncertainty map assumes.
struct UncertaintyParameters {
  double range_sigma_m = 0;
  NavigationSigma navigation = {};
};

/// Throws UsageError, naming the key, where a sigma is negative or not finite.
void check(const UncertaintyParameters& parameters);

/// The parts of a bin's error variance, m^2 (UncertaintyMap).
struct BinVariances {
  double range = 0;
  double quant = 0;
  double rough = 0;
  double misfit = 0;
  double navigation = 0;
};

/// One sigma, metres; NaN in an empty bin and, except xy, where there is no slope.
struct BinSigmas {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  double z_abs = kUnknown;  ///< sqrt(range + quant + rough + misfit + navigation)
  /// The same without navigation, whose errors move a whole footprint alike.
  double z_rel = kUnknown;
  /// The part that is independent from bin to bin: sqrt(range + quant), and sqrt(range) where misfit > 0,
  /// because there quant measures the relief.
  double z_noise = kUnknown;
  /// z_abs and z_rel of the corrected elevation (slope.h): without quant.
  double corrected_abs = kUnknown;
  double corrected_rel = kUnknown;
  /// The sigma of the horizontal error x_true - X along one axis: the root of the mean of the variances in x
  /// and in y, each s^2 k(N) / N + sigma_r^2 n_x^2 sum w_k^2 + navigation with J = (1, 0, 0).
  double xy = kUnknown;
};

/// One sigma of the error e = H(X, Y) - z_est of each bin: the true elevation at the bin's centre (X, Y)
/// minus the map. docs/user/uncertainty.md derives the variances below, in which
///   s is the edge of the bin, N the number of its returns, w_k their normalised weights,
///   N_eff = 1 / sum w_k^2, g the slope (slope.h) and J = (-g_x, -g_y, 1);
///   t is the mean time of the returns since the scan began, R the body's estimated attitude at t;
///   r is (X, Y, z_est) seen from the body's estimated origin at t, about which attitude errors turn the map;
///   n = r / |r| approximates the beam's direction (the mount's lever arm is metres, r hundreds of metres);
///   sigma_r is the range noise, Sigma_p, Sigma_v, Sigma_th and Sigma_w are the covariances of the errors of
///   position, velocity, attitude and attitude rate.
///
/// range = sigma_r^2 (J . n)^2 sum w_k^2.
///
/// quant = |g|^2 s^2 k(N) / N, k = quantisation_factor: the centroid of the returns is not the bin's centre.
///
/// rough = rho^2 sum w_k^2, for relief finer than a bin. Over the 7 x 7 bins around,
/// rho^2 = max(0, sum N_eff (S - sigma_r^2 (J . n)^2 (1 - sum w_k^2)) / sum (N_eff - 1)), where S = sum w_k
/// (z_k - plane)^2, the plane through a bin's centroid with the bin's slope.
///
/// misfit = tau^2 misfit_factor(N) crowding_factor(N / mean N), for terrain around the bin that is not a
/// plane; the mean is over the filled bins of the 7 x 7 around. tau^2 is the excess of the plane's misfit
/// (PlaneFit) over that of range noise; 0 if noise alone gives such a misfit in more than 1 of 100 cases.
///
/// navigation = J (Sigma_p + t^2 Sigma_v) J^T + a^T (Sigma_th + t^2 Sigma_w) a, a = R^T (r x J).
///
/// In a bin without a slope, misfit is 0 and the others are NaN.
class UncertaintyMap {
 public:
  /// The first four arguments belong to one grid and one set of returns, and must outlive the map. Takes 8
  /// bytes per bin, 16 during construction. Throws as check().
  UncertaintyMap(const WeightedMeanAccumulator& bins, const MomentAccumulator& moments,
                 const Grid<Slope>& slopes, const PoseTrack& poses, const UncertaintyParameters& parameters,
                 const ProgressCallback& progress = {});

  /// The bin must hold a return.
  [[nodiscard]] BinVariances variances(BinIndex bin) const;

  [[nodiscard]] BinSigmas sigmas(BinIndex bin) const;

 private:
  struct Sight;
  [[nodiscard]] Sight sight(BinIndex bin) const;
  [[nodiscard]] double sum_of_squared_weights(BinIndex bin) const;
  [[nodiscard]] double noise_variance(BinIndex bin) const;
  [[nodiscard]] double misfit_beyond(double noise, BinIndex bin) const;
  /// N over the mean N of the filled bins around.
  [[nodiscard]] double relative_count(BinIndex bin) const;
  [[nodiscard]] double scatter_about_slope(BinIndex bin) const;
  [[nodiscard]] double scatter_beyond(double noise, BinIndex bin) const;
  [[nodiscard]] double navigation_variance(const Sight& sight, const Eigen::Vector3d& J) const;
  [[nodiscard]] BinVariances variances(BinIndex bin, const Sight& seen) const;
  [[nodiscard]] double horizontal_variance(BinIndex bin, const Sight& seen) const;

  const WeightedMeanAccumulator& bins_;
  const MomentAccumulator& moments_;
  const Grid<Slope>& slopes_;
  const PoseTrack& poses_;
  UncertaintyParameters parameters_;
  Grid<float> misfit_;     ///< tau^2 crowding_factor
  Grid<float> roughness_;  ///< rho^2
};

/// k of the quantisation term: a return may lie anywhere in its bin, so the mean of N returns with the
/// weights of Eq. 9 has the variance s^2 k / N about the centre on each axis. Exact for N = 1 (1/12) and N ->
/// infinity (1792/29160), within 0.3 % between.
[[nodiscard]] double quantisation_factor(double count);

/// The mean square error of a bin of N returns, after the correction by the slope, over the mean square
/// misfit of the plane, where a straight step runs through the bins in any direction and at any distance, and
/// the terrain is bilinear between the bin centres. Within 2 % of random steps for 1 to 12 returns.
[[nodiscard]] double misfit_factor(double count);

/// max(0.6, q)^1.2 for a bin with q times the mean number of returns: more returns fall into the bins that
/// hold a steep face of a rock, where the error is largest, and fewer next to them. Fitted to rocks under
/// seven scans of 1 to 14 returns per bin (docs/user/uncertainty.md).
[[nodiscard]] double crowding_factor(double relative_count);

/// The 0.99 quantile of chi^2 / freedom: of the mean square of `freedom` independent normal errors over its
/// expectation. Wilson and Hilferty's approximation, within 1 %.
[[nodiscard]] double mean_square_ratio_p99(double freedom);

}  // namespace landfall
