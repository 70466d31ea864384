// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanner/fsm.h"

#include <cmath>
#include <sstream>

#include "base/error.h"
#include "base/parameter_check.h"
#include "geometry/rotation.h"

namespace landfall {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

void check(const FsmParameters& p) {
  require(p.incidence_rad >= 0 && p.incidence_rad < std::numbers::pi / 2, {"scanner", "incidence_rad"},
          p.incidence_rad, "in [0, pi/2)");
  require_finite({"scanner", "fold_azimuth_rad"}, p.fold_azimuth_rad);
  require(p.max_deflection_rad > 0 && p.max_deflection_rad < std::numbers::pi - 2 * p.incidence_rad,
          {"scanner", "max_deflection_rad"}, p.max_deflection_rad, "positive and below pi - 2 incidence_rad");
}

[[noreturn]] void refuse_aim(std::int64_t pulse, double angle_rad, double limit_rad) {
  constexpr double kDegreesPerRadian = 180 / std::numbers::pi;
  std::ostringstream message;
  message << "scanner: pulse " << pulse << " aims " << angle_rad * kDegreesPerRadian
          << " degrees off the boresight; max_deflection allows " << limit_rad * kDegreesPerRadian
          << " (raise it, or narrow the pattern)";
  throw FormatError(message.str());
}

Matrix3d reflection(const Vector3d& normal) { return Matrix3d::Identity() - 2 * normal * normal.transpose(); }

}  // namespace

Fsm::Fsm(const FsmParameters& parameters) : max_deflection_rad_(parameters.max_deflection_rad) {
  check(parameters);
  const double twice = 2 * parameters.incidence_rad;
  const Matrix3d fold = rotation_matrix({0, 0, parameters.fold_azimuth_rad});
  incoming_ = fold * Vector3d(0, -std::sin(twice), -std::cos(twice));
  resting_ = (Vector3d::UnitZ() - incoming_).normalized();
  axis_1_ = fold.col(0);
  axis_2_ = resting_.cross(axis_1_);
}

ScannerState Fsm::state(const PulseContext& pulse) const {
  if (!pulse.aim) return {.mirror_normal = {resting_}};
  const Vector3d& aim = pulse.aim->v;
  const double off_boresight = std::atan2(std::hypot(aim.x(), aim.y()), aim.z());
  // Negated, so that an aim which is NaN is refused too.
  if (!(off_boresight <= max_deflection_rad_))
    refuse_aim(pulse.time.pulse, off_boresight, max_deflection_rad_);
  const Vector3d m = (aim - incoming_).normalized();
  // In the axes (e1, e2, m0): m = (sin a2, -sin a1 cos a2, cos a1 cos a2).
  const double m1 = m.dot(axis_1_);
  const double m2 = m.dot(axis_2_);
  const double m3 = m.dot(resting_);
  return {.angle_1_rad = std::atan2(-m2, m3),
          .angle_2_rad = std::atan2(m1, std::hypot(m2, m3)),
          .mirror_normal = {m}};
}

void Fsm::steer(const ScannerState& state, std::span<const Direction<LidarFrame>> pixels,
                std::span<Beam> beams) const {
  const Matrix3d turn = reflection(state.mirror_normal.v) * reflection(resting_);
  for (std::size_t i = 0; i < pixels.size(); ++i) beams[i] = Beam{.direction = {turn * pixels[i].v}};
}

}  // namespace landfall
