// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "receiver/illumination.h"

namespace landfall {

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
