// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "base/geometry/frames.h"
#include "chain/lidar/scanner/scanner.h"

namespace landfall {

/// The two angles of a two-axis mechanism, radians: the outer axis turns by angle_1 and carries the inner
/// one, which turns by angle_2.
struct TiltAngles {
  double angle_1_rad = 0;
  double angle_2_rad = 0;
  friend bool operator==(const TiltAngles&, const TiltAngles&) = default;
};

/// Linear interpolation a + s (b - a) of each angle.
inline TiltAngles between(const TiltAngles& a, double s, const TiltAngles& b) {
  return {a.angle_1_rad + s * (b.angle_1_rad - a.angle_1_rad),
          a.angle_2_rad + s * (b.angle_2_rad - a.angle_2_rad)};
}

/// One harmonic of an encoder's nonlinearity: the reading of an angle a is a + amplitude sin(order a +
/// phase). Order 1 is an eccentric disc, 2 an elliptic one; the number of lines of the disc is the error of
/// the interpolation between two of them.
struct EncoderHarmonic {
  int axis = 1;              ///< 1: angle_1, 2: angle_2
  int order = 1;             ///< 1 .. 2^20
  double amplitude_rad = 0;  ///< finite
  double phase_rad = 0;      ///< finite
};

/// Throws UsageError, naming encoder_harmonics/i/key and the bound, for a parameter out of range.
void check(const std::vector<EncoderHarmonic>& harmonics);

/// The readings minus the angles.
[[nodiscard]] TiltAngles encoder_error(const std::vector<EncoderHarmonic>& harmonics,
                                       const TiltAngles& angles);

/// How far off +z_L a mechanism can point.
class DeflectionLimit {
 public:
  /// The mechanism has already checked its limit `max_rad`.
  explicit DeflectionLimit(double max_rad) : max_rad_(max_rad) {}

  /// Throws FormatError, naming pulse and angle, for an aim beyond the limit, or one that is NaN.
  void require_within(const Direction<LidarFrame>& aim, std::int64_t pulse) const;

 private:
  double max_rad_;
};

struct MechanismTimingParameters {
  /// Pulses within this time after a jump of the aim are blanked; finite, >= 0.
  double turnaround_time_s = 0;
  /// Three time constants, 3/(zeta w_n): at most e^-3/sqrt(1 - zeta^2) of a step remains, which is 7 % at a
  /// damping of 0.7 and 11 % at 0.9; finite, >= 0. 0: the mechanism follows at once.
  double settle_time_s = 0;
  double settle_damping = 0.7;  ///< damping ratio zeta, in (0, 1)
  /// Largest angular acceleration of each axis, finite, >= 0. 0: unlimited.
  double max_acceleration_radps2 = 0;
};

/// The motion of two axes around a jump of the aim, from the last pulse before it to the first one after it.
struct AxesJump {
  TiltAngles before{};       ///< at the last pulse before the jump
  TiltAngles rate_before{};  ///< radians per second
  TiltAngles after{};        ///< at the first pulse after the jump
  TiltAngles rate_after{};
  double interval_s = 0;  ///< between the two pulses
};

/// The shortest time in which an axis with the largest angular acceleration a > 0 reaches an aim that moves
/// at constant speed, and ends at the aim's speed. At the start the aim is D = `ahead_rad` away, and the axis
/// moves towards it at the relative speed u = `closing_radps`. The axis accelerates fully, then brakes fully:
/// with s = sign(D - u |u|/2a),
///   T = (2 sqrt(u^2/2 + s a D) - s u)/a,
/// which is 2 sqrt(|D|/a) from rest and (1 + sqrt 2) |u|/a for an axis that passes its aim at the speed u.
[[nodiscard]] double transfer_time_s(double ahead_rad, double closing_radps, double acceleration_radps2);

/// How a mechanism follows a jump of its aim (a new line, the next step of a mosaic).
class MechanismTiming {
 public:
  /// Throws UsageError, naming the key and the bound, for a parameter out of range.
  explicit MechanismTiming(const MechanismTimingParameters& parameters);

  /// True if jumps affect the mechanism.
  [[nodiscard]] bool depends_on_jumps() const {
    return parameters_.turnaround_time_s > 0 || parameters_.settle_time_s > 0 || is_accelerated();
  }
  [[nodiscard]] bool is_accelerated() const { return parameters_.max_acceleration_radps2 > 0; }

  /// True if an axis with limited acceleration has not yet reached the aim at the pulse `since_jump_s` after
  /// the first pulse after the jump. Both axes start at the last pulse before the jump and meet the moving
  /// aim in the shortest time; the slower one counts. False from 1 ns before the end of the motion on.
  [[nodiscard]] bool is_moving(double since_jump_s, const AxesJump& jump) const;

  /// True for a pulse within the turnaround time after the jump. False from 1 ns before its end on, so that a
  /// pulse due at the end is fired even if its time is rounded.
  [[nodiscard]] bool blanks(double since_jump_s) const;

  /// The fraction of a step that a second-order loop has not yet made at t = `since_jump_s`:
  ///   e(t) = e^(-zeta w_n t) (cos w_d t + zeta/sqrt(1 - zeta^2) sin w_d t), w_d = w_n sqrt(1 - zeta^2),
  /// 1 at t = 0, starting at rest; negative where it overshoots. |e| <= e^(-zeta w_n t)/sqrt(1 - zeta^2).
  /// Exactly 0 without settling, and once the exponential is below e^-40, also at infinite t.
  [[nodiscard]] double step_left(double since_jump_s) const;

 private:
  MechanismTimingParameters parameters_;
  double decay_per_s_ = 0;   // zeta w_n
  double damped_radps_ = 0;  // w_d
  double sine_share_ = 0;    // zeta/sqrt(1 - zeta^2)
};

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
