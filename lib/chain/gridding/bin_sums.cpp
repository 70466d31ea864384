// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D4, D41, D42
#include "chain/gridding/bin_sums.h"

#include <algorithm>
#include <cmath>

namespace landfall {
namespace {

double spread_of(const BinSums& sums) {
  const double mean_dz = sums.w_dz / sums.weight;
  // Rounding can give a tiny negative number where all returns are equal.
  return std::sqrt(std::max(0.0, sums.w_dz_dz / sums.weight - mean_dz * mean_dz));
}

}  // namespace

BinValues values_of(const BinSums& sums) {
  if (sums.count == 0) return empty_bin();
  const double w = sums.weight;
  return {.count = sums.count,
          .weight_sum = w,
          .z_est = sums.z_first + sums.w_dz / w,
          .x_true = sums.w_x_true / w,
          .y_true = sums.w_y_true / w,
          .x_est = sums.w_x_est / w,
          .y_est = sums.w_y_est / w,
          .x_offset = (sums.w_x_true - sums.w_x_est) / w,
          .y_offset = (sums.w_y_true - sums.w_y_est) / w,
          .t = sums.w_t / w,
          .spread = spread_of(sums)};
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
