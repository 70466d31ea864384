// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "chain/evaluation/accuracy.h"
#include "chain/evaluation/judge/window_sums.h"
#include "chain/evaluation/quantile/error_tails.h"

namespace landfall {

/// The range of some errors.
struct ErrorRange {
  double lowest = std::numeric_limits<double>::infinity();  ///< NaN is ignored
  double highest = -std::numeric_limits<double>::infinity();
  std::int64_t valid = 0;
  bool has_infinite = false;  ///< in the truth or in the estimate

  [[nodiscard]] double largest() const { return valid == 0 ? 0 : std::max(-lowest, highest); }
};

/// The errors of one axis that the windows of one tile reach, computed for each tile (error_of()), so
/// that no map of them exists. Bins outside the grid are NaN: windows need no clipping.
class TileErrors {
 public:
  TileErrors(Axis axis, const DemLayers& dem, const Footprint& footprint);
  void load(const Tile& tile);

  /// tile rows + 2 half_rows() of tile columns + 2 half_cols().
  [[nodiscard]] View<const double> errors() const { return {errors_.data(), cols_, rows_, cols_}; }
  /// With 0 in place of NaN.
  [[nodiscard]] View<const double> filled() const { return {filled_.data(), cols_, rows_, cols_}; }
  [[nodiscard]] const ErrorRange& range() const { return range_; }
  /// Bins without an error, those outside the grid included.
  [[nodiscard]] std::int64_t missing() const { return rows_ * cols_ - range_.valid; }
  [[nodiscard]] std::int64_t half_rows() const { return half_rows_; }
  [[nodiscard]] std::int64_t half_cols() const { return half_cols_; }

 private:
  Axis axis_;
  const Grid<double>& truth_;
  const Grid<double>& z_est_;
  std::int64_t half_rows_, half_cols_;
  std::int64_t rows_ = 0;
  std::int64_t cols_ = 0;
  std::vector<double> estimates_;  ///< of one row
  std::vector<double> errors_, filled_;
  ErrorRange range_;
};

/// Whether a layer has an infinite value in the tile.
[[nodiscard]] bool has_infinite(const Grid<double>& layer, const Tile& tile);

}  // namespace landfall
