// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/geometry/frames.h"

namespace landfall {

/// T_dem_body: position and attitude of the lander.
using Pose = Transform<DemFrame, BodyFrame>;

/// Times this close to the first or the last one that has a pose have that pose.
inline constexpr double kTimeSlack_s = 1e-9;

/// The motion of the lander as a pure function of time. Any number of threads may call it.
///
/// Times are seconds since the epoch of the motion, the time of its first pulse. A clock may show any number
/// then, such as 1.4e9 s: the sum of the two would lose the digits that positions need.
class Trajectory {
 public:
  virtual ~Trajectory() = default;

  /// Throws FormatError, naming the time and the span, outside [earliest_time_s(), end_time_s()].
  [[nodiscard]] virtual Pose pose(double t_s) const = 0;
  /// The planned pose at that time, independent of the real motion. Patterns compute their aim from it.
  [[nodiscard]] virtual Pose nominal_pose(double t_s) const { return pose(t_s); }
  /// t0: what the clock of the motion shows at its epoch.
  [[nodiscard]] virtual double epoch_s() const { return 0; }
  /// The first time that has a pose; minus infinity where the motion has no beginning.
  [[nodiscard]] virtual double earliest_time_s() const { return 0; }
  /// The last time that has a pose; infinite where the motion has no end.
  [[nodiscard]] virtual double end_time_s() const = 0;
};

}  // namespace landfall
