// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <numbers>

#include "scanner/scanner.h"

namespace landfall {

struct PolygonParameters {
  int facets = 48;                 ///< 2 .. 1000
  double rate_hz = 2.5;            ///< revolutions per second, finite and positive
  double phase_rad = 0;            ///< of the polygon at the first pulse; at 0 a facet is at its middle
  double line_azimuth_rad = 0;     ///< of the line from +x_L towards +y_L
  double duty_frac = 0.8;          ///< fraction of a facet that is used, about its middle; in (0, 1]
  double frame_amplitude_rad = 0;  ///< of the slow second axis, >= 0
  double frame_rate_hz = 0.25;     ///< of the slow second axis, finite and positive
};

/// A polygon mirror with N facets that turns about an axis across the plane of incidence, and a slow second
/// axis that turns the whole assembly.
///
/// The normals of the active facet and of the facet at rest lie in one plane, so reflection by them in turn
/// is a rotation by twice the angle theta between them, for every ray and any incidence: M(m(theta)) M(m0) =
/// R(axis, 2 theta). Hence, with the line along u = Rz(line_azimuth) x_L and v = Rz(line_azimuth) y_L,
///   d' = R(u, psi) R(v, 2 theta) d,
/// and the boresight points to sin(2 theta) u + cos(2 theta) (cos psi z - sin psi v). b = 0: the small motion
/// of the facet towards the camera is neglected.
///
/// angle_1 is theta, the facet's angle from its middle, in [-pi/N, pi/N); it grows with time and jumps where
/// the next facet takes over. angle_2 is psi, a triangle wave between +frame_amplitude (first pulse) and
/// -frame_amplitude (half a period later). Pulses with |theta| > duty_frac pi/N are blanked.
class Polygon : public Scanner {
 public:
  /// Throws UsageError, naming the key and the bound, for a parameter out of range; 2 pi duty_frac/facets +
  /// frame_amplitude must be below pi/2.
  explicit Polygon(const PolygonParameters& parameters);

  [[nodiscard]] ScannerState state(const PulseContext& pulse) const override;
  void steer(const ScannerState& state, std::span<const Direction<LidarFrame>> pixels,
             std::span<Beam> beams) const override;

 private:
  PolygonParameters parameters_;
  Eigen::Vector3d line_;         // u
  Eigen::Vector3d across_line_;  // v, the polygon's axis
};

}  // namespace landfall
