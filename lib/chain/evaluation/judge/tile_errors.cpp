// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/judge/tile_errors.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "chain/evaluation/judge/tile_errors.cpp"
#include "base/numerics/lanes-inl.h"
#include "base/numerics/non_finite.h"

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

/// Computes the errors of neighbouring bins and adds them to a range.
class RowErrors {
 public:
  explicit RowErrors(ErrorRange& range) : range_(range) {}

  void run(const double* truth, const double* estimates, std::size_t count, double* errors, double* filled) {
    const D d;
    const std::size_t whole = count / hn::Lanes(d) * hn::Lanes(d);
    auto lowest = hn::Set(d, range_.lowest);
    auto highest = hn::Set(d, range_.highest);
    auto largest = hn::Zero(d);
    std::size_t valid = 0;
    for (std::size_t i = 0; i < whole; i += hn::Lanes(d)) {
      const auto t = hn::LoadU(d, truth + i);
      const auto s = hn::LoadU(d, estimates + i);
      const auto e = hn::Sub(t, s);
      const auto is_valid = hn::Eq(e, e);
      hn::StoreU(e, d, errors + i);
      hn::StoreU(hn::IfThenElseZero(is_valid, e), d, filled + i);
      lowest = hn::IfThenElse(hn::Lt(e, lowest), e, lowest);
      highest = hn::IfThenElse(hn::Gt(e, highest), e, highest);
      largest = hn::IfThenElse(hn::Gt(hn::Abs(t), largest), hn::Abs(t), largest);
      largest = hn::IfThenElse(hn::Gt(hn::Abs(s), largest), hn::Abs(s), largest);
      valid += hn::CountTrue(d, is_valid);
    }
    range_.lowest = hn::GetLane(hn::MinOfLanes(d, lowest));
    range_.highest = hn::GetLane(hn::MaxOfLanes(d, highest));
    range_.valid += static_cast<std::int64_t>(valid);
    if (hn::GetLane(hn::MaxOfLanes(d, largest)) == kInfinity) range_.has_infinite = true;
    for (std::size_t i = whole; i < count; ++i) add_one(truth[i], estimates[i], errors[i], filled[i]);
  }

 private:
  void add_one(double truth, double estimate, double& error, double& filled) {
    error = truth - estimate;
    filled = std::isnan(error) ? 0.0 : error;
    if (error < range_.lowest) range_.lowest = error;
    if (error > range_.highest) range_.highest = error;
    range_.valid += std::isnan(error) ? 0 : 1;
    if (std::isinf(truth) || std::isinf(estimate)) range_.has_infinite = true;
  }

  ErrorRange& range_;
};

void LoadRow(const double* truth, const double* estimates, std::size_t count, double* errors, double* filled,
             ErrorRange& range) {
  RowErrors(range).run(truth, estimates, count, errors, filled);
}

bool HasInfinite(const double* values, std::size_t count) {
  const D d;
  const std::size_t whole = count / hn::Lanes(d) * hn::Lanes(d);
  auto largest = hn::Zero(d);
  for (std::size_t i = 0; i < whole; i += hn::Lanes(d)) {
    const auto v = hn::Abs(hn::LoadU(d, values + i));
    largest = hn::IfThenElse(hn::Gt(v, largest), v, largest);
  }
  return std::isinf(hn::GetLane(hn::MaxOfLanes(d, largest))) ||
         std::any_of(values + whole, values + count, [](double v) { return std::isinf(v); });
}

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace landfall {

HWY_EXPORT(LoadRow);
HWY_EXPORT(HasInfinite);

TileErrors::TileErrors(Axis axis, const DemLayers& dem, const Footprint& footprint)
    : axis_(axis),
      truth_(axis == Axis::x   ? dem.truth->x
             : axis == Axis::y ? dem.truth->y
                               : dem.truth->z),
      z_est_(dem.z_est),
      half_rows_(std::min(footprint.half_bins(), z_est_.spec().rows - 1)),
      half_cols_(std::min(footprint.half_bins(), z_est_.spec().cols - 1)) {}

void TileErrors::load(const Tile& tile) {
  const GridSpec& spec = z_est_.spec();
  rows_ = tile.rows + 2 * half_rows_;
  cols_ = tile.cols + 2 * half_cols_;
  range_ = {};
  const Tile reached{std::max<std::int64_t>(tile.first_row - half_rows_, 0),
                     std::max<std::int64_t>(tile.first_col - half_cols_, 0), 0,
                     std::min(tile.first_col + tile.cols + half_cols_, spec.cols) -
                         std::max<std::int64_t>(tile.first_col - half_cols_, 0)};
  const auto size = static_cast<std::size_t>(rows_ * cols_);
  if (errors_.size() < size) {
    errors_.resize(size);
    filled_.resize(size);
  }
  estimates_.resize(static_cast<std::size_t>(reached.cols));
  if (axis_ == Axis::x)
    for (std::int64_t i = 0; i < reached.cols; ++i)
      estimates_[static_cast<std::size_t>(i)] = spec.x(reached.first_col + i);
  for (std::int64_t i = 0; i < rows_; ++i) {
    double* const errors = errors_.data() + i * cols_;
    double* const filled = filled_.data() + i * cols_;
    const std::int64_t row = tile.first_row - half_rows_ + i;
    const std::int64_t before = reached.first_col - (tile.first_col - half_cols_);
    const bool is_inside = row >= 0 && row < spec.rows;
    if (!is_inside || reached.cols < cols_) {
      std::fill_n(errors, cols_, std::numeric_limits<double>::quiet_NaN());
      std::fill_n(filled, cols_, 0.0);
    }
    if (!is_inside) continue;
    if (axis_ == Axis::y) std::ranges::fill(estimates_, spec.y(row));
    const double* const estimates =
        axis_ == Axis::z ? z_est_.row(row).data() + reached.first_col : estimates_.data();
    HWY_DYNAMIC_DISPATCH(LoadRow)
    (truth_.row(row).data() + reached.first_col, estimates, static_cast<std::size_t>(reached.cols),
     errors + before, filled + before, range_);
  }
}

bool has_infinite(const Grid<double>& layer, const Tile& tile) {
  for (std::int64_t row = tile.first_row; row < tile.first_row + tile.rows; ++row)
    if (HWY_DYNAMIC_DISPATCH(HasInfinite)(layer.row(row).data() + tile.first_col,
                                          static_cast<std::size_t>(tile.cols)))
      return true;
  return false;
}

}  // namespace landfall
#endif
