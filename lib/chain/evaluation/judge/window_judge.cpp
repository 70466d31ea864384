// SPDX-License-Identifier: GPL-3.0-or-later
// A verdict without percentiles is exact. A window of n values passes where at most n - 2 - floor((n - 1)
// q) deviate by more than the limit (one more where the quantile is an order statistic itself), fails
// where at least n - floor((n - 1) q) do; between them the interpolated quantile decides. Deviations are
// rounded as in the percentile's definition, so that values equal to the limit have the same verdict.
//
// Inputs that the counts do not allow take the full evaluation: footprints of more than 257 bins on a side,
// and errors above 2^900 m, whose sums may overflow.
#include "chain/evaluation/judge/window_judge.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "base/raster/window_mean.h"

namespace landfall {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

// Chosen for speed; none of them changes a result.
constexpr std::int64_t kSmallestSplit = 8;  // of a rectangle of windows that is not split further
constexpr std::int64_t kManyUndecided = 4;  // one window of a tile in so many: exact means of all of them
constexpr std::int64_t kListCost = 2;  // of a value in the list of a window, in bins counted for a quarter

template <class T>
View<T> shaped(std::vector<T>& values, std::int64_t rows, std::int64_t cols) {
  const auto size = static_cast<std::size_t>(rows * cols);
  if (values.size() < size) values.resize(size);
  return {values.data(), cols, rows, cols};
}

/// Half an edge, or the whole edge if the half would be too small.
std::int64_t split_edge(std::int64_t edge) { return edge <= kSmallestSplit ? edge : (edge + 1) / 2; }

}  // namespace

WindowJudge::Outcome WindowJudge::judge(const TileErrors& errors, const View<const std::int8_t>& region,
                                        const View<std::int8_t>& fail) {
  errors_ = &errors;
  tile_ = {0, 0, region.rows, region.cols};
  fail_ = fail;
  outcome_ = {};
  has_all_exact_ = false;
  count_values(region);
  const ErrorRange& range = errors.range();
  // Every mean lies between the errors, but for its rounding error.
  if (outcome_.footprints == 0 || range.highest - range.lowest + mean_error_ <= rule_.limit_m * (1 - 0x1p-50))
    return outcome_;
  find_pending(region);
  estimate_means();
  const Pending all = pending_windows(tile_);
  if (range.highest - all.means.lowest > rule_.limit_m || all.means.highest - range.lowest > rule_.limit_m)
    judge_windows(tile_);
  return outcome_;
}

View<const double> WindowJudge::reach(const Rectangle& windows) const {
  return errors_->errors().part(windows.row, windows.col, windows.rows + 2 * errors_->half_rows(),
                                windows.cols + 2 * errors_->half_cols());
}

/// Counts the values of each window and the windows of the region that have one.
void WindowJudge::count_values(const View<const std::int8_t>& region) {
  const View<const double> errors = errors_->errors();
  const std::int64_t half = rule_.footprint.half_bins();
  is_full_ = errors_->missing() == 0 && errors_->half_rows() == half && errors_->half_cols() == half;
  if (!is_full_) {
    const View<std::uint64_t> packed = shaped(packed_, errors.rows, errors.cols);
    static_cast<void>(count_deviations(errors, {0, 0}, kNoLimit, packed));
    window_sums(packed, rule_.footprint, shaped(value_counts_, tile_.rows, tile_.cols));
  }
  for (std::int64_t row = 0; row < tile_.rows; ++row)
    for (std::int64_t col = 0; col < tile_.cols; ++col)
      outcome_.footprints += region.at(row, col) != 0 && has_value(row, col) ? 1 : 0;
  const auto rows = static_cast<double>(errors.rows);
  const auto cols = static_cast<double>(errors.cols);
  // Twice the bound of window_sums(), for the rounding of the exact mean and of the division.
  mean_error_ = 0x1p-50 * rows * cols * (rows + cols) * errors_->range().largest() + 1e-300;
}

void WindowJudge::find_pending(const View<const std::int8_t>& region) {
  const View<std::int8_t> pending = shaped(pending_, tile_.rows, tile_.cols);
  for (std::int64_t row = 0; row < tile_.rows; ++row)
    for (std::int64_t col = 0; col < tile_.cols; ++col)
      pending.at(row, col) = region.at(row, col) != 0 && has_value(row, col) ? 1 : 0;
}

