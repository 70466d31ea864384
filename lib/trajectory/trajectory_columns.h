// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/number_table.h"
#include "trajectory/table_trajectory.h"

namespace landfall {

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
