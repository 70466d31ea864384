// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "base/geometry/frames.h"
#include "chain/lidar/scanner/mechanism.h"

namespace landfall {

/// A flat mirror in L and its two tilt axes.
///
/// The boresight comes in along d0 = Rz(fold_azimuth) (0, -sin 2i, -cos 2i), i the incidence; the resting
/// mirror, normal m0, sends it to +z_L. Pixel directions are given after the resting mirror, so they arrive
/// reflected by it: d = M(m0) pixel, and leave as d' = M(m) d, M(m) = I - 2 m m^T. e1 = Rz(fold_azimuth) (1,
/// 0, 0) lies in the mirror across the plane of incidence, e2 = m0 x e1.
class MirrorFrame {
 public:
  /// Throws UsageError, naming the key, unless incidence is in [0, pi/2) and the azimuth finite.
  MirrorFrame(double incidence_rad, double fold_azimuth_rad);

  [[nodiscard]] const Eigen::Vector3d& incoming() const { return incoming_; }  ///< d0
  [[nodiscard]] Direction<LidarFrame> resting() const { return {resting_}; }   ///< m0

  /// The normal that sends the boresight to the unit vector c: m = (c - d0)/|c - d0|. Exact, to 1e-15.
  [[nodiscard]] Direction<LidarFrame> normal_towards(const Direction<LidarFrame>& c) const {
    return {(c.v - incoming_).normalized()};
  }
  /// The rotation from the resting to the tilted mirror: R(e1, angle_1) R(e2, angle_2).
  [[nodiscard]] Eigen::Matrix3d rotation(const TiltAngles& tilts) const;
  /// m = rotation(tilts) m0.
  [[nodiscard]] Direction<LidarFrame> normal(const TiltAngles& tilts) const;
  /// The tilts that give a normal, angle_2 within +-pi/2.
  [[nodiscard]] TiltAngles tilts(const Direction<LidarFrame>& normal) const;

  /// M(m) M(m0), which maps a pixel's direction to d'.
  [[nodiscard]] Eigen::Matrix3d steering(const Direction<LidarFrame>& normal) const;

 private:
  Eigen::Vector3d incoming_;
  Eigen::Vector3d resting_;
  Eigen::Vector3d axis_1_;
  Eigen::Vector3d axis_2_;
};

/// M(m) = I - 2 m m^T.
[[nodiscard]] inline Eigen::Matrix3d reflection(const Eigen::Vector3d& normal) {
  return Eigen::Matrix3d::Identity() - 2 * normal * normal.transpose();
}

}  // namespace landfall
