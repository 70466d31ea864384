// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <numbers>
#include <vector>

#include "base/numerics/random_seed.h"
#include "chain/lidar/scanner/mechanism.h"
#include "chain/lidar/scanner/mirror_frame.h"
#include "chain/lidar/scanner/scanner.h"

namespace landfall {

struct FsmParameters {
  /// Angle i of the boresight on the resting mirror, >= 0. 0: no image rotation; 45 deg: a folded design.
  double incidence_rad = 0;
  /// Rotates the plane of incidence about +z_L, right-handedly; at 0 the boresight arrives from +y_L.
  double fold_azimuth_rad = 0;
  /// Aims farther off +z_L are refused; > 0 and < pi - 2 incidence, where the mirror is seen edge-on.
  double max_deflection_rad = std::numbers::pi / 6;
  /// The point about which the mirror turns, in L from where the boresight meets the resting mirror.
  Vector<LidarFrame> pivot_m{};
  /// Distance from the focal point along the boresight to the resting mirror, >= 0.
  double focal_distance_m = 0;
  double encoder_sigma_rad = 0;  ///< one sigma of the reading of each tilt, per pulse, >= 0
  std::vector<EncoderHarmonic> encoder_harmonics{};
  MechanismTimingParameters timing{};
  bool tof_lag = false;  ///< the line of sight uses the mirror's tilts at the time of the echo
  RandomSeed seed = {};  ///< of the encoder's noise
};

/// A fast steering mirror: one flat mirror on two axes (chain/lidar/scanner/mirror_frame.h).
///
/// To aim the boresight at the unit vector c, m = (c - d0)/|c - d0|: exact, to 1e-15. angle_1 and angle_2 are
/// the mirror's tilts: m = R m0, R = R(e1, angle_1) R(e2, angle_2). Small tilts move the line of sight by
/// 2 angle_1 in the plane of incidence and by 2 cos(i) angle_2 across it; a cross-plane motion psi turns the
/// image by psi tan i, to first order.
///
/// Exit point: the mirror's plane goes through c = pivot - R pivot; a pixel's ray leaves the focal point f =
/// -focal_distance d0 along d and meets it at b = f + d ((c - f).m)/(d.m). With both at 0, b = 0. A ray that
/// would meet the back of the mirror is lost.
///
/// After a jump of the aim (chain/lidar/scanner/mechanism.h) pulses are blanked, and the tilts still differ
/// from the commanded ones by step_left() times the tilts before the jump minus the commanded ones. The
/// encoder measures this difference. With a largest acceleration, the pulses until both tilts have caught up
/// with the aim are blanked too. The encoder measures neither its own errors (noise, harmonics) nor tof_lag:
/// state() is then the mirror at the echo, while the lander assumes the mirror at the pulse.
class Fsm : public Scanner {
 public:
  /// Throws UsageError, naming the key and the bound, for a parameter out of range.
  explicit Fsm(const FsmParameters& parameters);

  /// Without an aim the mirror rests. Throws FormatError, naming pulse and angle, for an aim beyond
  /// max_deflection.
  [[nodiscard]] ScannerState state(const PulseContext& pulse) const override;
  void steer(const ScannerState& state, std::span<const Direction<LidarFrame>> pixels,
             std::span<Beam> beams) const override;
  [[nodiscard]] ContextNeeds needs() const override {
    return {
        .jumps = timing_.depends_on_jumps(), .echo = parameters_.tof_lag, .motion = timing_.is_accelerated()};
  }
  [[nodiscard]] bool is_known() const override;
  [[nodiscard]] ScannerState estimated_state(const PulseContext& pulse,
                                             const ScannerState& truth) const override;

 private:
  [[nodiscard]] ScannerState following(const PulseContext& pulse,
                                       const std::optional<Direction<LidarFrame>>& aim) const;
  [[nodiscard]] ScannerState with_tilts(const ScannerState& state, const TiltAngles& tilts) const;
  void steer_from_focal_point(const ScannerState& state, std::span<const Direction<LidarFrame>> pixels,
                              std::span<Beam> beams) const;

  FsmParameters parameters_;
  MirrorFrame mirror_;
  DeflectionLimit limit_;
  MechanismTiming timing_;
};

}  // namespace landfall
