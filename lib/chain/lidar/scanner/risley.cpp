// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D69, D71
#include "chain/lidar/scanner/risley.h"

#include <cmath>
#include <sstream>
#include <string>

#include "base/core/error.h"
#include "base/numerics/portable_math.h"
#include "base/text/parameter_check.h"

namespace landfall {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

/// A face at its orientation at one pulse. `offset_m` is normal . vertex.
struct TurnedFace {
  double x, y, z;
  double offset_m;
  double index_ratio;
};

const RisleyParameters& checked_prisms(const RisleyParameters& parameters) {
  check(parameters.optics);
  if (const auto* rotation = std::get_if<RisleyRotation>(&parameters.drive))
    for (std::size_t i = 0; i < 2; ++i) {
      require(std::abs(rotation->rates_hz[i]) <= 1e6, {"", "rates_hz/" + std::to_string(i)},
              rotation->rates_hz[i], "in [-1e6, 1e6]");
      require_finite({"", "phases_deg/" + std::to_string(i)}, rotation->phases_rad[i]);
    }
  require_not_negative({"", "encoder_sigma_rad"}, parameters.encoder_sigma_rad);
  return parameters;
}

/// Degrees for messages, rounded to 1e-6.
double degrees(double angle_rad) { return std::round(angle_rad * (180 / pi) * 1e6) / 1e6; }

[[noreturn]] void refuse_reach(std::int64_t pulse, const Vector3d& aim,
                               const std::optional<RisleyReach>& reach) {
  std::ostringstream message;
  message << "scanner: pulse " << pulse << " aims "
          << degrees(portable::atan2(portable::hypot(aim.x(), aim.y()), aim.z()))
          << " degrees off the boresight; ";
  if (reach)
    message << "the prisms reach " << degrees(reach->min_rad) << " to " << degrees(reach->max_rad)
            << " (change wedge_deg or index, or the pattern)";
  else
    message << "the prisms reflect the boresight totally at all angles (lower wedge_deg or index)";
  throw FormatError(message.str());
}

/// The angle in [-pi, pi]. Whole turns are removed first, so that a long scan loses no digits.
double angle_at(double rate_hz, double phase_rad, double t_s) {
  const double turns = rate_hz * t_s;
  return std::remainder(2 * pi * (turns - std::round(turns)) + phase_rad, 2 * pi);
}

/// Traces a ray from the focal point through all faces. Uses scalar doubles only: this runs for every pixel
/// of every pulse.
Beam traced(const std::array<TurnedFace, 4>& faces, const Vector3d& pixel) {
  double dx = pixel.x();
  double dy = pixel.y();
  double dz = pixel.z();
  double px = 0;
  double py = 0;
  double pz = 0;
  for (const TurnedFace& face : faces) {
    const double mu = face.index_ratio;
    const double c = dx * face.x + dy * face.y + dz * face.z;
    const double radicand = 1 - mu * mu * (1 - c * c);
    // The test is negated so that NaN counts as lost too.
    if (!(c > 0 && radicand >= 0)) return Beam{.lost = true};
    const double path = (face.offset_m - (px * face.x + py * face.y + pz * face.z)) / c;
    px += path * dx;
    py += path * dy;
    pz += path * dz;
    const double bend = std::sqrt(radicand) - mu * c;
    dx = mu * dx + bend * face.x;
    dy = mu * dy + bend * face.y;
    dz = mu * dz + bend * face.z;
  }
  return Beam{.direction = {{dx, dy, dz}}, .exit = {{px, py, pz}}};
}

}  // namespace

Risley::Risley(const RisleyParameters& parameters)
    : drive_(checked_prisms(parameters).drive),
      encoder_sigma_rad_(parameters.encoder_sigma_rad),
      encoder_(parameters.seed, RandomStream::risley_encoder),
      steering_(parameters.optics) {
  double vertex_m = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    const RisleyPrism& prism = parameters.optics.prisms[i];
    const bool at_exit = tilted_at_exit(parameters.optics.configuration, i);
    faces_[2 * i] = {at_exit ? 0 : prism.wedge_rad, vertex_m, 1 / prism.index};
    vertex_m += prism.thickness_m;
    faces_[2 * i + 1] = {at_exit ? prism.wedge_rad : 0, vertex_m, prism.index};
    vertex_m += parameters.optics.gap_m;
  }
}

RisleyAngles Risley::follow(const PulseContext& pulse, RisleyBranch branch) const {
  if (!pulse.aim) return {};
  const auto angles = steering_.angles(*pulse.aim, branch);
  if (!angles) refuse_reach(pulse.time.pulse, pulse.aim->v, steering_.reach());
  return *angles;
}

RisleyAngles Risley::commanded(const PulseContext& pulse) const {
  if (const auto* branch = std::get_if<RisleyBranch>(&drive_)) return follow(pulse, *branch);
  const auto& rotation = std::get<RisleyRotation>(drive_);
  const double t_s = pulse.time.since_start_s;
  return {angle_at(rotation.rates_hz[0], rotation.phases_rad[0], t_s),
          angle_at(rotation.rates_hz[1], rotation.phases_rad[1], t_s)};
}

ScannerState Risley::state(const PulseContext& pulse) const {
  const RisleyAngles angles = commanded(pulse);
  ScannerState state{.angle_1_rad = angles.theta_1_rad, .angle_2_rad = angles.theta_2_rad};
  if (encoder_sigma_rad_ > 0) {
    const auto k = static_cast<std::uint64_t>(pulse.time.pulse);
    state.angle_1_rad += encoder_sigma_rad_ * encoder_.normal(k, 0);
    state.angle_2_rad += encoder_sigma_rad_ * encoder_.normal(k, 1);
  }
  return state;
}

ScannerState Risley::estimated_state(const PulseContext& pulse, const ScannerState& truth) const {
  ScannerState estimated = truth;
  const RisleyAngles angles = commanded(pulse);
  estimated.angle_1_rad = angles.theta_1_rad;
  estimated.angle_2_rad = angles.theta_2_rad;
  return estimated;
}

void Risley::steer(const ScannerState& state, std::span<const Direction<LidarFrame>> pixels,
                   std::span<Beam> beams) const {
  const std::array<double, 4> turns{state.angle_1_rad, state.angle_1_rad, state.angle_2_rad,
                                    state.angle_2_rad};
  std::array<TurnedFace, 4> faces;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const double lean = portable::sin(faces_[i].wedge_rad);
    const double z = portable::cos(faces_[i].wedge_rad);
    faces[i] = {lean * portable::cos(turns[i]), lean * portable::sin(turns[i]), z, z * faces_[i].vertex_m,
                faces_[i].index_ratio};
  }
  for (std::size_t i = 0; i < pixels.size(); ++i) beams[i] = traced(faces, pixels[i].v);
}

}  // namespace landfall
