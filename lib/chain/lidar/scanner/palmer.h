// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <numbers>

#include "chain/lidar/scanner/mirror_frame.h"
#include "chain/lidar/scanner/scanner.h"

namespace landfall {

struct PalmerParameters {
  double tilt_rad = std::numbers::pi / 72;      ///< of the normal off the axis, >= 0, tilt + incidence < pi/2
  double incidence_rad = std::numbers::pi / 4;  ///< of the boresight on the axis, in [0, pi/2)
  double fold_azimuth_rad = 0;                  ///< as in FsmParameters
  double rate_hz = 100;                         ///< revolutions per second, finite and positive
  double phase_rad = 0;                         ///< of the motor at the first pulse
};

/// A flat mirror on a motor, its normal tilted off the rotation axis.
///
/// The axis is the normal m0 of a MirrorFrame with this incidence. At motor angle phi the normal is m = R(m0,
/// phi) R(e1, tilt) m0, and d' = M(m) M(m0) d: the pattern is centred on +z_L. angle_1 is phi in [0, 2 pi),
/// angle_2 is 0. At phi = 0 the boresight leans towards Rz(fold_azimuth) (-y_L).
///
/// At incidence 0 the boresight traces a cone of half angle 2 tilt, exactly. At incidence i it traces an
/// egg-shaped curve; to first order an ellipse with the semi-axes 2 tilt in the plane of incidence and 2 tilt
/// cos i across it. b = 0: the boresight meets the mirror on the axis.
class Palmer : public Scanner {
 public:
  /// Throws UsageError, naming the key and the bound, for a parameter out of range.
  explicit Palmer(const PalmerParameters& parameters);

  [[nodiscard]] ScannerState state(const PulseContext& pulse) const override;
  void steer(const ScannerState& state, std::span<const Direction<LidarFrame>> pixels,
             std::span<Beam> beams) const override;

 private:
  PalmerParameters parameters_;
  MirrorFrame mirror_;
  Eigen::Vector3d tilted_;  // the normal at phi = 0
};

}  // namespace landfall
