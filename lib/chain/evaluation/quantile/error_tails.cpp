// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/quantile/error_tails.h"

#include <algorithm>
#include <cstdlib>
#include <limits>

namespace landfall {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();

/// The windows that hold a bin, among `count` centred on consecutive bins from `first`: begin .. end - 1.
struct WindowRange {
  std::size_t begin = 0;
  std::size_t end = 0;
};

struct WindowLine {
  std::int64_t first = 0;
  std::int64_t count = 0;

  [[nodiscard]] WindowRange windows_with(std::int64_t bin, std::int64_t half_bins) const {
    const std::int64_t begin = std::max<std::int64_t>(bin - half_bins - first, 0);
    const std::int64_t end = std::min(bin + half_bins + 1 - first, count);
    return {static_cast<std::size_t>(begin), static_cast<std::size_t>(end)};
  }
};

/// Builds the sets of one line of windows as changes from each window's set to the next, summed afterwards.
class SetDrawer {
 public:
  SetDrawer(std::vector<std::uint64_t>& sets, std::size_t words, const WindowLine& line)
      : sets_(sets), words_(words), line_(line) {
    sets_.assign((static_cast<std::size_t>(line.count) + 1) * words, 0);
  }

  void add_to_all(std::size_t rank) { flip(0, rank); }

  /// Adds the bin to the windows that reach half_bins to either side.
  void add(std::int64_t bin, std::int64_t half_bins, std::size_t rank) {
    const WindowRange range = line_.windows_with(bin, half_bins);
    flip(range.begin, rank);
    flip(range.end, rank);
  }

  /// Like add(), but the bin may be outside all windows.
  void add_if_reached(std::int64_t bin, std::int64_t half_bins, std::size_t rank) {
    if (bin + half_bins >= line_.first && bin - half_bins < line_.first + line_.count)
      add(bin, half_bins, rank);
  }

  void sum() {
    for (std::size_t i = words_; i < sets_.size(); ++i) sets_[i] ^= sets_[i - words_];
  }

 private:
  void flip(std::size_t window, std::size_t rank) {
    sets_[window * words_ + rank / 64] ^= std::uint64_t{1} << (rank % 64);
  }

  std::vector<std::uint64_t>& sets_;
  std::size_t words_;
  WindowLine line_;
};

}  // namespace

Tile reach(const GridSpec& spec, const Tile& tile, std::int64_t half_bins) {
  const std::int64_t first_row = std::max<std::int64_t>(tile.first_row - half_bins, 0);
  const std::int64_t first_col = std::max<std::int64_t>(tile.first_col - half_bins, 0);
  const std::int64_t end_row = std::min(tile.first_row + tile.rows + half_bins, spec.rows);
  const std::int64_t end_col = std::min(tile.first_col + tile.cols + half_bins, spec.cols);
  return {first_row, first_col, end_row - first_row, end_col - first_col};
}

void collect_tails(const Grid<double>& error, const Tile& reached, const TailBounds& bounds,
                   ErrorTails& tails) {
  // Every bin is written and only the kept ones advance, since a branch would cost more than the store. The
  // bin after the last kept one may be written too.
  const auto largest = static_cast<std::size_t>(reached.rows * reached.cols + 1);
  tails.upper.bins.resize(largest);
  tails.lower.bins.resize(largest);
  TailBin* upper = tails.upper.bins.data();
  TailBin* lower = tails.lower.bins.data();
  for (std::int64_t row = reached.first_row; row < reached.first_row + reached.rows; ++row) {
    const double* const errors = error.row(row).data();
    for (std::int64_t col = reached.first_col; col < reached.first_col + reached.cols; ++col) {
      const double e = errors[col];
      *upper = {e, static_cast<std::int32_t>(row), static_cast<std::int32_t>(col)};
      *lower = {-e, static_cast<std::int32_t>(row), static_cast<std::int32_t>(col)};
      upper += e >= bounds.upper ? 1 : 0;
      lower += e <= bounds.lower ? 1 : 0;
    }
  }
  tails.upper.bins.resize(static_cast<std::size_t>(upper - tails.upper.bins.data()));
  tails.lower.bins.resize(static_cast<std::size_t>(lower - tails.lower.bins.data()));
}

void ErrorTail::build(const Tile& tile, const Footprint& footprint) {
  sort_.sort(bins);
  values_.assign(bins.size() + 2 * kPad, kEndless);
  std::fill_n(values_.end() - kPad, kPad, -kEndless);
  std::ranges::transform(bins, values_.begin() + kPad, &TailBin::value);
  words_ = values_.size() / 64 + 1;
  tile_ = tile;
  footprint_ = &footprint;
  entered_set_ = 0;
  if (footprint.is_square())
    draw_square_sets();
  else
    row_sets_.assign(words_, ~std::uint64_t{0});
}

void ErrorTail::enter_row(std::int64_t row) {
  if (footprint_->is_square())
    entered_set_ = row;
  else
    draw_spans(row);
}

void ErrorTail::draw_square_sets() {
  const std::int64_t half_bins = footprint_->half_bins();
  SetDrawer rows(row_sets_, words_, {tile_.first_row, tile_.rows});
  SetDrawer cols(col_sets_, words_, {tile_.first_col, tile_.cols});
  for (const std::size_t padding : {kPad - 1, kPad + bins.size()}) {
    rows.add_to_all(padding);
    cols.add_to_all(padding);
  }
  for (std::size_t i = 0; i < bins.size(); ++i) {
    rows.add(bins[i].row, half_bins, kPad + i);
    cols.add(bins[i].col, half_bins, kPad + i);
  }
  rows.sum();
  cols.sum();
}

void ErrorTail::draw_spans(std::int64_t row) {
  SetDrawer cols(col_sets_, words_, {tile_.first_col, tile_.cols});
  for (const std::size_t padding : {kPad - 1, kPad + bins.size()}) cols.add_to_all(padding);
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const std::int64_t offset = bins[i].row - tile_.first_row - row;
    if (std::abs(offset) > footprint_->half_bins()) continue;
    cols.add_if_reached(bins[i].col, footprint_->half_width(offset), kPad + i);
  }
  cols.sum();
}

}  // namespace landfall