void WindowJudge::estimate_means() {
  window_sums(errors_->filled(), rule_.footprint, shaped(means_, tile_.rows, tile_.cols));
  const auto size = static_cast<std::size_t>(tile_.rows * tile_.cols);
  for (std::size_t i = 0; i < size; ++i) means_[i] /= static_cast<double>(value_count(i));
}

WindowJudge::Pending WindowJudge::pending_windows(const Rectangle& windows) const {
  Pending result;
  for (std::int64_t row = windows.row; row < windows.row + windows.rows; ++row) {
    for (std::int64_t col = windows.col; col < windows.col + windows.cols; ++col) {
      const std::size_t i = index({row, col});
      if (pending_[i] == 0) continue;
      ++result.count;
      result.fewest = std::min(result.fewest, value_count(i));
      result.means.lowest = std::min(result.means.lowest, means_[i]);
      result.means.highest = std::max(result.means.highest, means_[i]);
    }
  }
  result.means.lowest -= mean_error_;
  result.means.highest += mean_error_;
  return result;
}

void WindowJudge::judge_windows(const Rectangle& windows) {
  const Pending pending = pending_windows(windows);
  if (pending.count == 0) return;
  const View<const double> errors = reach(windows);
  const View<std::uint64_t> packed = shaped(packed_, errors.rows, errors.cols);
  const DeviationTotals totals = count_deviations(errors, pending.means, rule_.limit_m, packed);
  // The count that a window needs does not fall as n grows, but for the rounding of (n - 1) q.
  if (totals.possible <= DecisiveCounts::of(pending.fewest, rule_.quantile).fail - 3) return drop(windows);
  const View<std::uint64_t> counts = shaped(counts_, windows.rows, windows.cols);
  window_sums(packed, rule_.footprint, counts);
  const std::int64_t undecided = decide_by_counts(windows, counts);
  if (undecided == 0) return;
  const bool is_small = windows.rows <= kSmallestSplit && windows.cols <= kSmallestSplit;
  const std::int64_t list = totals.possible - totals.certain;
  if (is_small || undecided * list <= kListCost * errors.rows * errors.cols)
    judge_by_list(windows, counts);
  else
    judge_quarters(windows, undecided);
}

void WindowJudge::drop(const Rectangle& windows) {
  for (std::int64_t row = windows.row; row < windows.row + windows.rows; ++row)
    std::fill_n(pending_.begin() + row * tile_.cols + windows.col, windows.cols, std::int8_t{0});
}

std::int64_t WindowJudge::decide_by_counts(const Rectangle& windows, const View<std::uint64_t>& counts) {
  std::int64_t undecided = 0;
  std::int64_t n = 0;
  DecisiveCounts decisive;
  for (std::int64_t row = 0; row < windows.rows; ++row) {
    for (std::int64_t col = 0; col < windows.cols; ++col) {
      const Place window{windows.row + row, windows.col + col};
      if (!is_pending(window)) continue;
      const PackedCounts count{counts.at(row, col)};
      if (count.valid() != n) {
        n = count.valid();
        decisive = DecisiveCounts::of(n, rule_.quantile);
      }
      if (count.possible() <= decisive.pass)
        decide(window, false);
      else if (count.certain() >= decisive.fail)
        decide(window, true);
      else
        ++undecided;
    }
  }
  return undecided;
}

void WindowJudge::judge_quarters(const Rectangle& windows, std::int64_t undecided) {
  const bool is_tile = windows.rows == tile_.rows && windows.cols == tile_.cols;
  if (is_tile && undecided * kManyUndecided >= tile_.rows * tile_.cols) {
    find_window_means(windows);
    has_all_exact_ = true;
  }
  const std::int64_t rows = split_edge(windows.rows);
  const std::int64_t cols = split_edge(windows.cols);
  for (std::int64_t row = 0; row < windows.rows; row += rows)
    for (std::int64_t col = 0; col < windows.cols; col += cols)
      judge_windows({windows.row + row, windows.col + col, std::min(rows, windows.rows - row),
                     std::min(cols, windows.cols - col)});
}

