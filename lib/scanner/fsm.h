// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <numbers>

#include "scanner/scanner.h"

namespace landfall {

struct FsmParameters {
  /// Angle i of the boresight on the resting mirror, >= 0. 0: no image rotation; 45 deg: a folded design.
  double incidence_rad = 0;
  /// Turns the plane of incidence about +z_L, right-handedly; at 0 the boresight comes in from +y_L.
  double fold_azimuth_rad = 0;
  /// Aims farther off +z_L than this are refused; > 0 and < pi - 2 incidence, where the mirror is edge-on.
  double max_deflection_rad = std::numbers::pi / 6;
};

/// A fast steering mirror: one flat mirror on two axes that turns about a point of its surface on the
/// boresight, so that b = 0.
///
/// The boresight comes in along d0 = Rz(fold_azimuth) (0, -sin 2i, -cos 2i); the resting mirror, normal m0,
/// sends it to +z_L. Pixel directions are given behind the resting mirror, so they come in reflected by it:
/// d = M(m0) pixel, and leave as d' = M(m) d, M(m) = I - 2 m m^T. To aim the boresight at the unit vector c,
/// m = (c - d0)/|c - d0|: exact, to 1e-15.
///
/// angle_1 and angle_2 are the mirror's tilts: m = R(e1, angle_1) R(e2, angle_2) m0, where
/// e1 = Rz(fold_azimuth) (1, 0, 0) lies in the mirror across the plane of incidence, and e2 = m0 x e1.
/// Small tilts move the line of sight by 2 angle_1 in the plane of incidence and by 2 cos(i) angle_2 across
/// it; a cross-plane motion psi turns the image by psi tan i, to first order.
class Fsm : public Scanner {
 public:
  /// Throws UsageError, naming the key and the bound, for a parameter out of range.
  explicit Fsm(const FsmParameters& parameters);

  /// Without an aim the mirror rests. Throws FormatError, naming pulse and angle, for an aim beyond
  /// max_deflection.
  [[nodiscard]] ScannerState state(const PulseContext& pulse) const override;
  void steer(const ScannerState& state, std::span<const Direction<LidarFrame>> pixels,
             std::span<Beam> beams) const override;

 private:
  double max_deflection_rad_;
  Eigen::Vector3d incoming_;  // d0
  Eigen::Vector3d resting_;   // m0
  Eigen::Vector3d axis_1_;    // e1
  Eigen::Vector3d axis_2_;    // e2
};

}  // namespace landfall
