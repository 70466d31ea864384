// SPDX-License-Identifier: GPL-3.0-or-later
#include "receiver/link_budget.h"

#include "base/error.h"
#include "base/light.h"
#include "base/parameter_check.h"

namespace landfall {

double link_constant_pe_m2(const ReferenceSignal& reference) {
  require_positive({"", "reference_pe"}, reference.pe);
  require_positive({"", "reference_range_m"}, reference.range_m);
  return reference.pe * reference.range_m * reference.range_m;
}

double link_constant_pe_m2(const LinkDesign& design, double pixel_sr, const Illumination& beam) {
  constexpr double kPlanck_Js = 6.62607015e-34;
  require_positive({"", "pulse_energy_J"}, design.pulse_energy_J);
  require_positive({"", "wavelength_m"}, design.wavelength_m);
  require_positive({"", "aperture_m"}, design.aperture_m);
  require(design.efficiency > 0 && design.efficiency <= 1, {"", "efficiency"}, design.efficiency,
          "in (0, 1]");
  const auto peak_per_sr = beam.peak_per_sr();
  if (!peak_per_sr) throw UsageError("pulse_energy_J: needs /beam/divergence_rad");
  const double photons = design.pulse_energy_J * design.wavelength_m / (kPlanck_Js * kSpeedOfLight_mps);
  return photons * design.efficiency * pixel_sr * *peak_per_sr * design.aperture_m * design.aperture_m / 4;
}

}  // namespace landfall
