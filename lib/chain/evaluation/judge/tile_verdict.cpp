// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/judge/tile_verdict.h"

#include <cmath>

#include "base/numerics/portable_math.h"
#include "base/raster/window_mean.h"

namespace landfall {
namespace {

/// Below this bound no sum of errors and no difference from a mean overflows.
constexpr double kLargestUsual = 0x1p900;

template <class T>
View<T> part_of_tile(T* values, const GridSpec& spec, const Tile& tile) {
  return {values + spec.index({tile.first_row, tile.first_col}), spec.cols, tile.rows, tile.cols};
}

WindowJudge::Outcome& operator+=(WindowJudge::Outcome& sum, const WindowJudge::Outcome& other) {
  sum.footprints += other.footprints;
  sum.violations += other.violations;
  sum.by_list += other.by_list;
  sum.by_quantile += other.by_quantile;
  return sum;
}

/// The smallest and the largest magnitude in an interval.
struct Magnitudes {
  double smallest, largest;
};

Magnitudes magnitudes(const MeanRange& range) {
  return {std::max({range.lowest, -range.highest, 0.0}), std::max(range.highest, -range.lowest)};
}

Grid<double> grid_of(const View<const double>& values) {
  auto grid = Grid<double>::unset({1, 0, 0, values.rows, values.cols});
  for (std::int64_t row = 0; row < values.rows; ++row)
    std::copy_n(values.row(row), values.cols, grid.row(row).begin());
  return grid;
}

}  // namespace

TileVerdict& TileVerdict::operator+=(const TileVerdict& other) {
  x += other.x;
  y += other.y;
  z += other.z;
  horizontal += other.horizontal;
  has_unusual = has_unusual || other.has_unusual;
  return *this;
}

TileJudge::TileJudge(const DemLayers& dem, const BinMask& region, const EvaluationParameters& parameters,
                     const Footprint& footprint, Grid<std::int8_t>& fail)
    : dem_(dem),
      region_(region),
      limits_(effective_limits(parameters, footprint)),
      footprint_(footprint),
      fail_(fail),
      x_(Axis::x, dem, footprint),
      y_(Axis::y, dem, footprint),
      z_(Axis::z, dem, footprint),
      judge_x_({footprint, parameters.quantile, limits_.relative_xy_m, fail_relative_x}),
      judge_y_({footprint, parameters.quantile, limits_.relative_xy_m, fail_relative_y}),
      judge_z_({footprint, parameters.quantile, limits_.relative_z_m, fail_relative_z}) {}

TileVerdict TileJudge::judge(const Tile& tile) {
  TileVerdict result;
  if (is_outside(tile)) {
    result.has_unusual = has_infinite_layer(tile);
    return result;
  }
  for (TileErrors* const errors : {&x_, &y_, &z_}) {
    errors->load(tile);
    const ErrorRange& range = errors->range();
    if (range.has_infinite || !(range.largest() <= kLargestUsual)) result.has_unusual = true;
  }
  if (result.has_unusual) return result;
  const GridSpec& spec = region_.spec();
  const View<const std::int8_t> region = part_of_tile(region_.values().data(), spec, tile);
  const View<std::int8_t> fail = part_of_tile(fail_.values().data(), spec, tile);
  result.x = judge_x_.judge(x_, region, fail);
  result.y = judge_y_.judge(y_, region, fail);
  result.z = judge_z_.judge(z_, region, fail);
  judge_horizontal(tile, result.x.footprints, result.horizontal);
  return result;
}

bool TileJudge::is_outside(const Tile& tile) const {
  for (std::int64_t row = tile.first_row; row < tile.first_row + tile.rows; ++row) {
    const std::int8_t* const first = region_.row(row).data() + tile.first_col;
    if (std::any_of(first, first + tile.cols, [](std::int8_t set) { return set != 0; })) return false;
  }
  return true;
}

bool TileJudge::has_infinite_layer(const Tile& tile) const {
  return has_infinite(dem_.z_est, tile) || has_infinite(dem_.truth->x, tile) ||
         has_infinite(dem_.truth->y, tile) || has_infinite(dem_.truth->z, tile);
}

/// The footprints whose hypot(abs_x, abs_y) exceeds the limit: all of the tile, none, or those whose means
/// say so. `footprints` have a value in x.
void TileJudge::judge_horizontal(const Tile& tile, std::int64_t footprints, WindowJudge::Outcome& outcome) {
  if (x_.range().valid == 0 || y_.range().valid == 0) return;
  const Magnitudes x = magnitudes(judge_x_.bounds_of_means());
  const Magnitudes y = magnitudes(judge_y_.bounds_of_means());
  constexpr double kSlack = 0x1p-50;  // of hypot(), which rounds
  const bool is_within = portable::hypot(x.largest, y.largest) * (1 + kSlack) <= limits_.horizontal_m;
  const bool is_beyond = portable::hypot(x.smallest, y.smallest) * (1 - kSlack) > limits_.horizontal_m;
  if (!is_within && !is_beyond) return judge_means(tile, outcome);
  if (is_within && judge_x_.is_full() && judge_y_.is_full()) {
    outcome.footprints = footprints;
    return;
  }
  const GridSpec& spec = region_.spec();
  const View<const std::int8_t> region = part_of_tile(region_.values().data(), spec, tile);
  const View<std::int8_t> fail = part_of_tile(fail_.values().data(), spec, tile);
  for (std::int64_t row = 0; row < tile.rows; ++row) {
    for (std::int64_t col = 0; col < tile.cols; ++col) {
      if (region.at(row, col) == 0 || !judge_x_.has_value(row, col) || !judge_y_.has_value(row, col))
        continue;
      ++outcome.footprints;
      if (is_within) continue;
      ++outcome.violations;
      set_flag(fail.at(row, col), fail_absolute_horizontal);
    }
  }
}

void TileJudge::judge_means(const Tile& tile, WindowJudge::Outcome& outcome) {
  const WindowMeans x = window_means(grid_of(x_.errors()), footprint_);
  const WindowMeans y = window_means(grid_of(y_.errors()), footprint_);
  for (std::int64_t row = 0; row < tile.rows; ++row) {
    for (std::int64_t col = 0; col < tile.cols; ++col) {
      const BinIndex bin{tile.first_row + row, tile.first_col + col};
      const BinIndex local{row + x_.half_rows(), col + x_.half_cols()};
      if (region_.at(bin) == 0 || x.count.at(local) == 0 || y.count.at(local) == 0) continue;
      ++outcome.footprints;
      if (!(portable::hypot(x.mean.at(local), y.mean.at(local)) > limits_.horizontal_m)) continue;
      ++outcome.violations;
      set_flag(fail_.at(bin), fail_absolute_horizontal);
    }
  }
}

}  // namespace landfall
