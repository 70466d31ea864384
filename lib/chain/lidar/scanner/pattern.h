// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "base/geometry/frames.h"

namespace landfall {

/// A pulse: its number, counted from 0, and its time since the first one.
struct PulseTime {
  std::int64_t pulse = 0;
  double since_start_s = 0;
};

/// The last jump of the aim at or before a pulse.
struct PatternJump {
  double since_s = 0;  ///< from the first pulse after the jump to this one
  PulseTime before{};  ///< the last pulse before the jump
};

/// The point at which the boresight should meet the ground at each pulse: a pure function of time.
class Pattern {
 public:
  virtual ~Pattern() = default;

  /// A point on the map, z = 0; empty for a pulse that is not fired.
  [[nodiscard]] virtual std::optional<Point<DemFrame>> aim_point(const PulseTime& pulse) const = 0;
  /// Empty where the aim moves without jumps or has not jumped yet.
  [[nodiscard]] virtual std::optional<PatternJump> last_jump(const PulseTime&) const { return std::nullopt; }
  /// The number of pulses after which the scan ends; empty for a pattern without an end.
  [[nodiscard]] virtual std::optional<std::int64_t> pulse_limit() const { return std::nullopt; }
  /// True: the aim is computed from the lander's nominal pose at that pulse. False: always from its nominal
  /// start, like a scanner that replays fixed angles.
  [[nodiscard]] bool compensated() const { return compensated_; }

 protected:
  explicit Pattern(bool compensated = true) : compensated_(compensated) {}

 private:
  bool compensated_;
};

}  // namespace landfall
