// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "chain/evaluation/quantile/error_tails.h"
#include "chain/evaluation/quantile/window_quantile.h"

namespace landfall {

/// The result of a walk over a tile's windows.
struct WalkOutcome {
  std::int64_t uncertified = 0;  ///< windows still to be computed
  /// At most the lower of the two order statistics of each of them.
  double lower_bound = std::numeric_limits<double>::infinity();
  /// The smallest quantile found in this walk.
  double smallest = std::numeric_limits<double>::infinity();
};

/// Takes the quantile of each window of a tile from sorted tails. Neighbours have nearly equal answers, so
/// each window starts from a prediction t, takes the members that deviate by more than t, and moves a few
/// members on or back until its position is between the two order statistics.
class TailWalk {
 public:
  /// The result is NaN where a window is still to be computed.
  TailWalk(const WindowQuantileInput& input, Grid<double>& result) : input_(input), result_(result) {}

  /// `tails` holds every bin that deviates by more than `floor` from the mean of any pending window. An order
  /// statistic found in them is exact if it is at least `floor`: an omitted bin could replace it only by an
  /// equal value.
  [[nodiscard]] WalkOutcome run(ErrorTails& tails, const Tile& tile, double floor);

 private:
  const WindowQuantileInput& input_;
  Grid<double>& result_;
  std::vector<double> above_;  ///< order statistics of the previous row of windows
};

}  // namespace landfall
