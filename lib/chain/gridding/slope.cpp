// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D59, D256, D257
#include "chain/gridding/slope.h"

#include <algorithm>
#include <cmath>

#include "base/core/parallel.h"
#include "base/numerics/portable_math.h"

namespace landfall {
namespace {

constexpr std::size_t kSlopeRows = 16;
constexpr std::int64_t kLargestRadius = 3;
constexpr int kEnoughBins = 6;
constexpr int kFewestBins = 3;
constexpr double kSmallestScatter = 0.1;  // in s^2

/// Weighted sums over the centroids of a window, in units of s, relative to the middle bin: x, y in bins.
struct PlaneSums {
  int bins = 0;
  double w = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0, zz = 0;

  void add(double weight, double dx, double dy, double dz) {
    ++bins;
    w += weight;
    x += weight * dx;
    y += weight * dy;
    z += weight * dz;
    xx += weight * dx * dx;
    xy += weight * dx * dy;
    yy += weight * dy * dy;
    xz += weight * dx * dz;
    yz += weight * dy * dz;
    zz += weight * dz * dz;
  }
};

PlaneSums window_sums(const WeightedMeanAccumulator& bins, BinIndex middle, std::int64_t radius) {
  const GridSpec& spec = bins.spec();
  const BinSums& origin = bins.bins()[spec.index(middle)];
  const double z_origin = origin.z_first + origin.w_dz / origin.weight;
  PlaneSums sums;
  for (std::int64_t row = std::max<std::int64_t>(0, middle.row - radius);
       row <= std::min(spec.rows - 1, middle.row + radius); ++row)
    for (std::int64_t col = std::max<std::int64_t>(0, middle.col - radius);
         col <= std::min(spec.cols - 1, middle.col + radius); ++col) {
      const BinSums& bin = bins.bins()[spec.index({row, col})];
      if (bin.count == 0) continue;
      sums.add(bin.weight, (bin.w_x_est / bin.weight - spec.x(middle.col)) / spec.resolution_m,
               (bin.w_y_est / bin.weight - spec.y(middle.row)) / spec.resolution_m,
               bin.z_first + bin.w_dz / bin.weight - z_origin);
    }
  return sums;
}

/// The plane's slope, in metres per bin edge, the scatter of the centroids across their main direction, and
/// their mean square distance from the plane.
struct FittedPlane {
  double x;
  double y;
  double smallest_scatter;
  double misfit;
};

FittedPlane fit(const PlaneSums& s) {
  const double xx = s.xx / s.w - s.x * s.x / (s.w * s.w);
  const double xy = s.xy / s.w - s.x * s.y / (s.w * s.w);
  const double yy = s.yy / s.w - s.y * s.y / (s.w * s.w);
  const double xz = s.xz / s.w - s.x * s.z / (s.w * s.w);
  const double yz = s.yz / s.w - s.y * s.z / (s.w * s.w);
  const double zz = s.zz / s.w - s.z * s.z / (s.w * s.w);
  const double determinant = xx * yy - xy * xy;
  const double gx = (yy * xz - xy * yz) / determinant;
  const double gy = (xx * yz - xy * xz) / determinant;
  return {gx, gy, (xx + yy) / 2 - portable::hypot((xx - yy) / 2, xy), zz - gx * xz - gy * yz};
}

/// Calls set(bin, sums) for each bin that holds a return.
template <class Set>
void set_filled_bins(const WeightedMeanAccumulator& bins, Set set, const ProgressCallback& progress = {}) {
  const GridSpec& spec = bins.spec();
  const auto visit = [&](std::size_t begin, std::size_t end) {
    for (auto row = static_cast<std::int64_t>(begin); row < static_cast<std::int64_t>(end); ++row)
      for (std::int64_t col = 0; col < spec.cols; ++col) {
        const BinSums& sums = bins.bins()[spec.index({row, col})];
        if (sums.count > 0) set(BinIndex{row, col}, sums);
      }
  };
  parallel_for(static_cast<std::size_t>(spec.rows), kSlopeRows, visit, progress);
}

}  // namespace

PlaneFit fit_plane(const WeightedMeanAccumulator& bins, BinIndex bin) {
  for (std::int64_t radius = 1; radius <= kLargestRadius; ++radius) {
    const PlaneSums sums = window_sums(bins, bin, radius);
    if (sums.bins < (radius == kLargestRadius ? kFewestBins : kEnoughBins)) continue;
    const FittedPlane plane = fit(sums);
    if (plane.smallest_scatter < kSmallestScatter) continue;
    return {.slope = {static_cast<float>(plane.x / bins.spec().resolution_m),
                      static_cast<float>(plane.y / bins.spec().resolution_m)},
            .misfit_m2 = plane.misfit,
            .bins = sums.bins,
            .radius = radius};
  }
  return {};
}

Grid<Slope> slope_layer(const WeightedMeanAccumulator& bins, const ProgressCallback& progress) {
  Grid<Slope> slopes(bins.spec());
  set_filled_bins(
      bins, [&](BinIndex bin, const BinSums&) { slopes.at(bin) = fit_plane(bins, bin).slope; }, progress);
  return slopes;
}

double corrected_elevation(const BinValues& values, const GridSpec& spec, BinIndex bin, const Slope& slope) {
  return values.z_est - (double{slope.x} * (values.x_est - spec.x(bin.col)) +
                         double{slope.y} * (values.y_est - spec.y(bin.row)));
}

}  // namespace landfall
