// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "geometry/frames.h"
#include "scanner/pulse_time.h"

namespace landfall {

/// Where the boresight shall meet the ground, pulse by pulse: a pure function of time.
class Pattern {
 public:
  virtual ~Pattern() = default;

  /// A point on the map, z = 0; none for a pulse that shall not be fired.
  [[nodiscard]] virtual std::optional<Point<DemFrame>> ground_aim(const PulseTime& pulse) const = 0;
  /// The pulses after which the scan ends; none for a pattern that goes on.
  [[nodiscard]] virtual std::optional<std::int64_t> pulse_limit() const = 0;
  /// True: aim from where the lander nominally is at that pulse. False: always from where it nominally
  /// starts, as a scanner does that replays fixed angles.
  [[nodiscard]] virtual bool compensated() const = 0;
};

}  // namespace landfall
