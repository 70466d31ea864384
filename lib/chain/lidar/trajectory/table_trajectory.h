// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "base/text/number_table.h"
#include "chain/lidar/trajectory/trajectory.h"

namespace landfall {

/// One row of a trajectory table.
struct TrajectorySample {
  double t_s = 0;  ///< on any clock
  Point<DemFrame> position_m{};
  /// D <- B, Hamilton; note that Eigen's constructor takes (w, x, y, z).
  Eigen::Quaterniond attitude = Eigen::Quaterniond::Identity();
  std::optional<Vector<DemFrame>> velocity_mps{};  ///< empty: computed from the positions
};

/// A sampled trajectory, for example exported by another simulator. It passes through every sample:
/// - positions by cubic Hermite pieces. The slope at a sample is its velocity where it has one, otherwise
///   the slope of the parabola through it and its two neighbours (at an end: through the last three samples),
///   for any spacing of the times.
///   Motion that is quadratic in time (with velocities: cubic) is reproduced to rounding; two samples without
///   velocities give a straight line.
/// - attitudes by slerp between neighbours, the shortest way: constant body rate from sample to sample.
class TableTrajectory : public Trajectory {
 public:
  /// The epoch is the first row's time; from here on, only differences from it are used. These must increase
  /// strictly, all numbers must be finite, no velocity may exceed that of light, and the norm of a quaternion
  /// must be within 1e-3 of 1 (it is then normalised); at least 2 rows. Throws FormatError otherwise; the
  /// message begins with `name` and names the row counted from 1.
  explicit TableTrajectory(std::vector<TrajectorySample> samples, std::string name = "trajectory table");

  /// A time that lies up to 1 ns outside the table counts as its end: pulse times are rounded.
  [[nodiscard]] Pose pose(double t_s) const override;
  [[nodiscard]] double epoch_s() const override { return epoch_s_; }
  [[nodiscard]] double end_time_s() const override { return samples_.back().t_s; }

 private:
  std::string name_;
  double epoch_s_;
  std::vector<TrajectorySample> samples_;  ///< with times since the epoch
  std::vector<Vector<DemFrame>> slopes_mps_;
};

/// The columns of a trajectory table: t_s and x_m, y_m, z_m (of the body, in D); optionally vx_mps, vy_mps,
/// vz_mps (in D); and the attitude in one of these forms:
/// - qw, qx, qy, qz: quaternion D <- B, Hamilton, scalar first;
/// - roll_deg, pitch_deg, yaw_deg: R_dem_body = Rz(yaw) Ry(pitch) Rx(roll);
/// - mrp_1, mrp_2, mrp_3: Modified Rodrigues Parameters sigma_BN, N being D
///   (Schaub and Junkins 2018, Eq. 3.151):
///   sigma = e tan(angle/4), e the axis about which N turns into B. A set and its shadow set,
///   -sigma/|sigma|^2, are the same attitude and may change from row to row.
[[nodiscard]] const TableColumns& trajectory_columns();

/// The rows of a table read with trajectory_columns(). Throws FormatError, beginning with the file's name,
/// where the attitude is missing or given twice, or where only some columns of a group are present.
[[nodiscard]] std::vector<TrajectorySample> trajectory_samples(const NumberTable& table);

}  // namespace landfall
