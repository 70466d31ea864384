// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "scanner/pattern.h"

namespace landfall {

struct StareParameters {
  std::array<double, 2> aim_m{0, 0};  ///< x, y; finite
  bool compensated = true;
};

/// One point on the map at every pulse. Compensated, the boresight tracks it; otherwise the scanner keeps the
/// angle at which the boresight meets it from the first pose.
class Stare : public Pattern {
 public:
  /// Throws UsageError, naming the key and the bound, for a parameter out of range.
  explicit Stare(const StareParameters& parameters);

  [[nodiscard]] std::optional<Point<DemFrame>> ground_aim(const PulseTime& pulse) const override;

 private:
  StareParameters parameters_;
};

}  // namespace landfall
