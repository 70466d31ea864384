// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D4, D41, D42
#include "chain/gridding/bin_sums.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace landfall {

BinValues values_of(const BinSums& sums) {
  if (sums.count == 0) return empty_bin();
  // Two divisions at a time: each takes as long as one.
  using Eight = Eigen::Array<double, 8, 1>;
  using Two = Eigen::Array<double, 2, 1>;
  const double w = sums.weight;
  const Eight means = Eight::Map(&sums.weight) / w;
  const Two offset = (Two::Map(&sums.w_x_true) - Two::Map(&sums.w_x_est)) / w;
  const double dz = means[1];
  // Rounding can give a tiny negative number where all returns are equal.
  const double variance = std::max(0.0, means[2] - dz * dz);
  return {.count = sums.count,
          .weight_sum = w,
          .z_est = sums.z_first + dz,
          .x_true = means[3],
          .y_true = means[4],
          .x_est = means[5],
          .y_est = means[6],
          .x_offset = offset[0],
          .y_offset = offset[1],
          .t = means[7],
          .spread = std::sqrt(variance)};
}

void add_return(const GridPoints& points, std::size_t i, double weight, BinSums& bin) {
  BinSums sums =
      bin;  // a copy can stay in registers: the compiler cannot rule out that columns and bins overlap
  const double z = points.z_est[i];
  if (sums.count == 0) sums.z_first = z;
  const double dz = z - sums.z_first;
  sums.weight += weight;
  sums.w_dz += weight * dz;
  sums.w_dz_dz += weight * dz * dz;
  sums.w_x_true += weight * points.x_true[i];
  sums.w_y_true += weight * points.y_true[i];
  sums.w_x_est += weight * points.x_est[i];
  sums.w_y_est += weight * points.y_est[i];
  sums.w_t += weight * points.t[i];
  ++sums.count;
  bin = sums;
}

}  // namespace landfall
