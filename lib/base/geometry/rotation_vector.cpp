// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/geometry/rotation_vector.h"

#include "base/numerics/portable_math.h"

namespace landfall {
namespace {

/// (1 - a/2 cot(a/2)) / a^2; below 0.02 rad by its series, because the difference would cancel.
double bortz_factor(double a) {
  if (a < 0.02) return 1.0 / 12 + a * a / 720;
  return (1 - a / 2 / portable::tan(a / 2)) / (a * a);
}

}  // namespace

Eigen::Quaterniond quaternion_of(const Eigen::Vector3d& phi) {
  const double angle = phi.norm();
  if (angle == 0) return Eigen::Quaterniond::Identity();
  Eigen::Quaterniond q;
  q.w() = portable::cos(angle / 2);
  q.vec() = portable::sin(angle / 2) / angle * phi;
  return q;
}

Eigen::Vector3d rotation_vector(const Eigen::Quaterniond& q) {
  const double sine = q.vec().norm();
  if (sine == 0) return Eigen::Vector3d::Zero();
  const double sign = q.w() < 0 ? -1 : 1;
  return sign * 2 * portable::atan2(sine, sign * q.w()) / sine * q.vec();
}

Eigen::Vector3d rotation_vector_rate(const Eigen::Vector3d& phi, const Eigen::Vector3d& omega) {
  const Eigen::Vector3d turned = phi.cross(omega);
  return omega + 0.5 * turned + bortz_factor(phi.norm()) * phi.cross(turned);
}

}  // namespace landfall
