// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <limits>

#include "base/progress.h"
#include "geometry/frames.h"
#include "geometry/rotation.h"
#include "gridding/moment_accumulator.h"
#include "gridding/pose_track.h"
#include "gridding/slope.h"

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

/// The parts of a bin's error variance, m^2.
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
  /// sqrt(range + quant + rough + misfit + navigation), and without navigation, whose errors move a whole
  /// footprint alike.
  double z_abs = kUnknown;
  double z_rel = kUnknown;
  /// The part that is independent from bin to bin: sqrt(range + quant), and sqrt(range) where misfit > 0,
  /// because there quant measures the relief.
  double z_noise = kUnknown;
  /// The same for z_corrected: without quant.
  double z_corrected_abs = kUnknown;
  double z_corrected_rel = kUnknown;
  /// The sigma of the horizontal error x_true - X along one axis: the root of the mean of the variances in x
  /// and in y, each s^2 k(N) / N + sigma_r^2 n_x^2 sum w_k^2 + navigation with J = (1, 0, 0).
  double xy = kUnknown;
};

/// The 1-sigma of a DEM's cells for a map reader: of e = H(X, Y) - z_est, the terrain under the bin's centre
/// minus the map. docs/user/uncertainty.md derives it.
///
/// With the slope g, J = (-g_x, -g_y, 1), the normalised weights w_k of the bin's N returns, the mean time t
/// since the scan began, r the bin (X, Y, z_est) seen from the BODY's estimated origin at that time (attitude
/// errors turn the map about it, and the arm of the lidar's mount is part of r), R the estimated attitude,
/// and n = r / |r| the direction of the beam (neglecting the mount's arm, metres against hundreds), the
/// variances are:
///
/// range = sigma_r^2 (J . n)^2 sum w_k^2.
///
/// quant = |g|^2 s^2 k(N) / N: the centroid of the returns is not the bin's centre.
///
/// rough = rho^2 sum w_k^2, for relief finer than a bin. Over the 7 x 7 bins around,
/// rho^2 = max(0, sum N_eff (S - sigma_r^2 (J . n)^2 (1 - sum w_k^2)) / sum (N_eff - 1)), N_eff = 1 / sum
/// w_k^2, S = sum w_k (z_k - plane)^2 about a bin's own slope through its centroid.
///
/// misfit = tau^2 misfit_factor(N) crowding_factor(N / mean N), for terrain around the bin that is not a
/// plane. tau^2 is the excess over range noise of the plane's misfit (PlaneFit); 0 where noise alone exceeds
/// this misfit in more than 1 of 100 cases. The mean is that of the filled bins among the 7 x 7 around.
///
/// navigation = J (Sigma_p + t^2 Sigma_v) J^T + a^T (Sigma_th + t^2 Sigma_w) a, a = R^T (r x J).
///
/// Every part is NaN where the bin is empty or has no slope.
class UncertaintyMap {
 public:
  /// All four arguments belong to one grid and one set of returns, and outlive the map. 8 bytes per bin, 16
  /// during construction.
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
/// weights of Eq. 9 misses the centre by s^2 k / N on each axis. Exact for N = 1 (1/12) and N -> infinity
/// (1792/29160), within 0.3 % between.
[[nodiscard]] double quantisation_factor(double count);

/// The variance of the error of a bin of N returns, after the correction by the slope, over the plane's
/// square misfit, where a straight step runs through the bins: in any direction, at any distance, over
/// terrain that is bilinear between the bin centres. Within 2 % of random steps for 1 to 12 returns.
[[nodiscard]] double misfit_factor(double count);

/// More of the returns fall into the bins that hold the steep faces of a rock, where the error is largest,
/// and fewer beside them: max(0.6, q)^1.2 for a bin of q times the mean count. Fitted to rocks under seven
/// scans of 1 to 14 returns per bin (docs/user/uncertainty.md).
[[nodiscard]] double crowding_factor(double relative_count);

/// The ratio of a mean square of `freedom` independent normal errors to its expectation that 1 of 100
/// exceeds: Wilson and Hilferty's approximation of chi^2_0.99 / freedom, within 1 % of it.
[[nodiscard]] double largest_chance_ratio(double freedom);

}  // namespace landfall
