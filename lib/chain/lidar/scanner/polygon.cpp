// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D75, D326
#include "chain/lidar/scanner/polygon.h"

#include <Eigen/Geometry>
#include <cmath>
#include <string>

#include "base/geometry/rotation.h"
#include "base/geometry/rotation_vector.h"
#include "base/geometry/vector_check.h"
#include "base/numerics/portable_math.h"
#include "base/numerics/random.h"
#include "chain/lidar/scanner/mirror_frame.h"

namespace landfall {
namespace {

using std::numbers::pi;

void check_tilts(const PolygonParameters& p) {
  require(p.facet_tilt_rad.empty() || p.facet_tilt_rad.size() == static_cast<std::size_t>(p.facets),
          {"", "facet_tilt_rad"}, static_cast<double>(p.facet_tilt_rad.size()),
          "the number of facets: give one tilt per facet");
  for (std::size_t i = 0; i < p.facet_tilt_rad.size(); ++i)
    require(std::abs(p.facet_tilt_rad[i]) <= 0.1, {"facet_tilt_rad", std::to_string(i)}, p.facet_tilt_rad[i],
            "in [-0.1, 0.1]");
  require(p.facet_tilt_sigma_rad >= 0 && p.facet_tilt_sigma_rad <= 0.01, {"", "facet_tilt_sigma_rad"},
          p.facet_tilt_sigma_rad, "in [0, 0.01]");
}

std::vector<double> tilts_of(const PolygonParameters& p) {
  std::vector<double> tilts = p.facet_tilt_rad;
  if (p.facet_tilt_sigma_rad == 0) return tilts;
  tilts.resize(static_cast<std::size_t>(p.facets));
  const RandomField field(p.seed, RandomStream::facet_tilt);
  for (std::size_t i = 0; i < tilts.size(); ++i) tilts[i] += p.facet_tilt_sigma_rad * field.normal(i);
  return tilts;
}

void check_polygon(const PolygonParameters& p) {
  require(p.facets >= 2 && p.facets <= 1000, {"", "facets"}, p.facets, "in 2..1000");
  require_positive({"", "rate_hz"}, p.rate_hz);
  require_finite({"", "phase_deg"}, p.phase_rad);
  require_finite({"", "line_azimuth_deg"}, p.line_azimuth_rad);
  require(p.duty_frac > 0 && p.duty_frac <= 1, {"", "duty_frac"}, p.duty_frac, "in (0, 1]");
  require_positive({"", "frame_rate_hz"}, p.frame_rate_hz);
  const double half_line_rad = 2 * pi * p.duty_frac / p.facets;
  require(half_line_rad < pi / 2, {"", "facets"}, p.facets,
          "above 4 duty_frac: half a line must be below 90 degrees");
  require_angle(p.frame_amplitude_rad >= 0 && half_line_rad + p.frame_amplitude_rad < pi / 2,
                {"", "frame_amplitude_deg"}, p.frame_amplitude_rad,
                ">= 0 and below 90 - 360 duty_frac / facets");
  check_tilts(p);
  check(p.encoder_harmonics);
}

/// The distance to the nearest whole number, in [-1/2, 1/2).
double from_nearest(double turns) { return turns - std::floor(turns + 0.5); }

/// 1 at whole turns, -1 half way between them.
double triangle(double turns) { return 1 - 4 * std::abs(from_nearest(turns)); }

}  // namespace

PolygonScanner::PolygonScanner(const PolygonParameters& parameters) : parameters_(parameters) {
  check_polygon(parameters);
  tilts_rad_ = tilts_of(parameters);
  const Eigen::Matrix3d azimuth = rotation_matrix({0, 0, parameters.line_azimuth_rad});
  line_ = azimuth.col(0);
  across_line_ = azimuth.col(1);
}

double PolygonScanner::facets_at(const PulseContext& pulse) const {
  const PolygonParameters& p = parameters_;
  return p.facets * (p.rate_hz * pulse.time.since_start_s + p.phase_rad / (2 * pi));
}

Direction<LidarFrame> PolygonScanner::normal(double theta_rad, double tilt_rad) const {
  const Eigen::Vector3d untilted =
      portable::sin(theta_rad) * line_ + portable::cos(theta_rad) * Eigen::Vector3d::UnitZ();
  return {portable::cos(tilt_rad) * untilted - portable::sin(tilt_rad) * across_line_};
}

ScannerState PolygonScanner::state(const PulseContext& pulse) const {
  const PolygonParameters& p = parameters_;
  const double facets = facets_at(pulse);
  const double facet_turns = from_nearest(facets);
  ScannerState state{
      .angle_1_rad = facet_turns * 2 * pi / p.facets,
      .angle_2_rad = p.frame_amplitude_rad * triangle(p.frame_rate_hz * pulse.time.since_start_s),
      .blanked = std::abs(facet_turns) > p.duty_frac / 2};
  if (tilts_rad_.empty()) return state;
  const double turns = std::floor(facets + 0.5) / p.facets;
  const auto facet =
      static_cast<std::size_t>(std::lround((turns - std::floor(turns)) * p.facets)) % tilts_rad_.size();
  state.mirror_normal = normal(state.angle_1_rad, tilts_rad_[facet]);
  return state;
}

bool PolygonScanner::is_known() const {
  return (tilts_rad_.empty() || parameters_.facet_tilt_known) && parameters_.encoder_harmonics.empty();
}

ScannerState PolygonScanner::estimated_state(const PulseContext& pulse, const ScannerState& truth) const {
  const PolygonParameters& p = parameters_;
  ScannerState estimated = truth;
  const TiltAngles error =
      encoder_error(p.encoder_harmonics, {2 * pi / p.facets * facets_at(pulse), truth.angle_2_rad});
  estimated.angle_1_rad += error.angle_1_rad;
  estimated.angle_2_rad += error.angle_2_rad;
  if (tilts_rad_.empty()) return estimated;
  // The tilt is the angle of the normal to the plane of the line.
  const double tilt_rad = p.facet_tilt_known ? portable::asin(-truth.mirror_normal.v.dot(across_line_)) : 0;
  estimated.mirror_normal = normal(estimated.angle_1_rad, tilt_rad);
  return estimated;
}

void PolygonScanner::steer(const ScannerState& state, std::span<const Direction<LidarFrame>> pixels,
                           std::span<Beam> beams) const {
  const Eigen::Quaterniond frame = quaternion_of(state.angle_2_rad * line_);
  if (!tilts_rad_.empty()) {
    rotate_all(
        frame.toRotationMatrix() * reflection(state.mirror_normal.v) * reflection(Eigen::Vector3d::UnitZ()),
        pixels, beams);
    return;
  }
  const Eigen::Matrix3d rotation =
      (frame * quaternion_of(2 * state.angle_1_rad * across_line_)).toRotationMatrix();
  rotate_all(rotation, pixels, beams);
}

}  // namespace landfall
