// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <numbers>
#include <vector>

#include "chain/lidar/scanner/mechanism.h"
#include "chain/lidar/scanner/scanner.h"

namespace landfall {

/// R = Rx(angle_1) Ry(angle_2): outer axis x_L, inner axis y_L. Sends +z to
/// (sin a2, -sin a1 cos a2, cos a1 cos a2).
[[nodiscard]] Eigen::Matrix3d gimbal_rotation(const TiltAngles& angles);

/// The angles that send +z to a direction, angle_2 within +-pi/2.
[[nodiscard]] TiltAngles gimbal_angles(const Direction<LidarFrame>& aim);

struct GimbalParameters {
  double max_deflection_rad = std::numbers::pi / 6;  ///< aims farther off +z_L are refused; in (0, pi/2)
  MechanismTimingParameters timing{};
  std::vector<EncoderHarmonic> encoder_harmonics{};
};

/// A gimbal with two axes that cross at the focal point and turn the whole camera: d' = R d, b = 0.
///
/// Outer axis x_L by angle_1, inner axis y_L by angle_2. The image turns with the camera: an aim with both
/// angles turns it about the line of sight by angle_1 angle_2 / 2 to first order, relative to the shortest
/// turn. After a jump it blanks and settles like an Fsm.
class Gimbal : public Scanner {
 public:
  /// Throws UsageError, naming the key and the bound, for a parameter out of range.
  explicit Gimbal(const GimbalParameters& parameters);

  /// Without an aim the gimbal rests at 0, 0. Throws FormatError, naming pulse and angle, for an aim beyond
  /// max_deflection.
  [[nodiscard]] ScannerState state(const PulseContext& pulse) const override;
  [[nodiscard]] ContextNeeds needs() const override {
    return {.jumps = timing_.depends_on_jumps(), .motion = timing_.is_accelerated()};
  }
  [[nodiscard]] bool is_known() const override { return encoder_harmonics_.empty(); }
  /// The readings of the encoders.
  [[nodiscard]] ScannerState estimated_state(const PulseContext& pulse,
                                             const ScannerState& truth) const override;
  void steer(const ScannerState& state, std::span<const Direction<LidarFrame>> pixels,
             std::span<Beam> beams) const override;

 private:
  DeflectionLimit limit_;
  MechanismTiming timing_;
  std::vector<EncoderHarmonic> encoder_harmonics_;
};

}  // namespace landfall
