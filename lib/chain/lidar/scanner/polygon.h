// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <numbers>
#include <vector>

#include "base/numerics/random_seed.h"
#include "chain/lidar/scanner/mechanism.h"
#include "chain/lidar/scanner/scanner.h"

namespace landfall {

struct PolygonParameters {
  int facets = 48;                 ///< 2 .. 1000
  double rate_hz = 2.5;            ///< revolutions per second, finite and positive
  double phase_rad = 0;            ///< of the polygon at the first pulse; at 0 a facet is at its middle
  double line_azimuth_rad = 0;     ///< of the line from +x_L towards +y_L
  double duty_frac = 0.8;          ///< fraction of a facet that is used, about its middle; in (0, 1]
  double frame_amplitude_rad = 0;  ///< of the slow second axis, >= 0
  double frame_rate_hz = 0.25;     ///< of the slow second axis, finite and positive
  /// Tilt of each facet's normal about the line, right-handed about u, in [-0.1, 0.1]; empty: none.
  std::vector<double> facet_tilt_rad{};
  double facet_tilt_sigma_rad = 0;  ///< one sigma of further tilts, drawn per facet, in [0, 0.01]
  bool facet_tilt_known = false;    ///< a calibrated scanner: the lander knows the tilts
  /// The harmonics of the encoders of the drum (its whole turn) and of the frame.
  std::vector<EncoderHarmonic> encoder_harmonics{};
  RandomSeed seed = {};  ///< of the tilts
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
///
/// Pyramidal error: the normal of facet f, 0 at theta = 0 of the first turn and then in the order in which
/// they take over, is tilted towards the drum's axis by eps_f. For a boresight that meets the middle of a
/// facet at its normal, m = R(v, theta) R(u, eps) z, and M(m) M(z) = R(v, theta) R(u, 2 eps) R(v, theta): the
/// line of facet f is 2 eps cos(theta) from the nominal one, in the sense of psi. mirror_normal is m.
class PolygonScanner : public Scanner {
 public:
  /// Throws UsageError, naming the key and the bound, for a parameter out of range; 2 pi duty_frac/facets +
  /// frame_amplitude must be below pi/2.
  explicit PolygonScanner(const PolygonParameters& parameters);

  [[nodiscard]] ScannerState state(const PulseContext& pulse) const override;
  [[nodiscard]] bool is_known() const override;
  /// The readings of the encoders, and facets without tilts unless these are known.
  [[nodiscard]] ScannerState estimated_state(const PulseContext& pulse,
                                             const ScannerState& truth) const override;
  void steer(const ScannerState& state, std::span<const Direction<LidarFrame>> pixels,
             std::span<Beam> beams) const override;

 private:
  /// Facets since the first pulse, a whole number at the middle of a facet.
  [[nodiscard]] double facets_at(const PulseContext& pulse) const;
  [[nodiscard]] Direction<LidarFrame> normal(double theta_rad, double tilt_rad) const;

  PolygonParameters parameters_;
  std::vector<double> tilts_rad_;  // per facet; empty: none
  Eigen::Vector3d line_;           // u
  Eigen::Vector3d across_line_;    // v, the polygon's axis
};

}  // namespace landfall
