// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D11, D33, D74
#include "chain/lidar/scanner/fsm.h"

#include "base/geometry/vector_check.h"
#include "base/numerics/random.h"
#include "chain/lidar/scanner/mechanism.h"

namespace landfall {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

void check_fsm(const FsmParameters& p) {
  require_angle(p.max_deflection_rad > 0 && p.max_deflection_rad < std::numbers::pi - 2 * p.incidence_rad,
                {"", "max_deflection_deg"}, p.max_deflection_rad, "positive and below 180 - 2 incidence_deg");
  require_finite({"", "pivot_m"}, p.pivot_m.v);
  require_not_negative({"", "focal_distance_m"}, p.focal_distance_m);
  require_not_negative({"", "encoder_sigma_rad"}, p.encoder_sigma_rad);
  check(p.encoder_harmonics);
}

}  // namespace

Fsm::Fsm(const FsmParameters& parameters)
    : parameters_(parameters),
      mirror_(parameters.incidence_rad, parameters.fold_azimuth_rad),
      limit_(parameters.max_deflection_rad),
      timing_(parameters.timing) {
  check_fsm(parameters);
}

ScannerState Fsm::state(const PulseContext& pulse) const {
  return following(pulse, parameters_.tof_lag && pulse.aim_at_echo ? pulse.aim_at_echo : pulse.aim);
}

ScannerState Fsm::following(const PulseContext& pulse,
                            const std::optional<Direction<LidarFrame>>& aim) const {
  if (!aim) return {.mirror_normal = mirror_.resting()};
  limit_.require_within(*aim, pulse.time.pulse);
  const Direction<LidarFrame> normal = mirror_.normal_towards(*aim);
  const TiltAngles commanded = mirror_.tilts(normal);
  ScannerState at_aim{.angle_1_rad = commanded.angle_1_rad,
                      .angle_2_rad = commanded.angle_2_rad,
                      .mirror_normal = normal,
                      .blanked = timing_.blanks(pulse.since_jump_s)};
  if (pulse.jump_aims &&
      timing_.is_moving(pulse.since_jump_s, axes_jump(*pulse.jump_aims, [&](const auto& c) {
                          return mirror_.tilts(mirror_.normal_towards(c));
                        })))
    at_aim.blanked = true;
  const double left = timing_.step_left(pulse.since_jump_s);
  if (left == 0 || !pulse.aim_before_jump) return at_aim;
  const TiltAngles before = mirror_.tilts(mirror_.normal_towards(*pulse.aim_before_jump));
  return with_tilts(at_aim, between(commanded, left, before));
}

ScannerState Fsm::with_tilts(const ScannerState& state, const TiltAngles& tilts) const {
  return {.angle_1_rad = tilts.angle_1_rad,
          .angle_2_rad = tilts.angle_2_rad,
          .mirror_normal = mirror_.normal(tilts),
          .blanked = state.blanked};
}

bool Fsm::is_known() const {
  return parameters_.encoder_sigma_rad == 0 && parameters_.encoder_harmonics.empty() && !parameters_.tof_lag;
}

ScannerState Fsm::estimated_state(const PulseContext& pulse, const ScannerState& truth) const {
  ScannerState at_pulse = parameters_.tof_lag ? following(pulse, pulse.aim) : truth;
  if (!parameters_.encoder_harmonics.empty()) {
    const TiltAngles tilts{at_pulse.angle_1_rad, at_pulse.angle_2_rad};
    const TiltAngles error = encoder_error(parameters_.encoder_harmonics, tilts);
    at_pulse =
        with_tilts(at_pulse, {tilts.angle_1_rad + error.angle_1_rad, tilts.angle_2_rad + error.angle_2_rad});
  }
  if (parameters_.encoder_sigma_rad == 0) return at_pulse;
  const RandomField noise(parameters_.seed, RandomStream::encoder);
  const auto k = static_cast<std::uint64_t>(pulse.time.pulse);
  return with_tilts(at_pulse, {at_pulse.angle_1_rad + parameters_.encoder_sigma_rad * noise.normal(k, 0),
                               at_pulse.angle_2_rad + parameters_.encoder_sigma_rad * noise.normal(k, 1)});
}

void Fsm::steer(const ScannerState& state, std::span<const Direction<LidarFrame>> pixels,
                std::span<Beam> beams) const {
  if (parameters_.focal_distance_m != 0 || parameters_.pivot_m.v != Vector3d::Zero()) {
    steer_from_focal_point(state, pixels, beams);
    return;
  }
  const Matrix3d rotation = mirror_.steering(state.mirror_normal);
  rotate_all(rotation, pixels, beams);
}

void Fsm::steer_from_focal_point(const ScannerState& state, std::span<const Direction<LidarFrame>> pixels,
                                 std::span<Beam> beams) const {
  const Vector3d& m = state.mirror_normal.v;
  const Vector3d& pivot = parameters_.pivot_m.v;
  const Vector3d surface = pivot - mirror_.rotation({state.angle_1_rad, state.angle_2_rad}) * pivot;
  const Vector3d focus = -parameters_.focal_distance_m * mirror_.incoming();
  const double depth = (surface - focus).dot(m);
  const Matrix3d before_mirror = reflection(mirror_.resting().v);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const Vector3d d = before_mirror * pixels[i].v;
    const double cosine = d.dot(m);
    beams[i] = Beam{
        .direction = {d - 2 * cosine * m}, .exit = {focus + (depth / cosine) * d}, .lost = !(cosine < 0)};
  }
}

}  // namespace landfall
