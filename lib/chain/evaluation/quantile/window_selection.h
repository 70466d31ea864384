// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "chain/evaluation/quantile/window_quantile.h"

namespace landfall {

/// Eq. 12 for one window at a time, by selection among all its bins: O(window).
class WindowSelection {
 public:
  explicit WindowSelection(const WindowQuantileInput& input);
  /// The window must hold a valid bin.
  [[nodiscard]] double at(BinIndex bin);

 private:
  const WindowQuantileInput& input_;
  std::vector<double> deviations_;
};

}  // namespace landfall
