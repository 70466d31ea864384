// SPDX-License-Identifier: GPL-3.0-or-later
#include "gridding/layers.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace landfall {
namespace {

constexpr std::size_t kRowsPerPiece = 16;

/// value(sums, bin) of each bin that holds a return, `empty` of the others.
template <class T, class Value>
Grid<T> layer(const BinAccumulator& bins, T empty, Value value) {
  const GridSpec& spec = bins.spec();
  Grid<T> result(spec, empty);
  parallel_for(static_cast<std::size_t>(spec.rows), kRowsPerPiece, [&](std::size_t begin, std::size_t end) {
    for (auto row = static_cast<std::int64_t>(begin); row < static_cast<std::int64_t>(end); ++row)
      for (std::int64_t col = 0; col < spec.cols; ++col) {
        const BinSums& sums = bins.bins()[spec.index({row, col})];
        if (sums.count > 0) result.at({row, col}) = static_cast<T>(value(sums, BinIndex{row, col}));
      }
  });
  return result;
}

/// sum / sum w of each bin.
template <class T>
Grid<T> mean_layer(const BinAccumulator& bins, double BinSums::*sum) {
  return layer(bins, std::numeric_limits<T>::quiet_NaN(),
               [=](const BinSums& sums, BinIndex) { return sums.*sum / sums.weight; });
}

double z_spread(const BinSums& sums) {
  const double mean_dz = sums.w_dz / sums.weight;
  // Rounding can leave a tiny negative number where all returns are equal.
  return std::sqrt(std::max(0.0, sums.w_dz_dz / sums.weight - mean_dz * mean_dz));
}

}  // namespace

Grid<double> z_est_layer(const BinAccumulator& bins) {
  return layer(bins, std::numeric_limits<double>::quiet_NaN(),
               [](const BinSums& sums, BinIndex) { return sums.z_first + sums.w_dz / sums.weight; });
}

Grid<double> x_true_layer(const BinAccumulator& bins) { return mean_layer<double>(bins, &BinSums::w_x_true); }

Grid<double> y_true_layer(const BinAccumulator& bins) { return mean_layer<double>(bins, &BinSums::w_y_true); }

Grid<double> z_true_layer(const BinAccumulator& bins, const ElevationFunction& elevation, TruthAt truth_at) {
  const GridSpec& spec = bins.spec();
  const auto at_center = [&](const BinSums& sums, BinIndex bin) {
    return elevation(spec.x(bin.col) + (sums.w_x_true - sums.w_x_est) / sums.weight,
                     spec.y(bin.row) + (sums.w_y_true - sums.w_y_est) / sums.weight);
  };
  const auto at_centroid = [&](const BinSums& sums, BinIndex) {
    return elevation(sums.w_x_true / sums.weight, sums.w_y_true / sums.weight);
  };
  constexpr double kEmpty = std::numeric_limits<double>::quiet_NaN();
  return truth_at == TruthAt::bin_center ? layer(bins, kEmpty, at_center) : layer(bins, kEmpty, at_centroid);
}

Grid<float> z_true_map_layer(const BinAccumulator& bins, const ElevationFunction& elevation) {
  const GridSpec& spec = bins.spec();
  return layer(bins, std::numeric_limits<float>::quiet_NaN(),
               [&](const BinSums&, BinIndex bin) { return elevation(spec.x(bin.col), spec.y(bin.row)); });
}

Grid<double> weight_sum_layer(const BinAccumulator& bins) {
  return layer(bins, std::numeric_limits<double>::quiet_NaN(),
               [](const BinSums& sums, BinIndex) { return sums.weight; });
}

Grid<std::int32_t> count_layer(const BinAccumulator& bins) {
  return layer(bins, std::int32_t{0}, [](const BinSums& sums, BinIndex) { return sums.count; });
}

Grid<float> x_est_mean_layer(const BinAccumulator& bins) {
  return mean_layer<float>(bins, &BinSums::w_x_est);
}

Grid<float> y_est_mean_layer(const BinAccumulator& bins) {
  return mean_layer<float>(bins, &BinSums::w_y_est);
}

Grid<float> t_mean_layer(const BinAccumulator& bins) { return mean_layer<float>(bins, &BinSums::w_t); }

Grid<float> z_spread_layer(const BinAccumulator& bins) {
  return layer(bins, std::numeric_limits<float>::quiet_NaN(),
               [](const BinSums& sums, BinIndex) { return z_spread(sums); });
}

}  // namespace landfall
