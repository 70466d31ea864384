// SPDX-License-Identifier: GPL-3.0-or-later
#include "gridding/bin_accumulator.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace landfall {
namespace {

static_assert(sizeof(BinSums) == 80);

/// 1 - |u - n|, n the whole number nearest to u, which is the centre of a bin the grid has.
double nearness(double u) {
  const auto cut = static_cast<double>(static_cast<std::int64_t>(u + 0.5));
  return 1 - std::abs(u - (cut > u + 0.5 ? cut - 1 : cut));
}

double z_spread(const BinSums& sums) {
  const double mean_dz = sums.w_dz / sums.weight;
  // Rounding can leave a tiny negative number where all returns are equal.
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
          .z_spread = z_spread(sums)};
}

void add_return(const GridPoints& points, std::size_t i, double weight, BinSums& bin) {
  BinSums sums =
      bin;  // a copy may stay in registers: columns and bins could overlap for all the compiler knows
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

BinAccumulator::BinAccumulator(const GridSpec& spec, Weights weights)
    : Accumulator(spec), weights_(weights), bins_(spec.size()), nearest_(spec) {}

void BinAccumulator::add(const GridPoints& points, std::int64_t first_row_number) {
  const std::span<BinSums> bins = bins_.values();
  const bool equal = weights_ == Weights::equal;
  const std::size_t outside = nearest_.for_each(
      points, first_row_number,
      [=](const GridSpec& spec, const GridPoints& piece, std::size_t i, std::size_t bin) {
        const double s = spec.resolution_m;
        const double weight = equal ? 1.0 : nearness(piece.x_est[i] / s) * nearness(piece.y_est[i] / s);
        add_return(piece, i, weight, bins[bin]);
      });
  count_points(points.size(), outside);
}

void BinAccumulator::values(BinIndex first, std::span<BinValues> out) const {
  const std::span<const BinSums> sums = bins().subspan(spec().index(first), out.size());
  std::ranges::transform(sums, out.begin(), values_of);
}

}  // namespace landfall
