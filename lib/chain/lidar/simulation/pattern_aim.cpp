// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D10
#include "chain/lidar/simulation/pattern_aim.h"

#include <cmath>

namespace landfall {

Direction<LidarFrame> direction_to(const Point<DemFrame>& target,
                                   const Transform<DemFrame, LidarFrame>& T_dem_lidar) {
  return Direction<LidarFrame>::of(T_dem_lidar.rotation.inverse() * (target - T_dem_lidar.position));
}

PulseTime PatternAim::ahead(const PulseTime& pulse, std::int64_t count) const {
  return {pulse.pulse + count, pulse.since_start_s + static_cast<double>(count) * interval_s_};
}

/// The offset of the last pulse before the pattern's next jump; `maximum` if it does not jump before.
std::int64_t PatternAim::pulses_without_jump(const PulseTime& pulse, std::int64_t maximum) const {
  while (const auto jump = pattern_.last_jump(ahead(pulse, maximum))) {
    const std::int64_t before = jump->before.pulse - pulse.pulse;
    if (before < 0) break;
    maximum = before;
  }
  return maximum;
}

Point<DemFrame> PatternAim::after(const PulseTime& pulse, double later_s) const {
  const double pulses = interval_s_ > 0 ? later_s / interval_s_ : 0;
  const auto aim = [&](std::int64_t count) { return pattern_.aim_point(ahead(pulse, count)); };
  const std::int64_t wanted = static_cast<std::int64_t>(pulses) + 1;
  const std::int64_t last = pulses_without_jump(pulse, wanted);
  std::int64_t to = last;
  while (to > 0 && !aim(to)) --to;
  std::int64_t from = to - 1;
  if (pulse.pulse + from < 0) return *aim(to);
  if (to == 0) {
    const auto jump = pattern_.last_jump(pulse);
    if (jump && jump->before.pulse == pulse.pulse - 1) return *aim(0);  // the step lasts a single pulse
  }
  const auto start = aim(from);
  if (!start) return *aim(to);
  return *start + (pulses - static_cast<double>(from)) * (*aim(to) - *start);
}

Point<DemFrame> PatternAim::before(const PulseTime& pulse, double earlier_s) const {
  const auto aim = [&](std::int64_t count) { return pattern_.aim_point(ahead(pulse, count)); };
  const auto jump = pattern_.last_jump(pulse);
  const bool is_first = pulse.pulse == 0 || (jump && jump->before.pulse == pulse.pulse - 1) || !aim(-1);
  if (is_first && (pulses_without_jump(pulse, 1) == 0 || !aim(1))) return *aim(0);
  const Vector<DemFrame> motion = is_first ? *aim(1) - *aim(0) : *aim(0) - *aim(-1);
  return *aim(0) - (earlier_s / interval_s_) * motion;
}

Point<DemFrame> PatternAim::at(const PulseTime& pulse, double later_s) const {
  return later_s < 0 ? before(pulse, -later_s) : after(pulse, later_s);
}

TimeNearPulse PatternAim::time_after(const PulseTime& pulse, double error_s) const {
  if (error_s == 0 || interval_s_ == 0) return {pulse};
  const double pulses = std::trunc(error_s / interval_s_);
  const PulseTime there = ahead(pulse, static_cast<std::int64_t>(pulses));
  if (there.pulse < 0 || !pattern_.aim_point(there)) return {pulse};
  return {there, error_s - pulses * interval_s_};
}

JumpAims PatternAim::around(const PatternJump& jump, const PulseTime& pulse,
                            const Transform<DemFrame, LidarFrame>& T_dem_lidar) const {
  const auto time = [&](std::int64_t number) { return ahead(pulse, number - pulse.pulse); };
  const auto begins_at = [&](std::int64_t number) {
    const auto last_jump = pattern_.last_jump(time(number));
    return last_jump && last_jump->before.pulse + 1 == number;
  };
  const auto aim = [&](std::int64_t number, std::int64_t otherwise) {
    const auto point = pattern_.aim_point(time(number));
    return direction_to(point ? *point : *pattern_.aim_point(time(otherwise)), T_dem_lidar);
  };
  const std::int64_t last = jump.before.pulse;
  const std::int64_t first = last + 1;
  return {.before_last = aim(last == 0 || begins_at(last) ? last : last - 1, last),
          .last = aim(last, last),
          .first = aim(first, first),
          .second = aim(begins_at(first + 1) ? first : first + 1, first),
          .interval_s = interval_s_};
}

}  // namespace landfall
