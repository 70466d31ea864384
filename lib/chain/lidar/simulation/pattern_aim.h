// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "base/geometry/frames.h"
#include "chain/lidar/scanner/pattern.h"
#include "chain/lidar/scanner/scanner.h"

namespace landfall {

/// The direction from the lidar, at this pose, to a point.
[[nodiscard]] Direction<LidarFrame> direction_to(const Point<DemFrame>& target,
                                                 const Transform<DemFrame, LidarFrame>& T_dem_lidar);

/// A time within one pulse interval before or after a pulse.
struct TimeNearPulse {
  PulseTime pulse;
  double later_s = 0;
};

/// The aim of a pattern between its pulses and around its jumps. The pattern must outlive this object.
class PatternAim {
 public:
  /// `interval_s` between two pulses; 0: the aim is taken as constant.
  PatternAim(const Pattern& pattern, double interval_s) : pattern_(pattern), interval_s_(interval_s) {}

  /// The time of `pulse` plus `error_s`, as a whole number of pulses from `pulse`, rounded towards it, and
  /// the remaining time, which has the sign of the error. If the pattern has no aim there (before its start,
  /// after its end, at a blanked pulse), `pulse` itself without the error.
  [[nodiscard]] TimeNearPulse time_after(const PulseTime& pulse, double error_s) const;

  /// The point that the pattern aims at `later_s` after a pulse that has an aim, moving linearly from pulse
  /// to pulse. Before a jump or a pulse without an aim it extrapolates from the two previous pulses; at a
  /// negative time after a jump, at most one interval before the pulse, from the two next ones.
  [[nodiscard]] Point<DemFrame> at(const PulseTime& pulse, double later_s) const;

  /// The aims around the last jump before a pulse, from the lidar at this pose.
  [[nodiscard]] JumpAims around(const PatternJump& jump, const PulseTime& pulse,
                                const Transform<DemFrame, LidarFrame>& T_dem_lidar) const;

 private:
  [[nodiscard]] PulseTime ahead(const PulseTime& pulse, std::int64_t count) const;
  [[nodiscard]] std::int64_t pulses_without_jump(const PulseTime& pulse, std::int64_t maximum) const;
  [[nodiscard]] Point<DemFrame> after(const PulseTime& pulse, double later_s) const;
  [[nodiscard]] Point<DemFrame> before(const PulseTime& pulse, double earlier_s) const;

  const Pattern& pattern_;
  double interval_s_;
};

}  // namespace landfall
