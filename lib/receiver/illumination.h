// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "geometry/frames.h"

namespace landfall {

enum class BeamProfile { gaussian, top_hat };

struct IlluminationParameters {
  BeamProfile profile = BeamProfile::gaussian;
  /// Full angle: at 1/e^2 of the irradiance on the axis (gaussian), or from edge to edge (top_hat); in (0,
  /// pi). Empty: the same irradiance in every direction.
  std::optional<double> divergence_rad{};
  /// Angles of the beam's axis from +z_L towards +x_L and +y_L, before steering, in (-pi/2, pi/2).
  double offset_x_rad = 0;
  double offset_y_rad = 0;
};

/// The transmitted beam, which the scanner steers together with the pixels' lines of sight.
class Illumination {
 public:
  /// Throws UsageError, naming the key and the bound, for a parameter out of range.
  explicit Illumination(const IlluminationParameters& parameters = {});

  /// Irradiance over that on the axis, in [0, 1], in the direction in which a pixel or sub-pixel looks before
  /// steering. gaussian: exp(-8 theta^2/divergence^2), theta the angle from the axis.
  [[nodiscard]] double relative(const Direction<LidarFrame>& direction) const;
  /// The fraction of the pulse's energy per steradian on the axis: 8/(pi divergence^2) for a Gaussian beam,
  /// 4/(pi divergence^2) for a top hat. Empty without a divergence.
  [[nodiscard]] std::optional<double> peak_per_sr() const;

 private:
  IlluminationParameters parameters_;
  Direction<LidarFrame> axis_;
};

}  // namespace landfall
