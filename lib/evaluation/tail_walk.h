// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "evaluation/error_tails.h"
#include "evaluation/quantile.h"
#include "evaluation/tail_cursor.h"
#include "evaluation/window_quantile.h"

namespace landfall {

/// What a walk over a tile's windows left.
struct WalkOutcome {
  std::int64_t uncertified = 0;  ///< windows still to be computed
  /// Not above the lower of the two order statistics of any of them.
  double lower_bound = std::numeric_limits<double>::infinity();
  /// Of the windows computed now.
  double smallest = std::numeric_limits<double>::infinity();
};

/// Takes from sorted tails the quantile of each window of a tile. Neighbours have nearly equal answers, so
/// each window starts from a prediction t, takes the members that deviate by more than t, and moves a few
/// members on or back until it stands between the two order statistics.
class TailWalk {
 public:
  /// The result is NaN where a window is still to be computed.
  TailWalk(const WindowQuantileInput& input, Grid<double>& result) : input_(input), result_(result) {}

  /// `tails` holds every bin that deviates by more than `floor` from the mean of any pending window; then an
  /// order statistic found in them is exact if it is at least `floor`: a bin left out could not replace it,
  /// or only by an equal value.
  [[nodiscard]] WalkOutcome run(ErrorTails& tails, const Tile& tile, double floor);

 private:
  struct OrderStatistics {
    double below = 0;  ///< -infinity when the tails hold too few bins
    double above = 0;
  };
  struct Places {
    std::size_t upper = 0;
    std::size_t lower = 0;
  };

  void walk_row(ErrorTails& tails, const Tile& tile, std::int64_t row);
  [[nodiscard]] double settle(BinIndex bin, const OrderStatistics& found);
  [[nodiscard]] OrderStatistics find(TailCursor upper, TailCursor lower) const;
  void look_up_rank(BinIndex bin);

  const WindowQuantileInput& input_;
  Grid<double>& result_;
  double floor_ = 0;
  WalkOutcome outcome_;
  Places places_;              ///< where the last window was parted
  std::vector<double> above_;  ///< order statistics of the row of windows before
  std::int32_t rank_count_ = 0;
  QuantileRank rank_;  ///< of rank_count_ values
};

}  // namespace landfall
