// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

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
  double navigation = 0;
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
/// navigation = J (Sigma_p + t^2 Sigma_v) J^T + a^T (Sigma_th + t^2 Sigma_w) a, a = R^T (r x J).
///
/// Every part is NaN where the bin is empty or has no slope.
class UncertaintyMap {
 public:
  /// All four arguments belong to one grid and one set of returns, and outlive the map. 4 bytes per bin, 12
  /// during construction.
  UncertaintyMap(const WeightedMeanAccumulator& bins, const MomentAccumulator& moments,
                 const Grid<Slope>& slopes, const PoseTrack& poses, const UncertaintyParameters& parameters,
                 const ProgressCallback& progress = {});

  /// The bin must hold a return.
  [[nodiscard]] BinVariances variances(BinIndex bin) const;

  // One sigma, metres; NaN in an empty bin.

  /// sqrt(range + quant + rough + navigation) and sqrt(range + quant + rough): navigation errors move a whole
  /// footprint alike.
  [[nodiscard]] double z_sigma_abs(BinIndex bin) const;
  [[nodiscard]] double z_sigma_rel(BinIndex bin) const;
  /// The same for z_corrected: without quant.
  [[nodiscard]] double z_corrected_sigma_abs(BinIndex bin) const;
  [[nodiscard]] double z_corrected_sigma_rel(BinIndex bin) const;
  /// Of the horizontal error x_true - X along one axis: the root of the mean of the variances in x and in y,
  /// each s^2 k(N) / N + sigma_r^2 n_x^2 sum w_k^2 + navigation with J = (1, 0, 0). It needs no slope.
  [[nodiscard]] double xy_sigma(BinIndex bin) const;

 private:
  struct Sight;
  [[nodiscard]] Sight sight(BinIndex bin) const;
  [[nodiscard]] double sum_of_squared_weights(BinIndex bin) const;
  [[nodiscard]] double scatter_about_slope(BinIndex bin) const;
  [[nodiscard]] double navigation_variance(const Sight& sight, const Eigen::Vector3d& J) const;
  [[nodiscard]] double horizontal_variance(BinIndex bin) const;
  [[nodiscard]] Grid<float> roughness(const ProgressCallback& progress) const;
  [[nodiscard]] bool is_empty(BinIndex bin) const;

  const WeightedMeanAccumulator& bins_;
  const MomentAccumulator& moments_;
  const Grid<Slope>& slopes_;
  const PoseTrack& poses_;
  UncertaintyParameters parameters_;
  Grid<float> roughness_;  ///< rho^2
};

/// k of the quantisation term: a return may lie anywhere in its bin, so the mean of N returns with the
/// weights of Eq. 9 misses the centre by s^2 k / N on each axis. Exact for N = 1 (1/12) and N -> infinity
/// (1792/29160), within 0.3 % between.
[[nodiscard]] double quantisation_factor(double count);

}  // namespace landfall
