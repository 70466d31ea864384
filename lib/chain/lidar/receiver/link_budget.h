// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "base/geometry/frames.h"

namespace landfall {

enum class BeamProfile { gaussian, top_hat };

struct IlluminationParameters {
  BeamProfile profile = BeamProfile::gaussian;
  /// Full angle: at 1/e^2 of the irradiance on the axis (gaussian), or from edge to edge (top_hat); in (0,
  /// pi). Empty: the same irradiance in every direction.
  std::optional<double> divergence_rad{};
  /// Angles of the beam's axis from +z_L towards +x_L and +y_L, before steering, in (-pi/2, pi/2).
  double offset_x_rad = 0;
  double offset_y_rad = 0;
};

/// The transmitted beam, which the scanner steers together with the pixels' lines of sight.
class Illumination {
 public:
  /// Throws UsageError, naming the key and the bound, for a parameter out of range.
  explicit Illumination(const IlluminationParameters& parameters = {});

  /// Irradiance over that on the axis, in [0, 1], in the direction in which a pixel or sub-pixel looks before
  /// steering. gaussian: exp(-8 theta^2/divergence^2), theta the angle from the axis.
  [[nodiscard]] double relative(const Direction<LidarFrame>& direction) const;
  /// The fraction of the pulse's energy per steradian on the axis: 8/(pi divergence^2) for a Gaussian beam,
  /// 4/(pi divergence^2) for a top hat. Empty without a divergence.
  [[nodiscard]] std::optional<double> peak_per_sr() const;

 private:
  IlluminationParameters parameters_;
  Direction<LidarFrame> axis_;
};

/// The signal of a pixel that looks along the beam's axis, as measured or specified.
struct ReferenceSignal {
  double pe = 0;         ///< mean photoelectrons from albedo 1 at normal incidence, > 0
  double range_m = 500;  ///< at this range, > 0
};

/// The instrument's design, from which the same signal follows.
struct LinkDesign {
  double pulse_energy_J = 0;  ///< > 0
  double wavelength_m = 0;    ///< > 0
  double aperture_m = 0;      ///< diameter of the receiving telescope, > 0
  /// Photoelectrons per photon that enters the telescope, losses of the transmitter included, in (0, 1].
  double efficiency = 0;
};

/// The link constant K of a whole pixel, photoelectrons x m^2. A Lambertian surface that fills the pixel and
/// reflects the fraction `albedo` gives a mean of
///   N = K w albedo cos(incidence) / range^2
/// photoelectrons, w the beam's relative irradiance. Each throws UsageError, naming the key and the bound,
/// for a value out of range.
[[nodiscard]] double link_constant_pe_m2(const ReferenceSignal& reference);
/// K = E lambda/(h c) efficiency F aperture^2/4, F = pixel_sr x the beam's peak fraction per steradian: the
/// lidar equation for an extended Lambertian target (Degnan 1993; McManamon 2012) without an atmosphere.
/// Throws UsageError for a beam without a divergence.
[[nodiscard]] double link_constant_pe_m2(const LinkDesign& design, double pixel_sr, const Illumination& beam);

}  // namespace landfall
