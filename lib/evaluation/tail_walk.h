// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "evaluation/error_tails.h"
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
  const WindowQuantileInput& input_;
  Grid<double>& result_;
  std::vector<double> above_;  ///< order statistics of the row of windows before
};

}  // namespace landfall