/// Lists the values that depend on the mean; packed_ holds the reach of the windows.
void WindowJudge::list_uncertain(const Rectangle& windows) {
  const View<const double> errors = reach(windows);
  const View<std::uint64_t> packed = shaped(packed_, errors.rows, errors.cols);
  uncertain_.clear();
  for (std::int64_t row = 0; row < errors.rows; ++row) {
    for (std::int64_t col = 0; col < errors.cols; ++col) {
      const PackedCounts bits{packed.at(row, col)};
      if (bits.possible() != bits.certain())
        uncertain_.push_back(
            {{windows.row + row - errors_->half_rows(), windows.col + col - errors_->half_cols()},
             errors.at(row, col)});
    }
  }
}

/// Computes the exact means of these windows, unless those of the whole tile are known.
void WindowJudge::find_window_means(const Rectangle& windows) {
  if (has_all_exact_) return;
  const View<const double> errors = reach(windows);
  auto grid = Grid<double>::unset({1, 0, 0, errors.rows, errors.cols});
  for (std::int64_t row = 0; row < errors.rows; ++row)
    std::copy_n(errors.row(row), errors.cols, grid.row(row).begin());
  window_means_ = window_means(grid, rule_.footprint).mean;
  exact_first_ = {windows.row - errors_->half_rows(), windows.col - errors_->half_cols()};
}

void WindowJudge::judge_by_list(const Rectangle& windows, const View<std::uint64_t>& counts) {
  list_uncertain(windows);
  find_window_means(windows);
  for (std::int64_t row = 0; row < windows.rows; ++row) {
    for (std::int64_t col = 0; col < windows.cols; ++col) {
      const Place window{windows.row + row, windows.col + col};
      if (!is_pending(window)) continue;
      ++outcome_.by_list;
      const double mean = window_means_.at({window.row - exact_first_.row, window.col - exact_first_.col});
      decide(window, exceeds(window, mean, PackedCounts{counts.at(row, col)}));
    }
  }
}

bool WindowJudge::exceeds(Place window, double mean, const PackedCounts& counts) {
  std::int64_t above = counts.certain();
  for (const Value& value : uncertain_)
    if (std::abs(value.error - mean) > rule_.limit_m && holds(window, value.place)) ++above;
  const DecisiveCounts decisive = DecisiveCounts::of(counts.valid(), rule_.quantile);
  if (above <= decisive.pass) return false;
  if (above >= decisive.fail) return true;
  ++outcome_.by_quantile;
  return quantile_exceeds(window, mean,
                          quantile_rank(static_cast<std::size_t>(counts.valid()), rule_.quantile).frac);
}

bool WindowJudge::holds(Place window, Place value) const {
  const std::int64_t rows = std::abs(value.row - window.row);
  return rows <= errors_->half_rows() &&
         std::abs(value.col - window.col) <= std::min(rule_.footprint.half_width(rows), errors_->half_cols());
}

/// The limit lies between the two order statistics, which are then the values next to it.
bool WindowJudge::quantile_exceeds(Place window, double mean, double frac) const {
  double below = 0;
  double above = kNoLimit;
  for (std::int64_t offset = -errors_->half_rows(); offset <= errors_->half_rows(); ++offset) {
    const std::int64_t half = std::min(rule_.footprint.half_width(offset), errors_->half_cols());
    const double* const errors =
        errors_->errors().row(window.row + errors_->half_rows() + offset) + window.col + errors_->half_cols();
    for (std::int64_t col = -half; col <= half; ++col) {
      const double deviation = std::abs(errors[col] - mean);
      const bool is_within = deviation <= rule_.limit_m;
      below = is_within && deviation > below ? deviation : below;
      above = !is_within && deviation < above ? deviation : above;
    }
  }
  return interpolate(below, above, frac) > rule_.limit_m;
}

void WindowJudge::decide(Place window, bool fails) {
  pending_[index(window)] = 0;
  if (!fails) return;
  ++outcome_.violations;
  set_flag(fail_.at(window.row, window.col), rule_.flag);
}

}  // namespace landfall
