// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scanner/mechanism_timing.h"
#include "scanner/scanner.h"

namespace landfall {

/// The motion of two axes around a jump; `angles_towards` gives the angles of an aim.
template <class AnglesTowards>
AxesJump axes_jump(const JumpAims& aims, const AnglesTowards& angles_towards) {
  const auto rate = [&](const TiltAngles& from, const TiltAngles& to) {
    return TiltAngles{(to.angle_1_rad - from.angle_1_rad) / aims.interval_s,
                      (to.angle_2_rad - from.angle_2_rad) / aims.interval_s};
  };
  const TiltAngles last = angles_towards(aims.last);
  const TiltAngles first = angles_towards(aims.first);
  return {.before = last,
          .rate_before = rate(angles_towards(aims.before_last), last),
          .after = first,
          .rate_after = rate(first, angles_towards(aims.second)),
          .interval_s = aims.interval_s};
}

}  // namespace landfall
