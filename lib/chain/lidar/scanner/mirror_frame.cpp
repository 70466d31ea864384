// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/scanner/mirror_frame.h"

#include <Eigen/Geometry>
#include <numbers>

#include "base/geometry/rotation.h"
#include "base/geometry/rotation_vector.h"
#include "base/geometry/vector_check.h"
#include "base/numerics/portable_math.h"

namespace landfall {

using Eigen::Matrix3d;
using Eigen::Vector3d;

MirrorFrame::MirrorFrame(double incidence_rad, double fold_azimuth_rad) {
  require_angle(incidence_rad >= 0 && incidence_rad < std::numbers::pi / 2, {"", "incidence_deg"},
                incidence_rad, "in [0, 90)");
  require_finite({"", "fold_azimuth_deg"}, fold_azimuth_rad);
  const Matrix3d fold = rotation_matrix({0, 0, fold_azimuth_rad});
  incoming_ = fold * Vector3d(0, -portable::sin(2 * incidence_rad), -portable::cos(2 * incidence_rad));
  resting_ = (Vector3d::UnitZ() - incoming_).normalized();
  axis_1_ = fold.col(0);
  axis_2_ = resting_.cross(axis_1_);
}

Matrix3d MirrorFrame::rotation(const TiltAngles& tilts) const {
  return (quaternion_of(tilts.angle_1_rad * axis_1_) * quaternion_of(tilts.angle_2_rad * axis_2_))
      .toRotationMatrix();
}

Direction<LidarFrame> MirrorFrame::normal(const TiltAngles& tilts) const {
  // In the axes (e1, e2, m0): m = (sin a2, -sin a1 cos a2, cos a1 cos a2).
  const double across = portable::cos(tilts.angle_2_rad);
  return {portable::sin(tilts.angle_2_rad) * axis_1_ - portable::sin(tilts.angle_1_rad) * across * axis_2_ +
          portable::cos(tilts.angle_1_rad) * across * resting_};
}

TiltAngles MirrorFrame::tilts(const Direction<LidarFrame>& normal) const {
  const double m1 = normal.v.dot(axis_1_);
  const double m2 = normal.v.dot(axis_2_);
  const double m3 = normal.v.dot(resting_);
  return {portable::atan2(-m2, m3), portable::atan2(m1, portable::hypot(m2, m3))};
}

Matrix3d MirrorFrame::steering(const Direction<LidarFrame>& normal) const {
  return reflection(normal.v) * reflection(resting_);
}

}  // namespace landfall
