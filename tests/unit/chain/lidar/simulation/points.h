// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "chain/lidar/simulation/pulse_batch.h"

namespace landfall {

/// The true point of a row, metres, DEM frame.
inline Eigen::Vector3d true_point(const PulseBatch& batch, std::size_t i) {
  return {batch.points.x_true[i], batch.points.y_true[i], batch.points.z_true[i]};
}

/// The estimated point of a row, metres, DEM frame.
inline Eigen::Vector3d estimated_point(const PulseBatch& batch, std::size_t i) {
  return {batch.points.x_est[i], batch.points.y_est[i], batch.points.z_est[i]};
}

}  // namespace landfall
