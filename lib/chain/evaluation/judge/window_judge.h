// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "chain/evaluation/fail_flag.h"
#include "chain/evaluation/judge/tile_errors.h"
#include "chain/evaluation/judge/window_counts.h"

namespace landfall {

/// The windows of a tile that exceed the limit of the relative error (Eq. 12).
///
/// With the smallest and the largest mean of some windows, each value surely deviates from all of these means
/// by more than the limit, surely from none, or it depends. Box counts of the first and of the others bound
/// the count of every window, and that count mostly decides (DecisiveCounts). Windows that it leaves
/// undecided are judged again in quarters of the tile, whose means differ less, until so few values depend on
/// the mean that each window can examine them one by one. The quantile itself is needed only where the limit
/// lies between its two order statistics.
///
/// All but the last steps take means from sums in any order, with a bound of their rounding error; the last
/// ones take them from window_means().
class WindowJudge {
 public:
  struct Rule {
    const Footprint& footprint;  ///< of at most PackedCounts::kMax bins
    double quantile;
    double limit_m;
    FailFlag flag;
  };
  /// Windows by what decided them.
  struct Outcome {
    std::int64_t footprints = 0;  ///< with a value
    std::int64_t violations = 0;
    std::int64_t by_list = 0;      ///< of the footprints: by values that were examined one by one
    std::int64_t by_quantile = 0;  ///< and by the quantile itself
  };

  explicit WindowJudge(const Rule& rule) : rule_(rule), whole_(rule.footprint.bin_count()) {}

  /// Judges the windows about the bins of a tile that the region holds. Sets the flag of those that exceed
  /// the limit. The magnitudes of the errors are at most 2^900.
  Outcome judge(const TileErrors& errors, const View<const std::int8_t>& region,
                const View<std::int8_t>& fail);

  /// An interval that holds the mean of each window of the last tile, and whether a window of the region has
  /// a value.
  [[nodiscard]] MeanRange bounds_of_means() const {
    return {errors_->range().lowest - mean_error_, errors_->range().highest + mean_error_};
  }
  [[nodiscard]] bool has_value(std::int64_t row, std::int64_t col) const {
    return value_count(index({row, col})) > 0;
  }
  /// Whether every bin that the windows reach has a value.
  [[nodiscard]] bool is_full() const { return is_full_; }

 private:
  struct Rectangle {
    std::int64_t row, col, rows, cols;  ///< of the tile
  };
  struct Place {
    std::int64_t row, col;  ///< in the tile or next to it
  };
  struct Value {
    Place place;
    double error;
  };
  /// The undecided windows of a rectangle.
  struct Pending {
    std::int64_t count = 0;
    std::int64_t fewest = std::numeric_limits<std::int64_t>::max();  ///< values of one
    MeanRange means{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  };

  void count_values(const View<const std::int8_t>& region);
  void find_pending(const View<const std::int8_t>& region);
  void estimate_means();
  [[nodiscard]] View<const double> reach(const Rectangle& windows) const;
  [[nodiscard]] Pending pending_windows(const Rectangle& windows) const;
  void judge_windows(const Rectangle& windows);
  void drop(const Rectangle& windows);
  [[nodiscard]] std::int64_t decide_by_counts(const Rectangle& windows, const View<std::uint64_t>& counts);
  void judge_quarters(const Rectangle& windows, std::int64_t undecided);
  void find_window_means(const Rectangle& windows);
  void list_uncertain(const Rectangle& windows);
  void judge_by_list(const Rectangle& windows, const View<std::uint64_t>& counts);
  [[nodiscard]] bool exceeds(Place window, double mean, const PackedCounts& counts);
  [[nodiscard]] bool holds(Place window, Place value) const;
  [[nodiscard]] bool quantile_exceeds(Place window, double mean, double frac) const;
  void decide(Place window, bool fails);
  [[nodiscard]] bool is_pending(Place window) const { return pending_[index(window)] != 0; }
  [[nodiscard]] std::int64_t value_count(std::size_t i) const {
    return is_full_ ? whole_ : PackedCounts{value_counts_[i]}.valid();
  }
  [[nodiscard]] std::size_t index(Place window) const {
    return static_cast<std::size_t>(window.row * tile_.cols + window.col);
  }

  Rule rule_;
  const TileErrors* errors_ = nullptr;
  Rectangle tile_{};
  View<std::int8_t> fail_;
  Outcome outcome_;
  double mean_error_ = 0;             ///< at most, of means_
  std::vector<std::int8_t> pending_;  ///< by window of the tile
  std::vector<double> means_;         ///< one for each window of the tile
  Grid<double> window_means_;         ///< of windows from exact_first_ on
  Place exact_first_{};
  bool has_all_exact_ = false;  ///< of the whole tile
  bool is_full_ = false;
  std::int64_t whole_;                       ///< bins of the footprint
  std::vector<std::uint64_t> value_counts_;  ///< one for each window of the tile, unless is_full_
  std::vector<std::uint64_t> packed_, counts_;
  std::vector<Value> uncertain_;  ///< values that depend on the mean
};

}  // namespace landfall
