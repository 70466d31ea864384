// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "geometry/frames.h"
#include "scanner/pulse_time.h"

namespace landfall {

/// The last time that an aim jumped, at or before a pulse.
struct PatternJump {
  double since_s = 0;  ///< from the first pulse after the jump to this one
  PulseTime before{};  ///< the last pulse before it
};

/// Where the boresight shall meet the ground, pulse by pulse: a pure function of time.
class Pattern {
 public:
  virtual ~Pattern() = default;

  /// A point on the map, z = 0; none for a pulse that shall not be fired.
  [[nodiscard]] virtual std::optional<Point<DemFrame>> ground_aim(const PulseTime& pulse) const = 0;
  /// None where the aim moves without jumps, or has not jumped yet.
  [[nodiscard]] virtual std::optional<PatternJump> last_jump(const PulseTime&) const { return std::nullopt; }
  /// The pulses after which the scan ends; none for a pattern that goes on.
  [[nodiscard]] virtual std::optional<std::int64_t> pulse_limit() const = 0;
  /// True: aim from where the lander nominally is at that pulse. False: always from where it nominally
  /// starts, as a scanner does that replays fixed angles.
  [[nodiscard]] virtual bool compensated() const = 0;
};

}  // namespace landfall
