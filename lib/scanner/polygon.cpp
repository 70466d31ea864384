// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanner/polygon.h"

#include <Eigen/Geometry>
#include <cmath>

#include "geometry/parameter_check.h"
#include "geometry/rotation.h"

namespace landfall {
namespace {

using std::numbers::pi;

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
}

/// The distance to the nearest whole number, in [-1/2, 1/2).
double from_nearest(double turns) { return turns - std::floor(turns + 0.5); }

/// 1 at whole turns, -1 half way between them.
double triangle(double turns) { return 1 - 4 * std::abs(from_nearest(turns)); }

}  // namespace

Polygon::Polygon(const PolygonParameters& parameters) : parameters_(parameters) {
  check_polygon(parameters);
  const Eigen::Matrix3d azimuth = rotation_matrix({0, 0, parameters.line_azimuth_rad});
  line_ = azimuth.col(0);
  across_line_ = azimuth.col(1);
}

ScannerState Polygon::state(const PulseContext& pulse) const {
  const PolygonParameters& p = parameters_;
  const double t = pulse.time.since_start_s;
  const double facet_turns = from_nearest(p.facets * (p.rate_hz * t + p.phase_rad / (2 * pi)));
  return {.angle_1_rad = facet_turns * 2 * pi / p.facets,
          .angle_2_rad = p.frame_amplitude_rad * triangle(p.frame_rate_hz * t),
          .blanked = std::abs(facet_turns) > p.duty_frac / 2};
}

void Polygon::steer(const ScannerState& state, std::span<const Direction<LidarFrame>> pixels,
                    std::span<Beam> beams) const {
  const Eigen::Matrix3d turn =
      (Eigen::AngleAxisd(state.angle_2_rad, line_) * Eigen::AngleAxisd(2 * state.angle_1_rad, across_line_))
          .toRotationMatrix();
  turn_all(turn, pixels, beams);
}

}  // namespace landfall
